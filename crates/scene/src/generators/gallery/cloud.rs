//! A small cumulus in the evening: light that is scattered a hundred times.

use super::super::{GeneratorEntry, shapes};
use super::puffs::{clouds, grid, rise};
use super::{Stage, about};
use crate::builder::SceneBuilder;
use crate::parameters::Spec;
use bilux_math::{Aabb, Rgb, Vec3};

pub(in crate::generators) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("cloud", "a cumulus over a plain in the evening sun"),
    generate: |_| Ok(build()),
};

/// The billows: their middles and radii, in metres.
const BILLOWS: &[([f32; 3], f32)] = &[
    ([0.0, 330.0, 0.0], 95.0),
    ([-110.0, 300.0, 10.0], 75.0),
    ([105.0, 305.0, -15.0], 80.0),
    ([45.0, 395.0, 15.0], 75.0),
    ([-50.0, 380.0, -20.0], 65.0),
    ([190.0, 285.0, 20.0], 50.0),
    ([-190.0, 282.0, -10.0], 50.0),
    ([25.0, 455.0, 0.0], 48.0),
];

/// Where it begins to rain out of the air: the flat base.
const BASE: f32 = 262.0;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(-1.3);
    stage.deep(400);
    let earth = stage.diffuse("fields", [0.07, 0.08, 0.035]);
    stage.put("plain", shapes::floor(Vec3::ZERO, 30_000.0), earth);
    let bounds = Aabb { min: Vec3::new(-280.0, 240.0, -150.0), max: Vec3::new(280.0, 540.0, 150.0) };
    let droplets = grid("cloud", bounds, [168, 90, 90], |p| {
        let near = |&(middle, radius): &([f32; 3], f32)| 1.0 - p.distance(Vec3::from(middle)) / radius;
        let body = BILLOWS.iter().map(near).fold(-1.0, f32::max);
        let torn = body + 0.75 * clouds(p / 55.0, 6, 5);
        rise(torn, 0.02, 0.3) * rise(p.y, BASE - 12.0, BASE + 18.0)
    });
    let cloud = Spec::new("cloud", "interface")
        .with("scattering", 0.12f32)
        // Sharper forward peaks, as those of droplets, would need more samples.
        .with("scattering_anisotropy", 0.8f32)
        .with("density", droplets);
    let cloud = stage.material(cloud);
    stage.put("cloud", shapes::cuboid(bounds), cloud);
    stage.light(
        Spec::new("sun", "directional")
            .with("direction", Vec3::new(-0.8, -0.35, -0.3))
            .with("irradiance", Rgb::new(20.0, 14.0, 8.5)),
    );
    stage.light(
        Spec::new("sky", "environment")
            .with("radiance", 1.0f32)
            .with("zenith", Rgb::new(0.07, 0.15, 0.42))
            .with("horizon", Rgb::new(0.55, 0.55, 0.62))
            .with("ground", Rgb::new(0.12, 0.11, 0.09)),
    );
    stage.seen([60.0, 120.0, 900.0], [0.0, 305.0, 0.0], 33.0)
}

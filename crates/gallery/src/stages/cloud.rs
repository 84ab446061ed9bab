//! A small cumulus in the evening: light that is scattered a hundred times.

use super::puffs::{clouds, grid, rise};
use super::{Stage, about};
use crate::GeneratorEntry;
use crate::modelling::parts::sheet;
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("cloud", "a cumulus over hills in the evening sun"),
    triangles: |_| 0,
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

/// Height in metres at which it begins to rain out of the air: the flat base.
const BASE: f32 = 262.0;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(-1.0);
    stage.deep(400);
    let earth = stage.diffuse("fields", [0.055, 0.085, 0.035]);
    stage.put("hills", hills(), earth);
    let bounds = Aabb { min: Vec3::new(-280.0, 240.0, -150.0), max: Vec3::new(280.0, 540.0, 150.0) };
    let droplets = grid("cloud", bounds, [196, 105, 105], |p| {
        let near = |&(middle, radius): &([f32; 3], f32)| 1.0 - p.distance(Vec3::from(middle)) / radius;
        let body = BILLOWS.iter().map(near).fold(-1.0, f32::max);
        let torn = body + 0.85 * clouds(p / 46.0, 6, 5);
        rise(torn, 0.02, 0.17) * rise(p.y, BASE - 12.0, BASE + 18.0)
    });
    let cloud = Spec::new("cloud", "interface")
        .with("scattering", 0.2f32)
        // Sharper forward peaks, as those of droplets, would need more samples.
        .with("scattering_anisotropy", 0.8f32)
        .with("density", droplets);
    let cloud = stage.material(cloud);
    stage.put("cloud", shapes::cuboid(bounds), cloud);
    stage.light(
        Spec::new("sun", "directional")
            .with("direction", Vec3::new(-0.85, -0.24, -0.12))
            .with("irradiance", Rgb::new(24.0, 13.5, 6.4)),
    );
    stage.light(
        Spec::new("sky", "environment")
            .with("radiance", 1.0f32)
            .with("zenith", Rgb::new(0.04, 0.15, 0.52))
            .with("horizon", Rgb::new(0.72, 0.60, 0.46))
            .with("ground", Rgb::new(0.12, 0.11, 0.09)),
    );
    stage.seen([60.0, 120.0, 960.0], [5.0, 285.0, 0.0], 36.0)
}

/// Low hills up to the horizon.
fn hills() -> Mesh {
    sheet(160, 160, |u, v| {
        // Closer together in front.
        let z = 900.0 - 14_000.0 * v * v;
        let x = (u - 0.5) * (2_000.0 + 22_000.0 * v * v);
        let height = 55.0 * clouds(Vec3::new(x / 900.0, 0.0, z / 900.0), 2, 8) + 170.0 * v * v;
        Vec3::new(x, height - 40.0, z)
    })
}

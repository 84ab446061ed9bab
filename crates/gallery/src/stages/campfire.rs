//! Fire at night: it shines by its temperature, and its smoke rises into its own light.

use super::puffs::{clouds, grid, rise};
use super::{Stage, about};
use crate::GeneratorEntry;
use crate::modelling::parts::{chance, joined, moved, turned};
use bilux_math::transcendental::{cos, sin, sin_cos};
use bilux_math::{Aabb, Motion, Quat, Rgb, Transform, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{SceneBuilder, Spec};
use std::f32::consts::TAU;

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("campfire", "fire and smoke between stones, at night"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// Stones of the ring.
const STONES: u32 = 13;
/// Logs of the pile.
const LOGS: u32 = 5;
/// Firs at the edge of the wood.
const FIRS: u32 = 34;
/// The height up to which it burns, in metres.
const FLAME: f32 = 0.95;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.6);
    // Its colours stay those of fire where it is brightest.
    stage.scene.settings.set("tonemap", "agx");
    let soil = stage.diffuse("soil", [0.24, 0.18, 0.12]);
    stage.put("ground", shapes::floor(Vec3::ZERO, 120.0), soil);
    firs(&mut stage);
    stones(&mut stage);
    logs(&mut stage);
    let bounds = Aabb { min: Vec3::new(-0.55, 0.02, -0.55), max: Vec3::new(0.55, 2.6, 0.55) };
    let size = [80, 188, 80];
    let density = grid("soot", bounds, size, |p| flame(p) + 0.06 * smoke(p));
    let temperature = grid("heat", bounds, size, |p| {
        // Gas cools as it rises and towards its edge.
        let hot = flame(p).min(1.0) * (1.0 - 0.45 * (p.y / FLAME).clamp(0.0, 1.0));
        if hot > 0.0 { 900.0 + 1050.0 * hot } else { 0.0 }
    });
    let fire = Spec::new("fire", "interface")
        .with("absorption", 9.0f32)
        .with("scattering", 3.0f32)
        .with("scattering_anisotropy", 0.3f32)
        .with("density", density)
        .with("temperature", temperature)
        .with("medium_emission", 22.0f32);
    let fire = stage.material(fire);
    stage.put("fire", shapes::cuboid(bounds), fire);
    stage.light(
        Spec::new("night", "environment")
            .with("radiance", 1.0f32)
            .with("zenith", Rgb::new(0.008, 0.024, 0.085))
            .with("horizon", Rgb::new(0.062, 0.052, 0.072))
            .with("ground", Rgb::grey(0.003)),
    );
    stage.seen([0.85, 0.62, 2.9], [0.0, 0.60, 0.0], 34.0)
}

/// Tongues that sway more the higher they are, from 0 to a little above 1.
fn flame(p: Vec3) -> f32 {
    let height = p.y / FLAME;
    let sway = Vec3::new(clouds(p * 2.6 + Vec3::new(0.0, -1.7, 0.0), 2, 1), 0.0, clouds(p * 2.6, 2, 2));
    let q = p + sway * (0.26 * height.max(0.0));
    let across = (q.x * q.x + q.z * q.z).sqrt();
    let reach = 0.3 * (1.0 - height).max(0.0).sqrt() * (0.55 + 0.45 * rise(height, 0.0, 0.16));
    if reach <= 0.0 {
        return 0.0;
    }
    // Noise that is drawn out upwards tears the edge into tongues.
    let torn = 1.0 - across / reach + 0.75 * clouds(q * Vec3::new(7.5, 2.2, 7.5), 4, 3);
    rise(torn, 0.12, 0.75) * rise(1.0 - height, 0.0, 0.2)
}

/// A plume that widens as it rises.
fn smoke(p: Vec3) -> f32 {
    let sway = Vec3::new(clouds(p * 1.3, 2, 7), 0.0, clouds(p * 1.3, 2, 8));
    let q = p + sway * (0.16 * p.y);
    let across = (q.x * q.x + q.z * q.z).sqrt();
    let torn = 1.0 - across / (0.1 + 0.16 * p.y) + 0.9 * clouds(q * Vec3::new(4.0, 2.6, 4.0), 5, 9);
    rise(torn, 0.1, 0.9) * rise(p.y, 0.5, 1.0) * rise(2.58 - p.y, 0.0, 0.5)
}

fn stones(stage: &mut Stage) {
    let granite = stage.diffuse("granite", [0.24, 0.22, 0.21]);
    for i in 0..STONES {
        let angle = (i as f32 + 0.3 * clouds(Vec3::splat(i as f32 * 3.7), 1, 4)) * TAU / STONES as f32;
        let size = 0.12 + 0.035 * clouds(Vec3::splat(i as f32 * 1.9), 1, 6);
        let middle = Vec3::new(0.72 * cos(angle), 0.62 * size, 0.72 * sin(angle));
        let rough = |d: Vec3| size * (1.0 + 0.35 * clouds(d * 1.6 + middle * 9.0, 4, 12));
        stage.put("stone", shapes::blob(middle, 5, rough), granite);
    }
}

/// The edge of a wood, dark before the sky.
fn firs(stage: &mut Stage) {
    let fir = |k: u32| {
        let [angle, far, tall] = [21, 22, 23].map(|kind| chance(kind, k));
        let (sin, cos) = sin_cos(TAU * (0.53 + 0.44 * (k as f32 + angle) / FIRS as f32));
        let (tall, far) = (3.2 + 3.4 * tall, 15.0 + 12.0 * far);
        let outline: Vec<[f32; 2]> = (0..=10)
            .map(|k| {
                // Whorls of branches, each wider than the one above.
                let down = (k as f32 * 0.1).min(0.96);
                let width = if k % 2 == 0 { 0.55 } else { 1.0 };
                [0.24 * tall * down * width, tall * (1.0 - down)]
            })
            .chain([[0.0, 0.02 * tall]])
            .collect();
        moved(&turned(&outline, 14, 1), [far * cos, 0.0, far * sin])
    };
    let needles = stage.diffuse("needles", [0.03, 0.045, 0.03]);
    stage.put("firs", joined((0..FIRS).map(fir)), needles);
}

/// Logs that lean against each other.
fn logs(stage: &mut Stage) {
    let bark = stage.diffuse("bark", [0.1, 0.06, 0.035]);
    for i in 0..LOGS {
        let turn = Quat::from_rotation_y((i as f32 + 0.4) * TAU / LOGS as f32);
        let lean = Quat::from_rotation_z(1.02);
        let at = turn * Vec3::new(0.2, 0.17, 0.0);
        stage.put("log", shapes::prism(Vec3::ZERO, 0.055, 0.62, 9), bark);
        let place = bilux_math::DMat4::from_rotation_translation((turn * lean).as_dquat(), at.as_dvec3());
        if let (Some(log), Some(place)) = (stage.scene.objects.last_mut(), Transform::from_matrix(place)) {
            log.motion = Motion::still(place);
        }
    }
}

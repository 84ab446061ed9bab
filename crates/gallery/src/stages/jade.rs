//! Light below the surface: a dragon of jade, a candle of wax and an egg of marble, lit from behind.

use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::modelling::parts::{moved, turned};
use crate::scan::statue;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("jade", "a dragon of jade, a burning candle and an egg of marble, lit from behind"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// Position of the candle.
const CANDLE: [f32; 3] = [-0.17, 0.0, 0.03];

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.6);
    let slate = stage.material(
        Spec::new("slate", "principled")
            .with("base_color", Rgb::new(0.045, 0.036, 0.032))
            .with("specular_roughness", 0.35f32),
    );
    stage.put("table", shapes::floor(Vec3::ZERO, 9.0), slate);
    let plaster = stage.diffuse("wall", [0.16, 0.07, 0.045]);
    stage.put("wall", boxes(&[[[-3.0, 0.0, -1.3], [3.0, 3.0, -1.2]]]), plaster);
    let jade = stage.below("jade", [0.3, 0.7, 0.42], 0.004, [1.62, 0.32]);
    let mut dragon = statue(72);
    dragon.positions.iter_mut().for_each(|p| *p *= 0.17);
    stage.put("dragon", dragon, jade);
    let wax = stage.below("wax", [0.95, 0.88, 0.74], 0.004, [1.44, 0.5]);
    stage.put("candle", moved(&candle(), CANDLE), wax);
    let soot = stage.diffuse("soot", [0.03, 0.03, 0.03]);
    stage.put("wick", moved(&wick(), CANDLE), soot);
    let flame = stage.glowing("flame", [220.0, 105.0, 28.0]);
    stage.put("flame", moved(&fire(), CANDLE), flame);
    let marble = stage.below("marble", [0.86, 0.83, 0.8], 0.004, [1.5, 0.3]);
    stage.put("egg", moved(&egg(), [0.165, 0.0, 0.07]), marble);
    stage.panel("window", [-0.1, 0.9, -0.78], [[0.9, 0.0, 0.0], [0.0, 0.36, 0.3]], [7.5, 8.0, 9.0]);
    stage.light(Spec::new("room", "environment").with("radiance", Rgb::new(0.02, 0.024, 0.035)));
    stage.seen([0.06, 0.27, 0.86], [0.0, 0.095, 0.0], 26.0)
}

impl Stage {
    /// A body of this colour, with the mean free path in metres, the refractive index and the roughness.
    fn below(&mut self, name: &str, colour: [f32; 3], radius: f32, [ior, roughness]: [f32; 2]) -> usize {
        self.material(
            Spec::new(name, "principled")
                .with("subsurface_weight", 1.0f32)
                .with("subsurface_color", Rgb::from_array(colour))
                .with("subsurface_radius", radius)
                .with("subsurface_radius_scale", Rgb::WHITE)
                .with("specular_ior", ior)
                .with("specular_roughness", roughness),
        )
    }
}

/// 14 cm of wax, molten a little below its rim.
fn candle() -> Mesh {
    let outline = [
        [0.0, 0.128],
        [0.012, 0.1285],
        [0.022, 0.131],
        [0.0285, 0.138],
        [0.0325, 0.143],
        [0.0345, 0.140],
        [0.035, 0.13],
        [0.035, 0.06],
        [0.0352, 0.02],
        [0.036, 0.004],
        [0.034, 0.0005],
        [0.02, 0.0003],
        [0.0, 0.0003],
    ];
    turned(&outline, 64, 5)
}

fn wick() -> Mesh {
    turned(&[[0.0, 0.150], [0.0008, 0.1495], [0.001, 0.145], [0.001, 0.12], [0.0, 0.12]], 16, 1)
}

fn fire() -> Mesh {
    let outline = [
        [0.0, 0.192],
        [0.0012, 0.186],
        [0.0035, 0.175],
        [0.006, 0.163],
        [0.0065, 0.156],
        [0.0045, 0.149],
        [0.002, 0.1465],
        [0.0, 0.146],
    ];
    turned(&outline, 32, 4)
}

fn egg() -> Mesh {
    let outline = [
        [0.0, 0.082],
        [0.013, 0.0785],
        [0.0225, 0.068],
        [0.0285, 0.053],
        [0.0305, 0.036],
        [0.0275, 0.0185],
        [0.0185, 0.006],
        [0.009, 0.0014],
        [0.0, 0.0004],
    ];
    turned(&outline, 64, 6)
}

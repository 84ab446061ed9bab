//! Small scenes that look good, each difficult for light transport in a different way. Each scene has its own
//! file and is composed for a 4:3 image; `bilux bench render` measures on them.

pub(super) mod bidirectional;
pub(super) mod campfire;
pub(super) mod caustics;
pub(super) mod cloud;
pub(super) mod daylight;
pub(super) mod door_ajar;
pub(super) mod fog;
pub(super) mod indirect;
pub(super) mod jade;
pub(super) mod lampshades;
pub(super) mod many_lights;
pub(super) mod milk;
pub(super) mod piglet;
pub(super) mod pool;
mod puffs;
mod tiles;

use crate::modelling::parts::{between, joined, sharp};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec3};
use bilux_scene::typed::cameras::Perspective;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::sync::Arc;

/// The table entry of one of these scenes.
const fn about(name: &'static str, summary: &'static str) -> Entry {
    Entry { name, summary, source: "", parameters: &[] }
}

/// A scene being set up.
struct Stage {
    scene: SceneBuilder,
}

impl Stage {
    /// An empty stage, exposed by this many stops.
    fn new(exposure: f32) -> Stage {
        let mut scene = SceneBuilder::default();
        scene.settings.set("size", "960x720");
        scene.settings.set("tonemap", "aces");
        scene.settings.set("exposure", exposure);
        Stage { scene }
    }

    /// Sets the maximum number of bounces, for scenes with a lot of glass.
    fn deep(&mut self, bounces: i64) {
        self.scene.settings.set("max_depth", Value::Integer(bounces));
    }

    fn material(&mut self, spec: Spec) -> usize {
        self.scene.add_material(spec)
    }

    fn diffuse(&mut self, name: &str, colour: [f32; 3]) -> usize {
        self.material(Spec::new(name, "diffuse").with("reflectance", Rgb::from_array(colour)))
    }

    /// Diffuse under a thin gloss.
    fn glossy(&mut self, name: &str, colour: [f32; 3], gloss: f32, exponent: f32) -> usize {
        let spec = Spec::new(name, "phong").with("kd", Rgb::from_array(colour)).with("ks", gloss);
        self.material(spec.with("exponent", exponent).with("reflectivity", 0.0f32))
    }

    /// Smooth glass with this absorption per metre for each colour.
    fn glass(&mut self, name: &str, absorption: [f32; 3]) -> usize {
        self.material(Spec::new(name, "dielectric").with("absorption", Rgb::from_array(absorption)))
    }

    fn metal(&mut self, metal: &str, roughness: f32) -> usize {
        self.material(Spec::new(metal, "conductor").with("metal", metal).with("roughness", roughness))
    }

    /// An emissive material.
    fn glowing(&mut self, name: &str, radiance: [f32; 3]) -> usize {
        let spec = Spec::new(name, "diffuse").with("reflectance", 0.0f32);
        self.material(spec.with("emission", Rgb::from_array(radiance)))
    }

    fn put(&mut self, name: &str, mesh: Mesh, material: usize) {
        self.scene.objects.push(Object::new(name, Arc::new(mesh), material));
    }

    fn light(&mut self, spec: Spec) {
        self.scene.lights.push(spec);
    }

    /// A flat light around a point.
    fn panel(&mut self, name: &str, middle: [f32; 3], edges: [[f32; 3]; 2], radiance: [f32; 3]) {
        self.light(
            Spec::new(name, "rect")
                .with("position", Vec3::from(middle))
                .with("edge_u", Vec3::from(edges[0]))
                .with("edge_v", Vec3::from(edges[1]))
                .with("radiance", Rgb::from_array(radiance)),
        );
    }

    /// Adds the camera: eye, target, and vertical field of view in degrees.
    fn seen(mut self, from: [f32; 3], to: [f32; 3], degrees: f32) -> SceneBuilder {
        let eye = Perspective::new("front").position(Vec3::from(from)).look_at(Vec3::from(to)).fov(degrees);
        self.scene.add_camera(eye);
        self.scene
    }
}

/// A place or a direction.
const fn at(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// One mesh of sharp-edged boxes, each given by two opposite corners.
fn boxes(corners: &[[[f32; 3]; 2]]) -> Mesh {
    joined(corners.iter().map(|&[low, high]| sharp(between(low, high))))
}

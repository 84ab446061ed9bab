//! Everything in the scene other than meshes: cameras, lights and animations.

use super::Document;
use bilux_import::output::values::{colour, number, vector};
use bilux_import::output::writing::Writing;
use bilux_import::world::camera_loss::{field_of_view, not_perspective, picture_aspect_ratio};
use bilux_import::world::placement::looking;
use bilux_math::{MotionKey, Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, Spec, Value};
use serde_json::{Value as Json, json};
use std::borrow::Cow;
use std::sync::Arc;

/// The keys from 0 seconds on, the first of which is there if there are any before it: times below 0 are not allowed.
/// [glTF 2.0, 3.11]
fn from_zero(keys: &[MotionKey]) -> Cow<'_, [MotionKey]> {
    let later = keys.partition_point(|key| key.time_seconds <= 0.0);
    let Some(before) = later.checked_sub(1).map(|last| keys[last]) else { return Cow::Borrowed(keys) };
    if later == 1 && before.time_seconds == 0.0 {
        return Cow::Borrowed(keys);
    }
    let mut at_zero = MotionKey { time_seconds: 0.0, ..before };
    if let Some(after) = keys.get(later) {
        let part = -before.time_seconds / (after.time_seconds - before.time_seconds);
        at_zero.translation = before.translation.lerp(after.translation, part);
        at_zero.rotation = before.rotation.normalize().slerp(after.rotation.normalize(), part);
        at_zero.scale = before.scale.lerp(after.scale, part);
    }
    Cow::Owned(std::iter::once(at_zero).chain(keys[later..].iter().copied()).collect())
}

impl Document<'_> {
    /// Adds an animation of a node with linear interpolation between these keys.
    pub(super) fn animate(&mut self, node: usize, keys: &[MotionKey], writing: &mut Writing) {
        if keys.first().is_some_and(|key| key.time_seconds < 0.0) {
            writing.warn("animations of glTF begin at 0 seconds: what moves before that is left out");
        }
        let keys = &*from_zero(keys);
        let times = self.buffer.keys(&keys.iter().map(|key| [key.time_seconds]).collect::<Vec<_>>());
        let outputs = [
            (
                "translation",
                self.buffer.keys(&keys.iter().map(|k| k.translation.to_array()).collect::<Vec<_>>()),
            ),
            (
                "rotation",
                self.buffer.keys(&keys.iter().map(|k| k.rotation.normalize().to_array()).collect::<Vec<_>>()),
            ),
            ("scale", self.buffer.keys(&keys.iter().map(|k| k.scale.to_array()).collect::<Vec<_>>())),
        ];
        let channel = |(i, (path, _)): (usize, &(&str, usize))| json!({ "sampler": i, "target": { "node": node, "path": path } });
        let channels: Vec<Json> = outputs.iter().enumerate().map(channel).collect();
        let samplers: Vec<Json> =
            outputs.iter().map(|(_, output)| json!({ "input": times, "output": output })).collect();
        self.push("animations", json!({ "channels": channels, "samplers": samplers }));
    }

    pub(super) fn camera(&mut self, camera: &CameraSpec, writing: &mut Writing) {
        let spec = &camera.spec;
        if !camera.keyframes.is_empty() {
            writing.warn("cameras are written as they are at 0 seconds");
        }
        if number(spec, "aperture").is_some_and(|aperture| aperture > 0.0) {
            writing.warn("glTF files cannot store apertures of cameras: left out");
        }
        if matches!(spec.parameters.find("mirrored"), Some((Value::Bool(true), _))) {
            writing.warn("glTF files cannot store mirrored pictures of cameras: written as not mirrored");
        }
        let point = |key, default: Vec3| vector(spec, key).unwrap_or(default);
        let position = point("position", Vec3::new(0.0, 0.0, 5.0));
        let forward = point("look_at", Vec3::ZERO) - position;
        let lens = if spec.kind == "orthographic" {
            let half = number(spec, "height").unwrap_or(2.0) * 0.5;
            json!({ "type": "orthographic", "orthographic": { "xmag": half, "ymag": half, "znear": 0.0, "zfar": 1e6 } })
        } else {
            not_perspective(spec, "glTF", writing);
            let fov = field_of_view(spec).to_radians();
            let mut lens = json!({ "yfov": fov, "znear": 0.001 });
            // With an aspect ratio, images of another shape show no less.
            if let Some(shape) =
                number(spec, "frame").filter(|&shape| shape > 0.0).or(picture_aspect_ratio(self.scene))
            {
                lens["aspectRatio"] = json!(shape);
            }
            json!({ "type": "perspective", "perspective": lens })
        };
        let lens = self.push("cameras", lens);
        self.root(json!({
            "name": spec.name,
            "camera": lens,
            "matrix": looking(position, forward, point("up", Vec3::Y)).to_cols_array(),
        }));
    }

    pub(super) fn light(&mut self, spec: &Spec, writing: &mut Writing) {
        let position = vector(spec, "position").unwrap_or(Vec3::new(0.0, 5.0, 0.0));
        let (kind, power, forward) = match spec.kind.as_str() {
            "point" => ("point", colour(spec, "intensity").unwrap_or(Rgb::grey(100.0)), Vec3::NEG_Z),
            "spot" => {
                let at = vector(spec, "look_at").unwrap_or(Vec3::ZERO);
                ("spot", colour(spec, "intensity").unwrap_or(Rgb::grey(100.0)), at - position)
            }
            "directional" => {
                let direction = vector(spec, "direction").unwrap_or(Vec3::NEG_ONE);
                if number(spec, "diameter").is_some_and(|angle| angle > 0.0) {
                    writing.warn(
                        "glTF files cannot store 'diameter' of a directional light: its shadows become hard",
                    );
                }
                ("directional", colour(spec, "irradiance").unwrap_or(Rgb::grey(3.0)), direction)
            }
            "rect" | "sphere" => return self.glowing(spec, position, writing),
            other => {
                return writing.warn(format!("glTF files cannot store lights of kind '{other}': left out"));
            }
        };
        self.uses("KHR_lights_punctual");
        let brightest = power.max_channel();
        let shade = if brightest > 0.0 { power * (1.0 / brightest) } else { power };
        let mut light = json!({ "type": kind, "color": shade.to_array(), "intensity": brightest });
        if kind == "spot" {
            let angle = |key, default: f32| number(spec, key).unwrap_or(default).to_radians();
            let outer = angle("angle", 30.0).min(std::f32::consts::FRAC_PI_2);
            let inner = angle("inner_angle", 25.0).min(outer * 0.999);
            light["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        }
        let light = self.push("lights", light);
        let matrix = looking(position, forward, Vec3::Y).to_cols_array();
        let extension = json!({ "KHR_lights_punctual": { "light": light } });
        self.root(json!({ "name": spec.name, "matrix": matrix, "extensions": extension }));
    }

    /// Writes an area or sphere light as a black surface that emits the same light.
    fn glowing(&mut self, spec: &Spec, position: Vec3, writing: &mut Writing) {
        let edge = |key, default| vector(spec, key).unwrap_or(default);
        let (u, v) = (edge("edge_u", Vec3::X), edge("edge_v", Vec3::Z));
        let radius = number(spec, "radius").unwrap_or(0.5);
        let is_panel = spec.kind == "rect";
        let is_one_sided =
            matches!(spec.parameters.find("sides"), Some((Value::Text(sides), _)) if sides == "front");
        let area = if is_panel { u.cross(v).length() } else { std::f32::consts::PI * radius * radius };
        let radiance = match colour(spec, "radiance").filter(|radiance| !radiance.is_black()) {
            Some(radiance) => radiance,
            None => colour(spec, "intensity").unwrap_or(Rgb::BLACK) * (1.0 / area.max(f32::MIN_POSITIVE)),
        };
        let mesh =
            if is_panel { shapes::quad(position, u, v) } else { shapes::icosphere(position, radius, 4) };
        let (emission, mut material) =
            (super::material::emission(self, radiance), json!({ "name": spec.name }));
        super::material::merge(&mut material, emission);
        material["pbrMetallicRoughness"] = json!({ "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0 });
        if is_panel && !is_one_sided {
            material["doubleSided"] = json!(true);
        }
        let material = self.push("materials", material);
        let mesh: Arc<Mesh> = Arc::new(Mesh { name: String::new(), ..mesh });
        if let Ok(mesh) = self.mesh(&mesh, material, writing) {
            self.root(json!({ "name": spec.name, "mesh": mesh }));
        }
        // The mesh is dropped after this; another may be allocated at the same address.
        self.meshes.retain(|(at, _), _| *at != Arc::as_ptr(&mesh));
    }
}

//! Cameras, lights and materials in another frame: each parameter by its kind and its unit, as its table states them.

use crate::world::dome::longitudes;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{DMat3, DVec3, Vec3};
use bilux_scene::lights::{BuiltLight, build};
use bilux_scene::materials::scale_lengths;
use bilux_scene::{Part, SceneBuilder, Spec, Texture, Value};
use std::sync::Arc;

/// A rotation, and a scale after it.
pub(super) struct Turn {
    pub(super) rotation: DMat3,
    pub(super) scale: f64,
}

/// Vectors that are directions, whose length says nothing.
const DIRECTIONS: [&str; 3] = ["up", "direction", "c0"];

/// Rows of the map of an environment that is turned.
const ROWS: std::ops::RangeInclusive<usize> = 256..=2048;

impl Turn {
    pub(super) fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p * self.scale
    }

    /// Turns and scales all cameras, lights and materials.
    pub(super) fn specs(&self, scene: &mut SceneBuilder) {
        self.environments(scene);
        let SceneBuilder { materials, lights, cameras, .. } = scene;
        let of_cameras = cameras.iter_mut().map(|camera| &mut camera.spec);
        let placed = lights.iter_mut().map(|spec| (Part::Light, spec));
        for (part, spec) in placed.chain(of_cameras.map(|spec| (Part::Camera, spec))) {
            let Some(row) = part.row(&spec.kind) else { continue };
            self.with_defaults(spec, row);
            self.values(&mut spec.parameters.0, row);
        }
        for camera in cameras {
            let Some(row) = Part::Camera.row(&camera.spec.kind) else { continue };
            camera.keyframes.iter_mut().for_each(|(_, changes)| self.values(&mut changes.0, row));
        }
        materials.iter_mut().for_each(|spec| scale_lengths(spec, self.scale));
    }

    /// States the defaults that would mean something else in the new frame.
    fn with_defaults(&self, spec: &mut Spec, row: &Entry) {
        for parameter in row.parameters {
            if spec.parameters.find(parameter.name).is_some() {
                continue;
            }
            let numbers: Vec<f64> = parameter.default.split_whitespace().flat_map(str::parse).collect();
            let mut value = match numbers[..] {
                [number] if number > 0.0 => Value::Number(number),
                [x, y, z] => Value::triple([x, y, z].map(|x| x as f32)),
                _ => continue,
            };
            let unstated = value.clone();
            self.value(&mut value, parameter);
            if value != unstated {
                spec.parameters.set(parameter.name, unstated);
            }
        }
    }

    fn values<S>(&self, values: &mut [(String, Value, S)], row: &Entry) {
        for (key, value, _) in values {
            if let Some(parameter) = row.parameters.iter().find(|parameter| parameter.name == key) {
                self.value(value, parameter);
            }
        }
    }

    fn value(&self, value: &mut Value, parameter: &Parameter) {
        let scale = self.scale;
        match (parameter.kind, parameter.unit) {
            (ParameterKind::Vector, _) => {
                let Some(v) = vector(value) else { return };
                let turned = self.rotation * v.as_dvec3();
                let is_direction = DIRECTIONS.contains(&parameter.name);
                *value = Value::from((if is_direction { turned } else { turned * scale }).as_vec3());
            }
            (_, unit) => value.scale_lengths(unit, scale),
        }
    }

    /// Environments that are not the same all around, as maps that are turned.
    fn environments(&self, scene: &mut SceneBuilder) {
        if self.rotation == DMat3::IDENTITY {
            return;
        }
        for spec in scene.lights.iter_mut().filter(|spec| spec.kind == "environment") {
            let map = match spec.parameters.find("radiance") {
                Some((Value::Texture(index), _)) => scene.textures.get(*index),
                _ => None,
            };
            let is_graded = ["zenith", "horizon", "ground"].iter().any(|k| spec.parameters.find(k).is_some());
            let Ok(BuiltLight::Light(built)) = build(spec, &scene.textures) else { continue };
            if map.is_none() && !is_graded {
                continue;
            }
            let rows = map.map_or(0, |map| map.height()).clamp(*ROWS.start(), *ROWS.end());
            let back = self.rotation.transpose();
            let radiance = |towards: Vec3| built.le((back * towards.as_dvec3()).as_vec3());
            let texels = longitudes(rows).map(radiance).collect();
            scene.textures.push(Arc::new(Texture::new(&spec.name, 2 * rows, rows, texels, true)));
            spec.parameters.0.retain(|(key, ..)| matches!(&**key, "backdrop" | "group"));
            spec.parameters.set("radiance", Value::Texture(scene.textures.len() - 1));
        }
    }
}

fn vector(value: &Value) -> Option<Vec3> {
    Spec::new("", "").with("v", value.clone()).vector("v")
}

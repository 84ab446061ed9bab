//! `orthographic`: parallel rays, as in a plan.

use super::perspective::vector;
use super::{Camera, CameraEntry, CameraSample, around, look};
use crate::error::SceneError;
use bilux_accel::Ray;
use bilux_math::Vec3;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "orthographic",
        summary: "parallel rays, as in a plan",
        source: "",
        parameters: &[
            vector("position", "the middle of the film", "0 0 5"),
            vector("look_at", "the point in the middle of the picture", "0 0 0"),
            vector("up", "what is up in the picture", "0 1 0"),
            Parameter {
                name: "height",
                summary: "height of what is seen",
                unit: "m",
                kind: ParameterKind::Number { min: 1e-9, max: 1e9 },
                default: "2",
            },
        ],
    },
    build: |keys, aspect| {
        let keys = keys
            .iter()
            .map(|(time, reader)| {
                let position = reader.vector("position");
                let axes =
                    look(position, reader.vector("look_at"), reader.vector("up")).ok_or_else(|| {
                        SceneError::invalid(
                            "a camera must not look along its own 'up', nor at the point where it stands",
                            reader.span("look_at"),
                        )
                    })?;
                Ok((*time, Key { position, axes, half_height: reader.number("height") * 0.5 }))
            })
            .collect::<Result<Vec<_>, SceneError>>()?;
        Ok(Arc::new(Orthographic { keys, aspect }))
    },
};

struct Orthographic {
    keys: Vec<(f32, Key)>,
    aspect: f32,
}

#[derive(Clone, Copy)]
struct Key {
    position: Vec3,
    axes: [Vec3; 3],
    half_height: f32,
}

impl Camera for Orthographic {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let (low, high, t) = around(&self.keys, sample.time);
        let half_height = low.half_height + (high.half_height - low.half_height) * t;
        let x = (2.0 * sample.film.x - 1.0) * half_height * self.aspect;
        let y = (1.0 - 2.0 * sample.film.y) * half_height;
        let [right, up, forward] = low.axes;
        let origin = low.position.lerp(high.position, t) + right * x + up * y;
        Ray { time: sample.time, ..Ray::new(origin.to_array(), forward.to_array()) }
    }

    fn has_lens(&self) -> bool {
        false
    }

    fn forward(&self, time: f32) -> Vec3 {
        around(&self.keys, time).0.axes[2]
    }
}

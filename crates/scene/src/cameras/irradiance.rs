//! `irradiance`: the light that a flat rectangle receives, as on a plan of illuminances.

use super::CameraEntry;
use super::orthographic::Orthographic;
use super::perspective::{MIRRORED, vector};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "irradiance",
        summary: "not an eye but a meter: each pixel is the light that its part of a flat rectangle receives, over π, \
                  which is the radiance of white matt paper there; only for path and auto",
        source: "",
        parameters: &[
            vector("position", "the centre of the rectangle", "0 0 0"),
            vector(
                "look_at",
                "a point straight ahead of the centre, on the side that receives light",
                "0 1 0",
            ),
            vector(
                "up",
                "the up direction in the picture, which is that of an eye before the rectangle",
                "0 0 -1",
            ),
            Parameter {
                name: "height",
                summary: "height of the rectangle; its width follows from the shape of the picture",
                unit: "m",
                kind: ParameterKind::Number { min: 1e-9, max: 1e9 },
                default: "2",
            },
            MIRRORED,
        ],
    },
    build: |keys, aspect| {
        // Who looks at the rectangle sees its left where one that looks out of it has its right.
        Ok(Arc::new(Orthographic::read(keys, -aspect)?.receiving()))
    },
};

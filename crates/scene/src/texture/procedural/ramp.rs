//! Gradients from colour to colour.

use super::place::{U_OFFSET, UvPlacement, V_OFFSET, u_scale, v_scale};
use super::{Pattern, TextureEntry};
use crate::texture::Texture;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec2};
use std::sync::Arc;

/// The row of `ramp`.
pub(super) const ENTRY: TextureEntry = TextureEntry {
    entry: Entry {
        name: "ramp",
        summary: "piecewise linear colour ramp",
        source: "",
        parameters: &[
            Parameter {
                name: "stops",
                summary: "the colour stops; the colour is constant before the first and after the last",
                unit: "",
                kind: ParameterKind::Stops { min: 0.0, max: 1e12 },
                default: "",
            },
            Parameter {
                name: "along",
                summary: "the coordinate: u, v, or radius, which is 0 at the centre and 1 at the middle of an edge",
                unit: "",
                kind: ParameterKind::Choice(&["u", "v", "radius"]),
                default: "u",
            },
            Parameter {
                name: "input",
                summary: "a texture of numbers to use as the coordinate, instead of `along`",
                unit: "",
                kind: ParameterKind::Texture,
                default: "none",
            },
            u_scale("factor on u before the ramp is evaluated", "1"),
            v_scale("factor on v before the ramp is evaluated", "1"),
            U_OFFSET,
            V_OFFSET,
        ],
    },
    build: |reader, parts| {
        let along = match (parts.texture(reader, "input"), &*reader.text("along")) {
            (Some(texture), _) => Along::Input(texture),
            (None, "v") => Along::V,
            (None, "radius") => Along::Radius,
            (None, _) => Along::U,
        };
        Ok(Arc::new(Ramp { stops: reader.stops("stops"), along, place: UvPlacement::read(reader) }))
    },
};

#[derive(Debug)]
struct Ramp {
    /// At least one; positions never decrease.
    stops: Vec<(f32, Rgb)>,
    along: Along,
    place: UvPlacement,
}

#[derive(Debug)]
enum Along {
    U,
    V,
    Radius,
    Input(Arc<Texture>),
}

impl Pattern for Ramp {
    fn at(&self, uv: Vec2) -> Rgb {
        let at = self.place.of(uv);
        let x = match &self.along {
            Along::U => at.x,
            Along::V => at.y,
            Along::Radius => 2.0 * (at - 0.5).length(),
            Along::Input(texture) => texture.number(uv),
        };
        let next = self.stops.partition_point(|(position, _)| *position <= x);
        match (next.checked_sub(1).and_then(|i| self.stops.get(i)), self.stops.get(next)) {
            (Some((from, a)), Some((to, b))) => a.lerp(*b, (x - from) / (to - from)),
            (Some((_, colour)), None) | (None, Some((_, colour))) => *colour,
            (None, None) => Rgb::BLACK,
        }
    }
}

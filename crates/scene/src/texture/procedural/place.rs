//! Placement of a procedural texture: the transform of texture coordinates before it is evaluated.

use crate::Reader;
use bilux_math::Vec2;
use bilux_math::registry::{Parameter, ParameterKind};

/// A scale and a shift.
#[derive(Clone, Copy, Debug)]
pub(super) struct UvPlacement {
    pub(super) scale: Vec2,
    pub(super) shift: Vec2,
}

const fn number(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: -1e6, max: 1e6 }, default }
}

/// `summary` says what the factor counts.
pub(super) const fn u_scale(summary: &'static str, default: &'static str) -> Parameter {
    number("u_scale", summary, default)
}

pub(super) const fn v_scale(summary: &'static str, default: &'static str) -> Parameter {
    number("v_scale", summary, default)
}

pub(super) const U_OFFSET: Parameter = number("u_offset", "offset added to u afterwards", "0");
pub(super) const V_OFFSET: Parameter = number("v_offset", "offset added to v afterwards", "0");

impl UvPlacement {
    pub(super) fn read(reader: &Reader) -> UvPlacement {
        let pair = |u: &str, v: &str| Vec2::new(reader.number(u), reader.number(v));
        UvPlacement { scale: pair("u_scale", "v_scale"), shift: pair("u_offset", "v_offset") }
    }

    pub(super) fn of(&self, uv: Vec2) -> Vec2 {
        uv * self.scale + self.shift
    }
}

//! The sides from which a camera sees a surface.
//!
//! Rasterisers cull back faces, and models are made for it: the camera looks into a room from outside, through its
//! wall. Light has no such rule. So only the camera sees through such back faces. They still block light, cast shadows
//! and appear in mirrors. See [`crate::Tracer`].

use crate::mesh::sides::Sides;
use bilux_math::registry::{Parameter, ParameterKind};

/// Shared by materials that light does not enter.
pub(super) const VISIBLE_SIDES: Parameter = Parameter {
    name: "visible_sides",
    summary: "the sides that the camera sees: both, or the front, where a triangle's vertices run \
              counter-clockwise; light reaches both",
    unit: "",
    kind: ParameterKind::Choice(Sides::NAMES),
    default: "both",
};

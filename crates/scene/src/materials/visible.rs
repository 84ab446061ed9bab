//! From which sides a camera sees a surface.
//!
//! Programs that draw triangles leave out those whose back they see, and models are made for it: a room is looked into from outside, through
//! its wall. Light knows no such thing. So a camera looks through such backs, and all else meets them: they give shade, and are
//! seen in mirrors. See [`crate::Tracer`].

use crate::lights::Sides;
use bilux_math::registry::{Parameter, ParameterKind};

/// Shared by materials that light does not go into.
pub(super) const VISIBLE_SIDES: Parameter = Parameter {
    name: "visible_sides",
    summary: "from where the camera sees it: from both sides, or from the front, where a triangle's corners run \
              counter-clockwise; light meets both",
    unit: "",
    kind: ParameterKind::Choice(Sides::NAMES),
    default: "both",
};

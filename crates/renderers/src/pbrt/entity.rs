//! Entities that directives describe.

use super::parameters::ParameterList;
use bilux_scene::Span;

/// An entity of a directive: its kind and parameters.
#[derive(Clone, Debug)]
pub(super) struct Entity {
    pub(super) kind: String,
    pub(super) parameters: ParameterList,
    pub(super) at: Span,
}

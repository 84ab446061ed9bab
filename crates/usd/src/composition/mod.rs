//! Composition: from layers that refer to each other to one tree of prims.

mod arcs;
mod clips;
mod expand;
mod layers;
mod node;
mod packages;
mod prims;
mod variants;

pub(super) use clips::Clipped;
pub(super) use layers::Layers;
pub(super) use node::Opinion;
pub(super) use packages::root_of_package;
pub(super) use prims::{Prim, compose};

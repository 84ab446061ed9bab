//! Composition: from layers that refer to each other to one tree of prims.

mod arcs;
mod clips;
mod expand;
mod layers;
mod node;
mod packages;
mod prims;
mod variants;

pub(crate) use clips::Clipped;
pub(crate) use layers::Layers;
pub(crate) use node::Opinion;
pub(crate) use packages::root_of_package;
pub(crate) use prims::{Prim, compose};

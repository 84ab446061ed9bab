//! Materials: what surfaces are bound to, networks of shaders, and `principled`.

mod arnold;
mod bindings;
mod draft;
mod folding;
mod materials;
mod materialx;
mod network;
mod placing;
mod preview;
mod setting;
mod textures;
mod volumes;

pub(super) use bindings::{bound, subset_faces};
pub(super) use draft::Shaded;
pub(super) use materials::material;
pub(super) use volumes::{Filling, filling};

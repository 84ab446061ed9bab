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

pub(crate) use bindings::{bound, subset_faces};
pub(crate) use draft::Shaded;
pub(crate) use materials::material;
pub(crate) use volumes::{Filling, filling};

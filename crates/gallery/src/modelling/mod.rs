//! What the models of the built-in scenes are made with: turned and rounded parts, and surfaces of implicit functions.

pub(crate) mod implicit;
pub(crate) mod isosurface;
pub(crate) mod parts;

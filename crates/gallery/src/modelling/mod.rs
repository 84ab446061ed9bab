//! Parts and tools of the models: turned and rounded shapes, sheets, and surfaces of implicit functions.

pub(crate) mod implicit;
pub(crate) mod isosurface;
pub(crate) mod parts;

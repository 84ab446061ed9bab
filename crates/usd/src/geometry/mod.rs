//! Surfaces, points and curves of prims.

pub(crate) mod meshes;
pub(crate) mod polygons;
pub(crate) mod primvars;
pub(crate) mod refined;
pub(crate) mod shapes;
pub(crate) mod strokes;
pub(crate) mod subdivision;

//! Turns curved shapes into triangles.

pub(crate) mod grid;
pub(crate) mod sphere;
pub(crate) mod tubes;

//! Turns curved shapes into triangles.

pub mod grid;
pub mod sphere;
pub mod tubes;

//! Triangles for trimmed surfaces.
//!
//! An edge is sampled once, so that the faces on both sides of it meet without cracks. The boundary of a face goes to the parameters of its
//! surface, and a constrained Delaunay triangulation fills it there, with more points inside where the surface bends.

mod boundary;
mod corner;
mod cuts;
mod edges;
mod face;
mod fill;
mod globe;
mod inner;
mod outline;
mod paths;
mod shell;
mod steps;

pub(super) use face::Patch;
pub(super) use shell::{Face, Shape, faces};

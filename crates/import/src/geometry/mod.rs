//! Geometry that knows no files: normals, polygons, splines, subdivision, displacement.

pub mod affine;
pub mod b_spline;
pub mod colours;
pub mod deformation;
pub mod displacement;
pub mod flat;
pub mod normals;
pub mod polygon;
pub mod sharing;
pub mod subdivision;
pub mod tessellation;

//! The ground that the readers and writers of scene files stand on: the state of one read with its limits ([`reading`]), files
//! and archives, text and numbers, meshes and looks as files describe them. The formats themselves are crates above this one, and
//! their table is in `bilux-formats`, which programs use; what is here is for the formats alone, and changes with them.

#![allow(missing_docs, reason = "names say what fields and constructors are, and only formats use them")]

pub mod affine;
pub mod archive;
pub mod as_metal;
pub mod authors;
pub mod b_spline;
pub mod bake;
pub mod between_keys;
pub mod blocks;
pub mod budget;
pub mod calibrations;
pub mod camera_loss;
pub mod choice;
pub mod cloud;
pub mod colours;
pub mod deformation;
pub mod displacement;
pub mod displacing;
pub mod dome;
pub mod emissive;
pub mod environment_maps;
pub mod error;
pub mod files;
pub mod filling;
pub mod fitting;
pub mod flat;
pub mod float;
pub mod formats;
pub mod frame;
pub mod fresnel;
pub mod grids;
pub mod gzip;
pub mod heights;
pub mod images;
pub mod includes;
pub mod indexed_faces;
pub mod locating;
pub mod luminaires;
pub mod mounting;
pub mod movement;
pub mod names;
pub mod normals;
pub mod oddities;
pub mod opening;
pub mod options;
pub mod phong;
pub mod placement;
mod plain;
pub mod ply;
pub mod polygon;
pub mod polygon_mesh;
pub mod principled_draft;
pub mod reading;
pub mod refining;
pub mod roughness;
pub mod sharing;
pub mod sink;
pub mod spectra;
pub mod spellings;
pub mod strokes;
pub mod subdivision;
pub mod tessellation;
pub mod text;
pub mod texture_or_value;
pub mod values;
pub mod vdb;
pub mod views;
pub mod writing;
pub mod xml;
pub mod zipped;

pub use error::FormatError;
pub use options::{Glass, ReadOptions, WriteOptions};
pub use subdivision::Scheme;

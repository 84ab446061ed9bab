//! Reads and writes scene files. Each format has its own folder; the table is [`SCENE_FORMATS`].
//!
//! A reader converts bytes to a [`bilux_scene::SceneBuilder`], which is plain data: this crate does not validate
//! it against the scene's tables, and renders nothing. For any input, a reader returns a scene, or a
//! [`FormatError`] that states the location and the remedy. It uses no more memory than
//! [`ReadOptions::max_memory`], and opens no file outside the scene's folder unless allowed.

mod affine;
mod archive;
mod as_metal;
mod asc;
mod authors;
mod bake;
mod blocks;
mod budget;
mod calibrations;
mod camera_loss;
mod choice;
mod cloud;
mod colours;
mod dome;
mod e57;
mod emissive;
mod environment_maps;
mod error;
mod fbx;
mod files;
mod filling;
mod fitting;
mod flat;
mod float;
mod formats;
mod fresnel;
mod gltf;
mod grids;
mod gzip;
mod heights;
mod images;
mod includes;
mod indexed_faces;
mod las;
mod locating;
mod luminaires;
mod mitsuba;
mod mounting;
mod movement;
mod names;
mod native;
mod normals;
mod obj;
mod oddities;
mod off;
mod options;
mod packed;
mod pbrt;
mod placement;
mod ply;
mod polygon;
mod polygon_mesh;
mod reading;
mod refining;
mod roughness;
mod sharing;
mod sink;
mod spectra;
mod stl;
mod strokes;
mod subdivision;
mod tessellation;
mod text;
mod texture_or_value;
mod threemf;
mod usd;
mod values;
mod vdb;
mod writing;
mod xml;
mod xyz;
mod zipped;

pub use calibrations::{CalibratedCameras, read_cameras};
pub use error::FormatError;
pub use files::{archive_of, check_not_read, read, read_bytes, write};
pub use formats::{SCENE_FORMATS, SceneFormatEntry, format_named, format_of_path};
pub use grids::{GridOfFile, read_grid, read_grids};
pub use luminaires::read_distribution;
pub use native::{SHAPES, ShapeEntry, overlay, toml_schema};
pub use options::{Glass, ReadOptions, WriteOptions};
pub use subdivision::Scheme;

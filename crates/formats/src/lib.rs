//! Scene files in and out. One format a folder; the table is [`SCENE_FORMATS`].
//!
//! A reader turns bytes into a [`bilux_scene::SceneBuilder`], which is plain data: nothing is checked
//! against the scene's tables here and nothing is rendered. Whatever the bytes, a reader gives a scene or
//! a [`FormatError`] that says where and what to do; it holds no more memory than
//! [`ReadOptions::max_memory`], and opens nothing outside the folder of the scene unless allowed.

mod asc;
mod bake;
mod blocks;
mod budget;
mod cloud;
mod error;
mod float;
mod formats;
mod gltf;
mod images;
mod indexed_faces;
mod las;
mod native;
mod normals;
mod obj;
mod off;
mod options;
mod pbrt;
mod ply;
mod polygon;
mod reading;
mod sharing;
mod stl;
mod strokes;
mod text;
mod values;
mod writing;
mod xyz;

pub use error::FormatError;
pub use formats::{SCENE_FORMATS, SceneFormatEntry, format_named, format_of_path, read, read_bytes, write};
pub use native::{SHAPES, ShapeEntry, toml_schema};
pub use options::{Glass, ReadOptions, WriteOptions};

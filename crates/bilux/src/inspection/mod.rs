//! Reasons why a scene is easy or hard, and what becomes of a sample.

pub mod explain;
pub mod light_path;
pub mod path_drawing;
pub mod strategies;

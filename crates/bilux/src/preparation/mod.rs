//! Scenes before they are rendered: cameras, lights, presets, and what is kept of one build for the next.

pub(crate) mod built;
pub(crate) mod camera_choice;
pub(crate) mod judged;
pub mod presets;
pub(crate) mod scene_warnings;

//! Physically based rendering on ordinary CPUs: everything that Bilux can do, in one crate.
//!
//! ```
//! use bilux::prelude::*;
//!
//! let scene = bilux::generate(&Spec::new("", "cornell"))?;
//! let job = Job::new(&scene, JobRequest::new().size(16, 16).spp(1))?;
//! let picture = job.render(&Quiet)?.picture()?;
//! assert_eq!((picture.width(), picture.height()), (16, 16));
//! # Ok::<(), bilux::Error>(())
//! ```
//!
//! Read a scene with [`load`] or make one with [`generate`]; say in a [`JobRequest`] what you want of it; the [`settings`] combine
//! that with what the scene's file asks for; and a [`Job`] renders it.

pub mod budget;
mod built;
mod camera_choice;
pub mod checkpoint;
pub mod compositing;
pub mod description;
mod display;
pub mod encoding;
pub mod error;
pub mod explain;
pub mod fingerprint;
pub mod job;
mod judged;
mod labels;
mod layers;
pub mod lidar;
pub mod light_path;
pub mod memory;
pub mod memory_limit;
pub mod merging;
pub mod metadata;
mod outcome;
mod own_light;
pub mod parts;
pub mod path_drawing;
pub mod presets;
pub mod progressive;
mod request;
mod scene_warnings;
pub mod sensing;
pub mod series;
pub mod session;
pub mod settings;
pub mod strategies;
pub mod tables;
pub mod transient;
pub mod watch;
pub mod wording;
mod writing;

pub use bilux_accel as accel;
pub use bilux_formats as formats;
pub use bilux_math as math;
pub use bilux_pictures as pictures;
pub use bilux_scene as scene;
pub use bilux_transport as transport;
pub use bilux_visibility as visibility;

pub use bilux_transport::Silent as Quiet;
pub use built::Built;
pub use compositing::ExtraLayers;
pub use display::Display;
pub use error::Error;
pub use job::Job;
pub use outcome::{Outcome, Surfaces};
pub use progressive::{Budget, Progressive};
pub use request::{Denoised, JobRequest};
pub use series::Series;
pub use session::{Edit, Session};
pub use settings::Settings;
pub use writing::{lost_alpha, lost_transparency};

use bilux_scene::{SceneBuilder, Spec};
use std::path::Path;

/// Names that most programs need.
pub mod prelude {
    pub use crate::{Denoised, Error, Job, JobRequest, Outcome, Quiet, Settings};
    pub use bilux_math::{Rgb, Transform, Vec2, Vec3};
    pub use bilux_pictures::Picture;
    pub use bilux_scene::cameras::CameraSpec;
    pub use bilux_scene::typed::{lights, materials};
    pub use bilux_scene::{Mesh, Object, Parameters, SceneBuilder, Spec, Value};
}

/// Reads a scene file in any known format.
///
/// # Errors
/// If the file cannot be read or its contents are wrong; the message says where.
pub fn load(path: &Path, options: &bilux_formats::ReadOptions) -> Result<SceneBuilder, Error> {
    Ok(bilux_formats::read(path, options)?)
}

/// Makes one of the built-in scenes: `kind` is its name.
///
/// # Errors
/// If no generator has this name, or a parameter is wrong.
pub fn generate(spec: &Spec) -> Result<SceneBuilder, Error> {
    Ok(bilux_scene::generators::generate(spec)?)
}

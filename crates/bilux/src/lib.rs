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

pub mod checkpoint;
pub mod encoding;
pub mod error;
mod inspection;
mod interface;
pub mod job;
mod limits;
mod output;
mod preparation;
mod request;
mod sensors;
pub mod session;
pub mod settings;

pub use bilux_accel as accel;
pub use bilux_formats as formats;
pub use bilux_gallery as gallery;
pub use bilux_math as math;
pub use bilux_pictures as pictures;
pub use bilux_scene as scene;
pub use bilux_transport as transport;
pub use bilux_visibility as visibility;
pub use inspection::explain;
pub use inspection::light_path;
pub use inspection::path_drawing;
pub use inspection::strategies;

pub use interface::tables;
pub use interface::wording;
pub use job::compositing;
pub use job::fingerprint;
pub use job::parts;
pub use job::progressive;
pub use job::series;
pub use limits::budget;
pub use limits::memory;
pub use limits::memory_limit;
pub use output::description;
pub use output::merging;
pub use output::metadata;
pub use preparation::presets;
pub use sensors::lidar;
pub use sensors::sensing;
pub use sensors::transient;
pub use session::watch;

pub use bilux_transport::Silent as Quiet;
pub use error::Error;
pub use job::Job;
pub use job::compositing::ExtraLayers;
pub use job::outcome::{Outcome, Surfaces};
pub use job::progressive::{Budget, Progressive};
pub use job::series::Series;
pub use output::display::Display;
pub use output::writing::{lost_alpha, lost_transparency};
pub use preparation::built::Built;
pub use request::{Denoised, JobRequest};
pub use session::{Edit, Session};
pub use settings::Settings;

use bilux_scene::{SceneBuilder, Spec};
use std::path::Path;

/// Names that most programs need.
pub mod prelude {
    pub use crate::Denoised;
    pub use crate::Error;
    pub use crate::Job;
    pub use crate::JobRequest;
    pub use crate::Outcome;
    pub use crate::Quiet;
    pub use crate::Settings;
    pub use bilux_math::{Rgb, Transform, Vec2, Vec3};
    pub use bilux_pictures::Picture;
    pub use bilux_scene::cameras::CameraSpec;
    pub use bilux_scene::typed::{cameras, lights, materials};
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
    Ok(bilux_gallery::generate(spec)?)
}

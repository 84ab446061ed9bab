//! The procedural scenes that ship with Bilux. The table is [`GENERATORS`]; a scene is a file, or a folder with its models.
//!
//! ```
//! use bilux_scene::{Spec, Value};
//!
//! let five = Spec::new("", "teapots").with("count", Value::Integer(5));
//! assert_eq!(bilux_gallery::generate(&five)?.objects.len(), 6);
//! # Ok::<(), bilux_scene::SceneError>(())
//! ```

mod copies;
mod cornell;
mod interior;
mod modelling;
mod scan;
mod stages;
pub mod teapot;
mod teapots;
mod trio;

pub use copies::copies;

use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};
use bilux_scene::{Reader, SceneBuilder, SceneError, Spec};

/// A row of [`GENERATORS`].
#[derive(Clone, Copy, Debug)]
pub struct GeneratorEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// About how many triangles its meshes have where a parameter decides that; otherwise 0, for few.
    pub triangles: fn(&Reader) -> u64,
    /// Makes the scene, with its camera and its lights.
    pub generate: fn(&Reader) -> Result<SceneBuilder, SceneError>,
}

/// All generated scenes.
pub static GENERATORS: &[GeneratorEntry] = &[
    trio::ENTRY,
    teapots::ENTRY,
    teapot::ENTRY,
    cornell::ENTRY,
    cornell::SPHERES,
    interior::ENTRY,
    scan::ENTRY,
    stages::daylight::ENTRY,
    stages::indirect::ENTRY,
    stages::lampshades::ENTRY,
    stages::caustics::ENTRY,
    stages::pool::ENTRY,
    stages::bidirectional::ENTRY,
    stages::door_ajar::ENTRY,
    stages::many_lights::ENTRY,
    stages::fog::ENTRY,
    stages::cloud::ENTRY,
    stages::campfire::ENTRY,
    stages::jade::ENTRY,
    stages::milk::ENTRY,
    stages::piglet::ENTRY,
];

/// Makes the scene that a spec describes.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn generate(spec: &Spec) -> Result<SceneBuilder, SceneError> {
    let names = GENERATORS.iter().map(|row| row.entry.name);
    let row = GENERATORS
        .iter()
        .find(|row| row.entry.name == spec.kind)
        .ok_or_else(|| SceneError::unknown("built-in scene", &spec.kind, names, &spec.span))?;
    (row.generate)(&Reader::new(spec, &row.entry)?)
}

const fn switch(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Bool, default }
}

const fn length(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    let kind = ParameterKind::Number { min: 1e-6, max: 1e6 };
    Parameter { name, summary, unit: "m", kind, default }
}

const fn vector(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "m", kind: ParameterKind::Vector, default }
}

//! Settings that slicers write beside the model: the parts that are printed, their filaments, and the filaments' colours.

mod config;
mod filaments;
mod paint;
mod project;

pub(super) use paint::{Leaf, leaves};
pub(super) use project::{ObjectSettings, Project};

use super::package::Package;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;

/// The project in a package; an empty one if no slicer wrote it.
pub(super) fn project(package: &Package, reading: &mut Reading) -> Result<Project, FormatError> {
    let mut project = Project::default();
    for member in package.members_ending(".config") {
        let name = member.to_lowercase();
        let Some(name) = name.strip_prefix("metadata/") else { continue };
        match name {
            "model_settings.config" => config::objects(package, reading, &member, &mut project)?,
            name if name.ends_with("_model.config") => {
                config::objects(package, reading, &member, &mut project)?;
            }
            "project_settings.config" => filaments::of_json(package, reading, &member, &mut project)?,
            _ => filaments::of_lines(package, reading, &member, &mut project)?,
        }
    }
    Ok(project)
}

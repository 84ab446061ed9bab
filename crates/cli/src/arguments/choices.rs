//! The options for the choices that a scene file leaves open.

use crate::arguments::help;
use crate::arguments::values::{parse_definition, parse_radius, parse_scheme, parse_time};
use bilux::formats::Scheme;
use clap::{Args, ValueEnum};

/// The choices that a scene file leaves open.
#[derive(Args)]
pub struct Choices {
    /// The animation to show, by name or by number from 0 [default: the first, and any others that move other objects]
    #[arg(long, value_name = "NAME|INDEX", help_heading = help::WHAT)]
    pub animation: Option<String>,
    /// The material variant to show, by name or by number from 0 [default: the materials of the meshes]
    #[arg(long, value_name = "NAME|INDEX", help_heading = help::WHAT)]
    pub variant: Option<String>,
    /// Give a variable of the scene this value in place of its default, in Mitsuba's files; may be repeated
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = parse_definition, help_heading = help::WHAT)]
    pub definitions: Vec<(String, String)>,
    /// How to treat glass if the file does not say whether it is solid or thin-walled
    #[arg(long, value_name = "HOW", value_enum, default_value = "auto", help_heading = help::WHAT)]
    pub glass: GlassArgument,
    /// Treat the polygons of an OBJ, PLY or OFF file as the cage of a subdivision surface: catmull-clark, loop or bilinear
    #[arg(long, value_name = "SCHEME", value_parser = parse_scheme, help_heading = help::WHAT)]
    pub subdivide: Option<Scheme>,
    /// Give the file's point lights this radius, in metres, which softens their shadows [default: 0]
    #[arg(long, value_name = "RADIUS", default_value_t = 0.0, hide_default_value = true, allow_hyphen_values = true,
        value_parser = parse_radius, help_heading = help::LIGHT)]
    pub light_radius: f32,
}

/// Definitions as they are written.
pub fn defined(definitions: &[(String, String)]) -> Vec<String> {
    definitions.iter().map(|(name, value)| format!("{name}={value}")).collect()
}

/// The same choices, and a time.
#[derive(Args)]
pub struct Posed {
    #[command(flatten)]
    pub choices: Choices,
    /// The time to show, in seconds, for files whose meshes deform [default: 0]
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, hide_default_value = true, allow_hyphen_values = true,
        value_parser = parse_time, help_heading = help::WHAT)]
    pub at: f32,
    /// The format of the scene on standard input; auto detects it from the first bytes
    #[arg(long, value_name = "NAME|auto", default_value = "auto", help_heading = help::WHAT)]
    pub input_format: String,
}

/// See [`Choices::glass`].
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GlassArgument {
    /// Solid where the mesh is closed, a thin pane elsewhere
    Auto,
    /// A thin pane everywhere
    Thin,
    /// Solid everywhere
    Solid,
}

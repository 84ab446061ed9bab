//! What is chosen where a scene file leaves a choice, as it is typed.

use crate::values::parse_radius;
use clap::{Args, ValueEnum};

/// What is chosen where a scene file leaves a choice.
#[derive(Args)]
pub struct Choices {
    /// The animation to follow, by name or number [default: the first, and those that move other things]
    #[arg(long, value_name = "NAME|INDEX")]
    pub animation: Option<String>,
    /// The set of materials to show, where a file has several
    #[arg(long, value_name = "NAME|INDEX")]
    pub variant: Option<String>,
    /// Glass that says nothing of a thickness: `auto` makes closed meshes solid
    #[arg(long, value_name = "HOW", value_enum, default_value = "auto")]
    pub glass: GlassArgument,
    /// Give point lights of the file a size, in metres
    #[arg(long, value_name = "RADIUS", default_value_t = 0.0, hide_default_value = true, value_parser = parse_radius)]
    pub light_radius: f32,
}

/// The same, and when.
#[derive(Args)]
pub struct Posed {
    #[command(flatten)]
    pub choices: Choices,
    /// When, in seconds, where meshes bend
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, hide_default_value = true)]
    pub at: f32,
}

/// See [`Choices::glass`].
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GlassArgument {
    /// Solid where the mesh is closed, else a thin wall
    Auto,
    /// Walls without thickness
    Thin,
    /// Solid
    Solid,
}

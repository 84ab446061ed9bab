//! What a reader may do and how a writer should.

use std::path::PathBuf;

/// What reading a scene may take and open, and what is chosen where a file leaves a choice.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// The most bytes that the files and what they decode to may take together.
    pub max_memory: u64,
    /// Whether files outside the scene's own folder may be opened.
    pub allow_outside: bool,
    /// Where files that a pbrt scene names are looked for too, when they are not in its folder: pbrt looks in the working
    /// directory. They may be opened if they lie in this folder.
    pub working_folder: Option<PathBuf>,
    /// Whether what would be a warning is an error.
    pub strict: bool,
    /// Whether all that a file holds is checked, shown or not, and each fault becomes a warning (glTF).
    pub validate: bool,
    /// Faces of a mesh without normals look smooth where they meet at less than this angle, in degrees;
    /// at 0 nothing is added to the mesh, and its faces look flat.
    pub crease_angle: f32,
    /// When, in seconds, in formats whose movements bend meshes (glTF): everything stands as it does then.
    pub time: f32,
    /// Whether to look too where everything stands from the beginning to the end ([`bilux_scene::Inventory::movement`]).
    pub whole_movement: bool,
    /// The animation to follow, by its name or counted from 0; else the first, and those that move other things.
    pub animation: Option<String>,
    /// The variant of materials to show, by its name or counted from 0; else the materials that meshes name.
    pub variant: Option<String>,
    /// What clear materials are that say nothing of a thickness.
    pub glass: Glass,
    /// Lights from points get this radius, in metres, where it is above 0.
    pub light_radius: f32,
}

impl Default for ReadOptions {
    /// 4 GiB, nothing outside, warnings, creases at 40 degrees, time 0, and what files choose themselves.
    fn default() -> ReadOptions {
        ReadOptions {
            max_memory: 4 << 30,
            allow_outside: false,
            working_folder: None,
            strict: false,
            validate: false,
            crease_angle: 40.0,
            time: 0.0,
            whole_movement: false,
            animation: None,
            variant: None,
            glass: Glass::Auto,
            light_radius: 0.0,
        }
    }
}

/// What clear materials are that say nothing of a thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glass {
    /// Solid where the mesh is closed, else walls without thickness.
    #[default]
    Auto,
    /// Walls without thickness.
    Thin,
    /// Solid.
    Solid,
}

/// How a scene is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Text where a format has both text and binary (PLY, STL).
    pub ascii: bool,
}

//! Options for reading and writing scenes.

use crate::geometry::subdivision::Scheme;
use std::path::PathBuf;

/// Limits and choices for reading a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// The maximum number of bytes for the files and their decoded contents together.
    pub max_memory: u64,
    /// If true, files outside the scene's own folder may be opened.
    pub allow_outside: bool,
    /// If true, files of the whole package may be opened that the scene's folder belongs to: up to the folder with `package.xml`
    /// (ROS), `model.config` (Gazebo) or `.git`, or with a folder `textures` beside the scene's.
    pub whole_package: bool,
    /// A second folder to search for the files of a pbrt scene, as pbrt searches its working directory. Files in
    /// this folder may be opened.
    pub working_folder: Option<PathBuf>,
    /// If true, warnings become errors.
    pub strict: bool,
    /// If true, validates the whole file, shown or not, and reports each fault as a warning (glTF).
    pub validate: bool,
    /// The crease angle in degrees: faces of a mesh without normals that meet at a smaller angle are smooth.
    ///
    /// At 0 no normals are added, and the faces are flat.
    pub crease_angle: f32,
    /// The time in seconds at which the scene is posed, in formats whose animations deform meshes (glTF).
    pub time: f32,
    /// If true, also samples the whole animation, to find where objects move
    /// ([`bilux_scene::SceneBuilder::movement`]).
    pub whole_movement: bool,
    /// The animation to play, by name or by number from 0; by default the first, and those that animate other
    /// targets.
    pub animation: Option<String>,
    /// The material variant to show, by name or by number from 0; by default the materials of the meshes.
    pub variant: Option<String>,
    /// If given, polygons of formats that do not say whether their surfaces are smooth (OBJ, PLY, OFF) are the cage of a
    /// subdivision surface.
    pub subdivide: Option<Scheme>,
    /// Values for variables of the scene, by their names (Mitsuba): they replace the defaults of the file.
    pub definitions: Vec<(String, String)>,
    /// Interpretation of transmissive materials without a thickness.
    pub glass: Glass,
    /// The radius of point lights in metres, if above 0.
    pub light_radius: f32,
    /// The layer of a picture that the user names next to the scene, such as its surroundings; by default its main
    /// picture.
    pub picture_layer: Option<String>,
}

impl Default for ReadOptions {
    /// 4 GiB, no files outside of the package, warnings, a crease angle of 40 degrees, time 0, and the choices of the files.
    fn default() -> ReadOptions {
        ReadOptions {
            max_memory: 4 << 30,
            allow_outside: false,
            whole_package: true,
            working_folder: None,
            strict: false,
            validate: false,
            crease_angle: 40.0,
            time: 0.0,
            whole_movement: false,
            animation: None,
            variant: None,
            subdivide: None,
            definitions: Vec::new(),
            glass: Glass::Auto,
            light_radius: 0.0,
            picture_layer: None,
        }
    }
}

/// Interpretation of transmissive materials without a thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Glass {
    /// Solid if the mesh is closed, otherwise thin walls.
    #[default]
    Auto,
    /// Thin walls.
    Thin,
    /// Solid.
    Solid,
}

/// Options for writing a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// If true, writes text in formats that have both text and binary (PLY, STL).
    pub ascii: bool,
}

//! Every table of variants by its name: what `bilux list` prints, and what the Python package offers.

use bilux_math::registry::{Entry, ParameterKind};

/// One table.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// The name of the table, in the plural.
    pub name: &'static str,
    /// The kind of things that it lists.
    pub summary: &'static str,
    /// The rows.
    pub rows: fn() -> Vec<Entry>,
    /// Further details of the row with a name: a heading and words, several times.
    pub details: fn(&str) -> Vec<Detail>,
}

/// A heading, and the words under it.
pub type Detail = (&'static str, Vec<&'static str>);

fn none(_: &str) -> Vec<Detail> {
    Vec::new()
}

/// The parts of scenes that files of some formats lose.
const PARTS: &[&str] =
    &["objects", "instances", "motion", "materials", "textures", "media", "lights", "cameras", "settings"];

fn of_scene_format(name: &str) -> Vec<Detail> {
    let Some(row) = bilux_formats::SCENE_FORMATS.iter().find(|row| row.entry.name == name) else {
        return Vec::new();
    };
    let holds = |part: &&&str| {
        let is_it = |held: &&str| held.starts_with(**part) || (*held == "animation" && **part == "motion");
        row.capabilities.iter().any(is_it)
    };
    let mut details = vec![
        ("extensions", row.extensions.to_vec()),
        ("can be", access(row.reads(), row.writes())),
        ("holds", row.capabilities.to_vec()),
    ];
    if row.writes() {
        details.push(("loses", PARTS.iter().filter(|part| !holds(part)).copied().collect()));
    }
    details
}

fn of_picture_format(name: &str) -> Vec<Detail> {
    let row = bilux_pictures::formats::PICTURE_FORMATS.iter().find(|row| row.entry.name == name);
    let details = |row: &bilux_pictures::formats::PictureFormatEntry| {
        vec![("extensions", row.extensions.to_vec()), ("can be", access(true, row.write.is_some()))]
    };
    row.map_or_else(Vec::new, details)
}

fn access(reads: bool, writes: bool) -> Vec<&'static str> {
    [("read", reads), ("written", writes)].into_iter().filter(|(_, can)| *can).map(|(word, _)| word).collect()
}

macro_rules! rows {
    ($table:expr) => {
        || $table.iter().map(|row| row.entry).collect()
    };
}

/// Every table.
pub static TABLES: &[Table] = &[
    Table {
        name: "integrators",
        summary: "light-transport algorithms",
        rows: rows!(bilux_transport::integrators::INTEGRATORS),
        details: none,
    },
    Table {
        name: "accels",
        summary: "acceleration structures for ray queries",
        rows: rows!(bilux_accel::ACCELERATORS),
        details: none,
    },
    Table {
        name: "visibility",
        summary: "hidden-surface removal",
        rows: rows!(bilux_visibility::VISIBILITY),
        details: none,
    },
    Table {
        name: "materials",
        summary: "what surfaces are made of",
        rows: rows!(bilux_scene::materials::MATERIALS),
        details: none,
    },
    Table {
        name: "textures",
        summary: "procedural textures",
        rows: rows!(bilux_scene::texture::TEXTURES),
        details: none,
    },
    Table {
        name: "bsdfs",
        summary: "lobes that materials are built from",
        rows: rows!(bilux_scene::bsdf::BSDFS),
        details: none,
    },
    Table {
        name: "phases",
        summary: "phase functions: the directions that media scatter light into",
        rows: rows!(bilux_scene::media::PHASES),
        details: none,
    },
    Table {
        name: "densities",
        summary: "densities of media that are formulas",
        rows: rows!(bilux_scene::media::DENSITIES),
        details: none,
    },
    Table {
        name: "lights",
        summary: "light sources",
        rows: rows!(bilux_scene::lights::LIGHTS),
        details: none,
    },
    Table {
        name: "cameras",
        summary: "kinds of camera",
        rows: rows!(bilux_scene::cameras::CAMERAS),
        details: none,
    },
    Table {
        name: "generators",
        summary: "built-in scenes",
        rows: rows!(bilux_gallery::GENERATORS),
        details: none,
    },
    Table {
        name: "presets",
        summary: "cameras and surroundings for files without a camera or lights",
        rows: rows!(crate::preparation::presets::PRESETS),
        details: none,
    },
    Table {
        name: "formats",
        summary: "formats of scene files",
        rows: rows!(bilux_formats::SCENE_FORMATS),
        details: of_scene_format,
    },
    Table {
        name: "picture-formats",
        summary: "formats of picture files",
        rows: rows!(bilux_pictures::formats::PICTURE_FORMATS),
        details: of_picture_format,
    },
    Table {
        name: "tonemaps",
        summary: "tone-mapping curves",
        rows: rows!(bilux_pictures::tonemap::TONEMAPS),
        details: none,
    },
    Table {
        name: "denoisers",
        summary: "denoising methods, the best first",
        rows: rows!(bilux_pictures::DENOISERS),
        details: none,
    },
    Table {
        name: "filters",
        summary: "pixel reconstruction filters",
        rows: rows!(bilux_transport::filters::FILTERS),
        details: none,
    },
    Table {
        name: "aovs",
        summary: "arbitrary output variables: what a render can write as well as the picture",
        rows: rows!(bilux_transport::aovs::AOVS),
        details: none,
    },
    Table {
        name: "metrics",
        summary: "measures of how much a picture differs from a reference",
        rows: rows!(bilux_pictures::metrics::METRICS),
        details: none,
    },
    Table {
        name: "sensor",
        summary: "what can be said of a sensor, for a picture of photons",
        rows: || vec![bilux_pictures::sensor::SENSOR],
        details: none,
    },
    Table {
        name: "lidar",
        summary: "what can be said of a laser scanner",
        rows: || vec![bilux_transport::lidar::LIDAR],
        details: none,
    },
    Table {
        name: "settings",
        summary: "the keys of [render] in scene files and of --set",
        rows: || vec![crate::settings::RENDER],
        details: none,
    },
];

/// The values that a parameter of this kind can take, as text.
pub fn values(kind: ParameterKind) -> String {
    match kind {
        ParameterKind::Bool => "true or false".to_owned(),
        ParameterKind::Integer { min, max } => format!("{min} to {max}"),
        ParameterKind::Number { min, max } => format!("{min} to {max}"),
        ParameterKind::Colour { min, max } => format!("colour {min} to {max}"),
        ParameterKind::ColourTexture { min, max } => format!("colour {min} to {max}, or a texture"),
        ParameterKind::NumberTexture { min, max } => format!("{min} to {max}, or a texture"),
        ParameterKind::Texture => "texture".to_owned(),
        ParameterKind::Grid => "grid".to_owned(),
        ParameterKind::Distribution => "a file of a lamp".to_owned(),
        ParameterKind::Stops { min, max } => format!("[position, colour {min} to {max}], several"),
        ParameterKind::Vector => "x, y, z".to_owned(),
        ParameterKind::Choice(words) => words.join("|"),
        ParameterKind::Text => "text".to_owned(),
        ParameterKind::Material => "a material's name".to_owned(),
    }
}

//! Every table of variants by its name: what `bilux list` prints, and what the Python package offers.

use bilux_math::registry::{Entry, ParameterKind};

/// One table.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Its name, in the plural.
    pub name: &'static str,
    /// What it lists.
    pub summary: &'static str,
    /// Its rows.
    pub rows: fn() -> Vec<Entry>,
}

macro_rules! rows {
    ($table:expr) => {
        || $table.iter().map(|row| row.entry).collect()
    };
}

/// Every table.
pub const TABLES: &[Table] = &[
    Table {
        name: "integrators",
        summary: "light-transport algorithms",
        rows: rows!(bilux_transport::integrators::INTEGRATORS),
    },
    Table {
        name: "accels",
        summary: "acceleration structures for ray queries",
        rows: rows!(bilux_accel::ACCELERATORS),
    },
    Table {
        name: "visibility",
        summary: "hidden-surface removal",
        rows: rows!(bilux_visibility::VISIBILITY),
    },
    Table {
        name: "materials",
        summary: "what surfaces are made of",
        rows: rows!(bilux_scene::materials::MATERIALS),
    },
    Table { name: "textures", summary: "procedural textures", rows: rows!(bilux_scene::texture::TEXTURES) },
    Table {
        name: "bsdfs",
        summary: "lobes that materials are built from",
        rows: rows!(bilux_scene::bsdf::BSDFS),
    },
    Table {
        name: "phases",
        summary: "phase functions: the directions that media scatter light into",
        rows: rows!(bilux_scene::media::PHASES),
    },
    Table {
        name: "densities",
        summary: "densities of media that are formulas",
        rows: rows!(bilux_scene::media::DENSITIES),
    },
    Table { name: "lights", summary: "light sources", rows: rows!(bilux_scene::lights::LIGHTS) },
    Table { name: "cameras", summary: "kinds of camera", rows: rows!(bilux_scene::cameras::CAMERAS) },
    Table {
        name: "generators",
        summary: "built-in scenes",
        rows: rows!(bilux_scene::generators::GENERATORS),
    },
    Table {
        name: "presets",
        summary: "cameras and surroundings for files without a camera or lights",
        rows: rows!(crate::presets::PRESETS),
    },
    Table { name: "formats", summary: "formats of scene files", rows: rows!(bilux_formats::SCENE_FORMATS) },
    Table {
        name: "picture-formats",
        summary: "formats of picture files",
        rows: rows!(bilux_pictures::formats::PICTURE_FORMATS),
    },
    Table {
        name: "tonemaps",
        summary: "tone-mapping curves",
        rows: rows!(bilux_pictures::tonemap::TONEMAPS),
    },
    Table {
        name: "denoisers",
        summary: "denoising methods, the best first",
        rows: rows!(bilux_pictures::DENOISERS),
    },
    Table {
        name: "filters",
        summary: "pixel reconstruction filters",
        rows: rows!(bilux_transport::filters::FILTERS),
    },
    Table {
        name: "aovs",
        summary: "arbitrary output variables: what a render can write as well as the picture",
        rows: rows!(bilux_transport::aovs::AOVS),
    },
    Table {
        name: "metrics",
        summary: "measures of how much a picture differs from a reference",
        rows: rows!(bilux_pictures::metrics::METRICS),
    },
    Table {
        name: "sensor",
        summary: "what can be said of a sensor, for a picture of photons",
        rows: || vec![bilux_pictures::sensor::SENSOR],
    },
    Table {
        name: "lidar",
        summary: "what can be said of a laser scanner",
        rows: || vec![bilux_transport::lidar::LIDAR],
    },
    Table {
        name: "settings",
        summary: "the keys of [render] in scene files and of --set",
        rows: || vec![crate::settings::RENDER],
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

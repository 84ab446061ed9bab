//! pbrt-v4 scenes, including those names of version 3 that are unambiguous. See `docs/formats/pbrt.md`.

mod cameras;
mod colours;
mod directives;
mod environment;
mod finish;
mod grid_media;
mod gzip;
mod lexer;
mod lights;
mod materials;
mod media;
mod metals;
mod options;
mod parameters;
mod reader;
mod shapes;
mod spectra;
mod state;
mod texture_or_value;
mod textures;
mod transforms;
mod write;

use crate::FormatError;
use crate::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneError, Span, UpHint};

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "pbrt",
        summary: "scenes of pbrt-v4, with the files that they include",
        source: "pbrt 2023",
        parameters: &[],
    },
    extensions: &["pbrt"],
    capabilities: &[
        "triangles",
        "normals",
        "uv",
        "objects",
        "instances",
        "transforms",
        "motion",
        "materials",
        "media",
        "textures",
        "moved textures",
        "lights",
        "cameras",
        "settings",
    ],
    sniff,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(reader::read)),
    write: Some(write::write),
};

/// True if a line begins the world.
fn sniff(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(65536)]);
    start.lines().any(|line| line.trim() == "WorldBegin")
}

/// The error for an unknown name. Names come from untrusted files, so only a few, shortened ones are compared.
fn unknown<'n>(
    what: impl Into<String>,
    name: &str,
    known: impl IntoIterator<Item = &'n str>,
    at: &Span,
) -> FormatError {
    const MAX: usize = 100;
    let mut known: Vec<&str> = known.into_iter().filter(|known| known.len() <= MAX).collect();
    known.sort_unstable();
    known.truncate(MAX);
    SceneError::unknown(what, &shortened(name), known, at).into()
}

/// The beginning of a name.
fn shortened(name: &str) -> String {
    name.chars().take(60).collect()
}

//! pbrt-v4 scenes, including those names of version 3 that are unambiguous. See `docs/formats/pbrt.md`.

mod cameras;
mod directive;
mod directives;
mod document;
mod entity;
mod environment;
mod finish;
mod grid_media;
mod lens_system;
mod lexer;
mod light_maker;
mod lights;
mod loader;
mod materials;
mod media;
mod motion;
mod options;
mod parameters;
mod parser;
mod placing;
mod reader;
mod scopes;
mod shapes;
mod spectra;
mod state;
mod surfaces;
mod textures;
mod transforms;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
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
    write: Some(WriteFormat { frame: Frame::METRES, write: write::write }),
};

/// True if a line begins the world.
fn sniff(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(65536)]);
    start.lines().any(|line| line.trim() == "WorldBegin")
}

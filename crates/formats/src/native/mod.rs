//! The native scene file, in TOML. See `docs/formats/scene-toml.md`.
//!
//! The reader first parses a file and its includes. It then collects settings, materials and models from each part
//! in turn, so their order in the files does not matter. Finally it replaces materials, and makes changes.

mod definitions;
mod displaced;
mod document;
mod include;
mod merge;
mod model;
mod overlay;
mod pictures;
mod place;
mod plain;
mod reader;
mod replace;
mod scene;
mod schema;
mod shapes;
mod specs;
mod words;
mod write;

pub use overlay::overlay;
pub use schema::toml_schema;
pub use shapes::{SHAPES, ShapeEntry};

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "toml",
        summary: "the native scene file: models, materials, lights, cameras, motion and settings",
        source: "",
        parameters: &[],
    },
    extensions: &["toml"],
    capabilities: &[
        "points and lines",
        "models",
        "instances",
        "transforms",
        "motion",
        "materials",
        "media",
        "textures",
        "procedural textures",
        "lights",
        "cameras",
        "settings",
    ],
    sniff,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(scene::read)),
    write: Some(WriteFormat { frame: Frame::METRES, write: write::write }),
};

/// True if a line opens one of the tables that only scenes have.
fn sniff(bytes: &[u8]) -> bool {
    let tables = [
        "[[model]]",
        "[[material]]",
        "[[light]]",
        "[camera]",
        "[[camera]]",
        "[render]",
        "[[replace]]",
        "[[change]]",
    ];
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(65536)]);
    start.lines().any(|line| tables.contains(&line.trim()))
}

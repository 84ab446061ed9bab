//! Scenes of Mitsuba 3, and of its versions from 0.5 on. See `docs/formats/mitsuba.md`.

mod bsdfs;
mod document;
mod emitters;
mod film;
mod grid_volume;
mod maker;
mod media;
mod parser;
mod placing;
mod plugin;
mod reader;
mod sensors;
mod shapes;
mod textures;
mod transforms;
mod upgrade;
mod values;
mod variables;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "mitsuba",
        summary: "scenes of Mitsuba 3 and older versions, with the files that they include",
        source: "Jakob 2022",
        parameters: &[],
    },
    extensions: &["xml"],
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

/// True if its outermost element is a scene with a version.
fn sniff(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(65536)]);
    let Some(tag) = start.split_once("<scene").and_then(|(_, rest)| rest.split_once('>')) else {
        return false;
    };
    start.trim_start().starts_with('<') && tag.0.contains("version")
}

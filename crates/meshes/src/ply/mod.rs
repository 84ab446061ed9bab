//! PLY, as text and as binary of both byte orders. See `docs/formats/ply.md`.

mod body;
mod direct;
mod faces;
mod header;
mod read;
mod reader;
mod slots;
mod splats;
mod strokes;
mod textures;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "ply",
        summary: "PLY, the Stanford triangle format, text or binary",
        source: "",
        parameters: &[],
    },
    extensions: &["ply"],
    capabilities: &["points and lines", "polygons", "normals", "uv", "vertex-kd", "vertex-ks"],
    sniff: |bytes| bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") || bytes.starts_with(b"ply "),
    up: UpHint::Usually(Axis::Y),
    read: Some(ReadFormat::Whole(read::read)),
    write: Some(WriteFormat { frame: Frame::Stated(&Axis::ALL), write: write::write }),
};

//! OFF, the object file format of Geomview, in its text form. See `docs/formats/off.md`.

mod columns;
mod read;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};
use columns::Columns;

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "off",
        summary: "OFF, text: the format of Geomview and of many shape collections",
        source: "",
        parameters: &[],
    },
    extensions: &["off"],
    capabilities: &["polygons", "normals", "uv", "vertex-kd"],
    sniff: |bytes| {
        Columns::of_word(bytes.split(u8::is_ascii_whitespace).next().unwrap_or_default()).is_some()
    },
    up: UpHint::Usually(Axis::Y),
    read: Some(ReadFormat::Whole(read::read)),
    write: Some(WriteFormat { frame: Frame::Stated(&Axis::ALL), write: write::write }),
};

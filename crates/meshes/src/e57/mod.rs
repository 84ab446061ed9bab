//! E57: scans of laser scanners, with the places they were made from. See `docs/formats/e57.md`.

mod read;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "e57",
        summary: "E57: scans of laser scanners, each with its pose",
        source: "",
        parameters: &[],
    },
    extensions: &["e57"],
    capabilities: &["points", "vertex-kd", "objects"],
    sniff: |bytes| bytes.starts_with(read::SIGNATURE),
    up: UpHint::Is(Axis::Z),
    read: Some(ReadFormat::Binary(read::read)),
    write: None,
};

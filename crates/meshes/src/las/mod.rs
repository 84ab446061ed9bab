//! LAS: point clouds from laser scanners. See `docs/formats/las.md`.

mod compressed;
mod header;
mod read;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "las",
        summary: "LAS 1.0 to 1.4, LAZ and COPC: point clouds from laser scanners",
        source: "",
        parameters: &[],
    },
    extensions: &["las", "laz"],
    capabilities: &["points", "vertex-kd"],
    sniff: |bytes| bytes.starts_with(header::SIGNATURE),
    up: UpHint::Is(Axis::Z),
    read: Some(ReadFormat::Binary(read::read)),
    write: None,
};

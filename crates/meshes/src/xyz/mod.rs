//! Point clouds as lines of numbers. See `docs/formats/xyz.md`.

mod columns;
mod read;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "xyz",
        summary: "XYZ and PTS: point clouds as lines of numbers, with colours, normals or intensities",
        source: "",
        parameters: &[],
    },
    extensions: &["xyz", "pts", "txt", "xyzrgb", "xyzn", "xyzi"],
    capabilities: &["points", "vertex-kd"],
    sniff: columns::looks_like_points,
    up: UpHint::Usually(Axis::Z),
    read: Some(ReadFormat::Whole(read::read)),
    write: None,
};

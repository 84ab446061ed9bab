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

pub(crate) use write::encode;

use crate::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
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
    write: Some(write::write),
};

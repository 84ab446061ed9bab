//! glTF 2.0, as GLB or as JSON with external files. See `docs/formats/gltf.md`.

mod document;
mod geometry;
mod graph;
mod materials;
mod read;
mod validate;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "gltf",
        summary: "Khronos glTF 2.0, with its binary and image files or all in one GLB",
        source: "glTF 2.0",
        parameters: &[],
    },
    extensions: &["gltf", "glb"],
    capabilities: &[
        "points and lines",
        "triangles",
        "normals",
        "uv",
        "vertex-kd",
        "objects",
        "instances",
        "materials",
        "textures",
        "moved textures",
        "cameras",
        "lights",
        "animation",
        "variants",
    ],
    sniff,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(read::read)),
    write: Some(WriteFormat { frame: Frame::METRES, write: write::write }),
};

/// True for the magic bytes, or for a JSON object with an "asset" key near its start.
fn sniff(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let is_object = start.trim_ascii_start().starts_with(b"{");
    bytes.starts_with(document::container::MAGIC)
        || is_object && start.windows(7).any(|word| word == b"\"asset\"")
}

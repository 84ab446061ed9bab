//! FBX of Autodesk, versions 6.1 to 7.7, binary and as text. See `docs/formats/fbx.md`.

mod animation;
mod attributes;
mod caches;
mod cameras;
mod deform;
mod document;
mod geometry;
mod graph;
mod lights;
mod materials;
mod meshes;
mod posed;
mod reader;
mod subdivision;
mod transform;
mod tree;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "fbx",
        summary: "FBX 6.1 to 7.7, binary and as text: what Maya, 3ds Max, MotionBuilder and Blender exchange",
        source: "",
        parameters: &[],
    },
    extensions: &["fbx"],
    capabilities: &[
        "polygons",
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
    ],
    sniff: |bytes| bytes.starts_with(tree::BINARY_MAGIC) || tree::is_text(bytes),
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Binary(reader::read)),
    write: None,
};

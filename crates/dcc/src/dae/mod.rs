//! Collada (.dae) of Khronos, versions 1.4 and 1.5. See `docs/formats/collada.md`.

mod animation;
mod cameras;
mod controllers;
mod data;
mod document;
mod effects;
mod element;
mod geometry;
mod graph;
mod lights;
mod meshes;
mod posed;
mod reader;
mod settings;
mod targets;
mod transforms;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "collada",
        summary: "Collada 1.4 and 1.5: what SketchUp, Blender, Maya, 3ds Max and robot descriptions exchange",
        source: "Barnes 2008",
        parameters: &[],
    },
    extensions: &["dae"],
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
    sniff,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(reader::read)),
    write: None,
};

/// True if its outermost element is that of Collada.
fn sniff(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    start.trim_start().starts_with('<') && start.contains("<COLLADA")
}

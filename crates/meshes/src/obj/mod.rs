//! Wavefront OBJ with MTL. See `docs/formats/obj.md`.

mod block;
mod draft;
mod habits;
mod index;
mod library;
mod maps;
mod mtl;
mod mtl_write;
mod read;
mod statements;
mod strokes;
mod surface;
mod transparency;
mod write;

use bilux_import::bytes::text::Cursor;
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "obj",
        summary: "Wavefront OBJ with its materials (MTL)",
        source: "",
        parameters: &[],
    },
    extensions: &["obj"],
    capabilities: &[
        "points and lines",
        "polygons",
        "normals",
        "uv",
        "vertex-kd",
        "objects",
        "materials",
        "textures",
    ],
    sniff,
    up: UpHint::Usually(Axis::Y),
    read: Some(ReadFormat::Flowing(read::read)),
    write: Some(WriteFormat { frame: Frame::Stated(&Axis::ALL), write: write::write }),
};

/// True if the first statement is one of the usual ones.
fn sniff(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(&bytes[..bytes.len().min(4096)]);
    while !cursor.is_done() {
        match cursor.word() {
            word if word.is_empty() || word.starts_with(b"#") => cursor.end_line(),
            b"v" | b"vn" | b"vt" => return bilux_import::bytes::float::parse_f32(cursor.word()).is_some(),
            b"mtllib" => return true,
            b"o" | b"g" | b"s" | b"usemtl" => cursor.end_line(),
            _ => return false,
        }
    }
    false
}

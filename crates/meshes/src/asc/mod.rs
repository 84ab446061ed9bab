//! The `.asc` format: a keyword line, then three vertices, repeated. See `docs/formats/asc.md`.

mod read;
mod write;

use bilux_import::bytes::text::Cursor;
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "asc",
        summary: "plain lists of triangles: a keyword line, then three lines of position, normal and uv",
        source: "",
        parameters: &[],
    },
    extensions: &["asc"],
    capabilities: &[
        "triangles",
        "normals",
        "uv",
        "vertex-kd",
        "vertex-ks",
        "materials: kd, ks, reflectivity",
    ],
    sniff,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Whole(read::read)),
    write: Some(WriteFormat { frame: Frame::METRES, write: write::write }),
};

/// True if a line that begins with a word precedes three lines of numbers only, at least 8 each.
fn sniff(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(&bytes[..bytes.len().min(4096)]);
    let mut vertices = 0;
    while !cursor.is_done() && vertices < 3 {
        let (mut numbers, mut others) = (0, 0);
        loop {
            match cursor.word() {
                b"" => break,
                word if bilux_import::bytes::float::parse_f32(word).is_some() => numbers += 1,
                _ => others += 1,
            }
        }
        cursor.end_line();
        match (numbers, others) {
            (0, 0) => {}
            (8.., 0) => vertices += 1,
            // In an OFF file the second line looks like this; in `.asc` only vertices hold numbers.
            (1.., 0) => return false,
            _ if vertices > 0 => return false,
            _ => {}
        }
    }
    vertices == 3
}

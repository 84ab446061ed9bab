//! STL, text and binary. See `docs/formats/stl.md`.

mod ascii;
mod binary;
mod write;

use crate::FormatError;
use crate::formats::{ReadFormat, SceneFormatEntry};
use crate::reading::{Reading, Source, default_material};
use crate::text::whole_file;
use bilux_math::registry::Entry;
use bilux_scene::SceneBuilder;

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "stl",
        summary: "STL, text or binary: triangles as 3D printers have them",
        source: "",
        parameters: &[],
    },
    extensions: &["stl"],
    capabilities: &["triangles", "objects (text only)"],
    sniff: |bytes| binary::fits(bytes) || begins_with_solid(bytes),
    read: Some(ReadFormat::Whole(read)),
    write: Some(write::write),
};

/// Many a binary file begins with `solid` too, so that its size, which gives it away, is looked at first.
fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut scene = if binary::fits(source.bytes) || !begins_with_solid(source.bytes) {
        binary::read(reading, source)?
    } else {
        ascii::read(reading, source)?
    };
    if scene.objects.is_empty() {
        return Err(FormatError::malformed("there is no triangle in it", whole_file(source.name)));
    }
    scene.add_material(default_material());
    Ok(scene)
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    bytes[start..].get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

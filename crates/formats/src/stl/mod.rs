//! STL, as text and as binary. See `docs/formats/stl.md`.

mod ascii;
mod binary;
mod write;

use crate::FormatError;
use crate::formats::{ReadFormat, SceneFormatEntry};
use crate::reading::{Reading, Source, default_material};
use crate::text::whole_file;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneBuilder, UpHint};

pub(crate) const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "stl",
        summary: "STL, text or binary: triangles, as for 3D printing",
        source: "",
        parameters: &[],
    },
    extensions: &["stl"],
    capabilities: &["triangles", "objects (text only)"],
    sniff: |bytes| binary::fits(bytes) || begins_with_solid(bytes),
    up: UpHint::Usually(Axis::Z),
    read: Some(ReadFormat::Whole(read)),
    write: Some(write::write),
};

/// Many binary files begin with `solid` too, so the size decides first.
fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut scene = if binary::fits(source.bytes) || !begins_with_solid(source.bytes) {
        binary::read(reading, source)?
    } else {
        ascii::read(reading, source)?
    };
    if scene.objects.is_empty() {
        return Err(FormatError::malformed("it contains no triangles", whole_file(source.name)));
    }
    scene.add_material(default_material());
    scene.unit = unit(source.bytes);
    Ok(scene)
}

/// The length of a unit in metres: millimetres, as 3D printers expect, unless the free-form header states another,
/// as in `UNITS=inch`.
fn unit(bytes: &[u8]) -> f64 {
    let head = bytes[..bytes.len().min(binary::HEADER - 4)].to_ascii_lowercase();
    let head = String::from_utf8_lossy(&head);
    let line = head.lines().next().unwrap_or_default();
    let Some((_, said)) = line.split_once("unit") else { return MILLIMETRE };
    let said = said.trim_start_matches('s').trim_start_matches([' ', '=', ':', '"']);
    let word: String = said.chars().take_while(char::is_ascii_alphabetic).collect();
    match word.as_str() {
        "m" | "meter" | "meters" | "metre" | "metres" => 1.0,
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => 0.01,
        "in" | "inch" | "inches" => 0.0254,
        "ft" | "foot" | "feet" => 0.3048,
        _ => MILLIMETRE,
    }
}

const MILLIMETRE: f64 = 0.001;

fn begins_with_solid(bytes: &[u8]) -> bool {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    bytes[start..].get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

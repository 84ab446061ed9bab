//! STL, as text and as binary. See `docs/formats/stl.md`.

mod ascii;
mod binary;
mod facet_colours;
mod write;

use bilux_import::FormatError;
use bilux_import::bytes::text::{is_comment, plain, plain_size, whole_file};
use bilux_import::input::reading::{Reading, Source, plain_material};
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneBuilder, UpHint};
use std::sync::Arc;

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "stl",
        summary: "STL, text or binary: triangles, as for 3D printing",
        source: "",
        parameters: &[],
    },
    extensions: &["stl"],
    capabilities: &["triangles", "objects (text only)"],
    sniff: |bytes| binary::fits(bytes) || is_text(bytes),
    up: UpHint::Usually(Axis::Z),
    read: Some(ReadFormat::Binary(read)),
    write: Some(WriteFormat { frame: Frame::PRINTED, write: write::write }),
};

fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let (mut scene, unit) = if is_text(source.bytes) {
        reading.budget.take_bytes(plain_size(source.bytes), source.name)?;
        let text = plain(source.bytes);
        let scene = ascii::read(reading, &Source { bytes: &text, ..*source })?;
        (scene, unit(first_statement(&text).unwrap_or_default()))
    } else {
        let scene = binary::read(reading, source)?;
        (scene, unit(&source.bytes[..binary::HEADER - 4]))
    };
    if scene.objects.is_empty() {
        return Err(FormatError::malformed("it contains no triangles", whole_file(source.name)));
    }
    scene.unit = unit;
    let is_coloured = scene.objects.iter().any(|object| !object.mesh.vertex_kd.is_empty());
    // One material is for all: what has no colour is white among what has.
    for object in scene.objects.iter_mut().filter(|object| is_coloured && object.mesh.vertex_kd.is_empty()) {
        let mesh = Arc::make_mut(&mut object.mesh);
        reading.budget.take_bytes(size_of_val(&mesh.positions[..]) as u64, source.name)?;
        mesh.vertex_kd = vec![Rgb::WHITE; mesh.positions.len()];
    }
    scene.add_material(plain_material(is_coloured, false));
    Ok(scene)
}

/// The length of a unit in metres: millimetres, as 3D printers expect, unless the free-form header states another,
/// as in `UNITS=inch`.
fn unit(head: &[u8]) -> f64 {
    let head = String::from_utf8_lossy(head).to_ascii_lowercase();
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

/// The bytes that tell text from binary.
const HEAD: usize = 1 << 16;

/// The first line that is neither empty nor a comment.
fn first_statement(text: &[u8]) -> Option<&[u8]> {
    let mut lines = text.split(|b| matches!(b, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    lines.find(|line| !line.is_empty() && !is_comment(line))
}

/// True for a text: one that begins with `solid`, though not if binary data follow, or with a facet. Many binary files
/// begin with `solid` too, so their size decides first.
fn is_text(bytes: &[u8]) -> bool {
    if binary::fits(bytes) {
        return false;
    }
    let head = plain(&bytes[..bytes.len().min(HEAD)]).to_ascii_lowercase();
    let Some(line) = first_statement(&head) else { return false };
    let has_facet = head.windows(6).any(|word| word == b"facet ");
    line.starts_with(b"facet ") || (line.starts_with(b"solid") && (has_facet || !head.contains(&0)))
}

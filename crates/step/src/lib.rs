//! STEP, what people who design parts exchange: solids with curved faces, in assemblies. See `docs/formats/step.md`.
//!
//! [ISO 10303-21], [ISO 10303-42]

mod curves;
mod part21;
mod pieces;
mod scene;
mod structure;
mod surfaces;
mod tessellated;
mod tessellation;

use bilux_import::FormatError;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry};
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneBuilder, UpHint};

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "step",
        summary: "STEP: parts and assemblies of CAD programs, tessellated",
        source: "ISO 10303-21",
        parameters: &[],
    },
    extensions: scene::EXTENSIONS,
    capabilities: &["curved faces", "triangles", "objects", "instances", "materials"],
    up: UpHint::Usually(Axis::Z),
    sniff: |bytes| bytes.trim_ascii_start().starts_with(b"ISO-10303-21"),
    read: Some(ReadFormat::Whole(read)),
    write: None,
};

fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    scene::scene(reading, source)
}

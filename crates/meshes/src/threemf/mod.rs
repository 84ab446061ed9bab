//! 3MF, the format of 3D printing: a zip file with a model as XML. See `docs/formats/3mf.md`.
//!
//! [3MF Core 1.3], with its extensions for materials, production, beam lattices and slices.

mod attributes;
mod beams;
mod blend;
mod build;
mod colour;
mod groups;
mod lattice;
mod looks;
mod mesh;
mod mesh_data;
mod model;
mod namespaces;
mod objects;
mod package;
mod part;
mod pictures;
mod pieces;
mod quick;
mod resources;
mod slicers;
mod values;
mod write;
mod xml;

use bilux_import::FormatError;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, SceneBuilder, UpHint};
use package::Package;

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "3mf",
        summary: "3MF: models for 3D printing, with parts, colours and textures",
        source: "3MF Core 1.3",
        parameters: &[],
    },
    extensions: &["3mf"],
    capabilities: &["triangles", "uv", "vertex-kd", "objects", "instances", "materials", "textures"],
    sniff: package::is_package,
    up: UpHint::Is(Axis::Z),
    read: Some(ReadFormat::Packed(read)),
    write: Some(WriteFormat { frame: Frame::PRINTED, write: write::write }),
};

fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let package = Package::of(reading, source)?;
    build::scene(reading, source, &package)
}

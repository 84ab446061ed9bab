//! Universal Scene Description, as text, as crate files, and in packages. See `docs/formats/usd.md`.

mod composition;
mod geometry;
mod layers;
mod lights;
mod mtlx;
mod read;
mod scene;
mod shading;
mod skeletons;
mod stage;
mod usda;
mod usdc;
mod write;

use bilux_import::tables::formats::{ReadFormat, SceneFormatEntry, WriteFormat};
use bilux_import::world::frame::Frame;
use bilux_math::registry::Entry;
use bilux_scene::{Axis, UpHint};

/// Features of a scene that both forms can hold.
const CAPABILITIES: &[&str] = &[
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
    "grids",
    "animation",
    "variants",
];

/// Axes and units that layers can state of themselves. [OpenUSD]
const FRAME: Frame = Frame::Stated(&[Axis::Y, Axis::Z]);

/// Row of the table of formats.
pub const ENTRY: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "usd",
        summary: "OpenUSD: scenes of layers, references and variants, as text or as crate files",
        source: "OpenUSD",
        parameters: &[],
    },
    extensions: &["usd", "usda"],
    capabilities: CAPABILITIES,
    // A file of this name may also be a crate file.
    sniff: |bytes| usda::MAGIC.iter().any(|magic| bytes.starts_with(magic)) || bytes.starts_with(usdc::MAGIC),
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Binary(read::read)),
    write: Some(WriteFormat { frame: FRAME, write: write::write }),
};

/// Row of the table of formats.
pub const CRATE: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "usdc",
        summary: "OpenUSD: the same scenes as crate files, which are smaller than text and read only as far as needed",
        source: "OpenUSD",
        parameters: &[],
    },
    extensions: &["usdc"],
    capabilities: CAPABILITIES,
    sniff: |bytes| bytes.starts_with(usdc::MAGIC),
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Binary(read::read)),
    write: None,
};

/// Row of the table of formats.
pub const PACKAGE: SceneFormatEntry = SceneFormatEntry {
    entry: Entry {
        name: "usdz",
        summary: "OpenUSD in one file with its textures, as phones and browsers show it",
        source: "OpenUSD",
        parameters: &[],
    },
    extensions: &["usdz"],
    capabilities: CAPABILITIES,
    sniff: read::package::is_package,
    up: UpHint::Is(Axis::Y),
    read: Some(ReadFormat::Packed(read::package::read)),
    write: Some(WriteFormat { frame: FRAME, write: write::write_package }),
};

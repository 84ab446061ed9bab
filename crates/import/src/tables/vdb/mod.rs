//! OpenVDB and NanoVDB: smoke, clouds and fire as trees of voxels. See `docs/formats/vdb.md`. [Museth 2013; Museth 2021]

mod archive;
mod found;
mod level_sets;
mod maps;
mod nano;
mod nano_tree;
mod packing;
mod tree;

use crate::tables::grids::GridFormatEntry;

pub const OPEN: GridFormatEntry = GridFormatEntry {
    sniff: |bytes| bytes.starts_with(&archive::SIGNATURE),
    list: archive::list,
    read: tree::read,
    surface: Some(tree::surface),
};

pub const NANO: GridFormatEntry = GridFormatEntry {
    sniff: nano::is_nano,
    list: nano::list,
    read: nano::read,
    surface: Some(nano::surface),
};

//! OpenVDB and NanoVDB: smoke, clouds and fire as trees of voxels. See `docs/formats/vdb.md`. [Museth 2013; Museth 2021]

mod archive;
mod maps;
mod nano;
mod nano_tree;
mod packing;
mod tree;

use crate::grids::GridFormat;

pub(crate) const OPEN: GridFormat = GridFormat {
    sniff: |bytes| bytes.starts_with(&archive::SIGNATURE),
    list: archive::list,
    read: tree::read,
};

pub(crate) const NANO: GridFormat = GridFormat { sniff: nano::is_nano, list: nano::list, read: nano::read };

/// Why a level set is no density.
const LEVEL_SET: &str = "is a level set, distances from a surface, and not a density: convert it to a fog volume where it \
                         was made, or export its surface as a mesh";

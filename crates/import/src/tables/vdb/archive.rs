//! Parts of an OpenVDB file that come before its trees: its header, the list of its grids, and their metadata.

use super::level_sets::LEVEL_SET;
use crate::FormatError;
use crate::input::reading::Source;
use crate::tables::grids::{Bytes, Catalogue, Listed};
use bilux_scene::{Axis, UpHint};

/// The first bytes of a file.
pub(super) const SIGNATURE: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];

/// The first version that can be read. Each grid has its own compression since, and nodes have masks.
const FIRST: u32 = 222;
/// The last version that is known.
const LAST: u32 = 224;

/// After the name of a grid, a number makes it unique.
const SEPARATOR: char = '\x1e';

/// The end of the type of grids whose numbers are stored as halves.
const HALVES: &str = "_HalfFloat";

/// The trees that can be read: the number of bytes of a value.
const TREES: &[(&str, usize)] = &[("Tree_float_5_4_3", 4), ("Tree_double_5_4_3", 8)];

/// An entry of the list of grids.
#[derive(Clone, Debug)]
pub(super) struct Descriptor {
    unique: String,
    kind: String,
    /// The grid whose tree it shares, or nothing.
    parent: String,
    /// Place where the grid begins.
    begin: u64,
    end: u64,
}

/// Facts about a grid that are known before its tree is read.
#[derive(Debug)]
pub(super) struct Grid {
    /// Bytes of a value where it is not compressed.
    pub(super) width: usize,
    pub(super) halves: bool,
    /// Places where its own part begins, with metadata and its map, and where that of its tree does.
    pub(super) own: u64,
    pub(super) tree: u64,
}

/// Goes past the header and the file's metadata; then come the grids. Also the up axis, if the metadata tell it.
fn after_header(bytes: &mut Bytes) -> Result<Option<UpHint>, FormatError> {
    bytes.take(SIGNATURE.len())?;
    let version = bytes.u32()?;
    if !(FIRST..=LAST).contains(&version) {
        return Err(bytes.fail(format!(
            "this OpenVDB file has version {version}, but only {FIRST} to {LAST} can be read: write it again with a newer program"
        )));
    }
    // The version of the library.
    bytes.take(8)?;
    if bytes.u8()? == 0 {
        return Err(bytes.fail(
            "the file was written as a stream, without places of its grids: write it to a file instead",
        ));
    }
    // A number that no other file has.
    bytes.take(36)?;
    let mut up = None;
    metadata(bytes, |name, value| {
        let text = format!("{name} {}", String::from_utf8_lossy(value)).to_lowercase();
        if text.contains("blender") || text.contains("mantaflow") {
            up = Some(UpHint::Is(Axis::Z));
        } else if text.contains("houdini") {
            up = Some(UpHint::Is(Axis::Y));
        }
    })?;
    Ok(up)
}

/// Goes past metadata, and shows each to `see`: its name and its value.
pub(super) fn metadata(bytes: &mut Bytes, mut see: impl FnMut(&str, &[u8])) -> Result<(), FormatError> {
    for _ in 0..bytes.u32()? {
        let name = bytes.text()?;
        bytes.text()?;
        let size = bytes.u32()? as usize;
        see(&name, bytes.take(size)?);
    }
    Ok(())
}

fn descriptors(bytes: &mut Bytes) -> Result<Vec<Descriptor>, FormatError> {
    let mut all = Vec::new();
    for _ in 0..bytes.u32()? {
        let (unique, kind, parent) = (bytes.text()?, bytes.text()?, bytes.text()?);
        let [begin, _, end] = [bytes.u64()?, bytes.u64()?, bytes.u64()?];
        if begin < bytes.at() as u64 || end < begin {
            return Err(bytes.fail(format!(
                "the grid '{}' lies at byte {begin} to {end}, which cannot be",
                shown(&unique)
            )));
        }
        bytes.seek(end)?;
        all.push(Descriptor { unique, kind, parent, begin, end });
    }
    Ok(all)
}

/// The name of a grid without what makes it unique.
fn shown(unique: &str) -> &str {
    unique.split(SEPARATOR).next().unwrap_or(unique)
}

pub(super) fn list(source: &Source) -> Result<Catalogue, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    let mut up = after_header(&mut bytes)?;
    let mut grids = Vec::new();
    for (index, descriptor) in descriptors(&mut bytes)?.into_iter().enumerate() {
        let kind = descriptor.kind.trim_end_matches(HALVES);
        let (mut refused, mut is_level_set) = (None, false);
        if TREES.iter().all(|(known, _)| *known != kind) {
            let kind = kind.trim_start_matches("Tree_").split('_').next().unwrap_or_default();
            refused = Some(format!("has the type '{kind}', but a density is one number for each voxel"));
        }
        let mut own = bytes.until(descriptor.end);
        own.seek(descriptor.begin)?;
        own.u32()?;
        metadata(&mut own, |name, value| {
            if name == "class" && value == b"level set" {
                is_level_set = refused.is_none();
                refused = Some(LEVEL_SET.to_owned());
            }
            if name == "creator" && value.to_ascii_lowercase().starts_with(b"houdini") {
                up = Some(UpHint::Is(Axis::Y));
            }
        })?;
        grids.push(Listed { name: shown(&descriptor.unique).to_owned(), index, refused, is_level_set });
    }
    Ok(Catalogue { grids, up })
}

/// Finds a grid, and the one whose tree it has.
pub(super) fn find(source: &Source, index: usize) -> Result<Grid, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    after_header(&mut bytes)?;
    let all = descriptors(&mut bytes)?;
    let own = &all[index];
    let named = |name: &str| all.iter().find(|other| other.unique == name);
    let tree = if own.parent.is_empty() { Some(own) } else { named(&own.parent) };
    let tree = tree.filter(|tree| tree.parent.is_empty()).ok_or_else(|| {
        bytes.fail(format!(
            "the grid '{}' shares the tree of '{}', which is missing",
            shown(&own.unique),
            shown(&own.parent)
        ))
    })?;
    let kind = tree.kind.trim_end_matches(HALVES);
    let width = TREES.iter().find(|(known, _)| *known == kind).map(|(_, width)| *width);
    let width = width.ok_or_else(|| {
        bytes.fail(format!("the tree of the grid '{}' has another type", shown(&own.unique)))
    })?;
    bytes.seek(tree.end)?;
    Ok(Grid { width, halves: tree.kind.ends_with(HALVES), own: own.begin, tree: tree.begin })
}

//! NanoVDB: the same trees, laid out in memory as they are in the file. [Museth 2021]

use super::found::Found;
use super::level_sets::LEVEL_SET;
use super::nano_tree::{GRID, Numbers, Tree, leaf};
use super::packing::{unblosc, unzip};
use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::Source;
use crate::tables::grids::{Bytes, Catalogue, LeafValues, Listed, Placed, ReadLeaf, Volume};
use bilux_math::{DMat3, DMat4, DVec3};
use bilux_scene::Mesh;
use std::borrow::Cow;
use std::sync::Arc;

/// The first bytes of files and of grids in memory, after which a digit tells which.
const SIGNATURE: &[u8] = b"NanoVDB";
/// The only version of the layout that can be read.
const MAJOR: u32 = 32;

/// Compressions of a grid, by their numbers.
const PLAIN: u16 = 0;
const ZIP: u16 = 1;
const BLOSC: u16 = 2;
/// Blosc packs so many bytes at a time.
const LARGEST_RUN: usize = 1 << 30;

/// Bytes of the description of a grid in a file, without its name.
const DESCRIPTION: usize = 176;
/// The places of the name of a grid, its map, its class and the type of its values.
const NAME: usize = 40;
const NAME_BYTES: usize = 256;
const MAP: usize = 296 + 22 * size_of::<f32>();
const CLASS: usize = 632;
/// A class.
const IS_LEVEL_SET: u32 = 1;

pub(super) fn is_nano(bytes: &[u8]) -> bool {
    bytes.starts_with(SIGNATURE) && matches!(bytes.get(SIGNATURE.len()), Some(b'0'..=b'2'))
}

/// A grid in a file.
#[derive(Debug)]
struct Entry {
    name: String,
    class: u32,
    kind: u32,
    codec: u16,
    /// Place of the grid in the file.
    begin: usize,
    packed: usize,
    size: u64,
}

fn entries(source: &Source) -> Result<Vec<Entry>, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    let mut all = Vec::new();
    // Grids without a file around them have a digit of their own.
    let are_bare = source.bytes.get(SIGNATURE.len()) == Some(&b'1');
    while bytes.left() > 0 {
        if are_bare {
            bare(&mut bytes, &mut all)?;
        } else {
            segment(&mut bytes, &mut all)?;
        }
    }
    Ok(all)
}

fn check(bytes: &Bytes, version: u32) -> Result<(), FormatError> {
    match version >> 21 {
        MAJOR => Ok(()),
        major => Err(bytes.fail(format!(
            "this NanoVDB file has version {major}, but only {MAJOR} can be read: convert it again with a newer program"
        ))),
    }
}

/// Some grids that were written together.
fn segment(bytes: &mut Bytes, all: &mut Vec<Entry>) -> Result<(), FormatError> {
    if !is_nano(bytes.take(8)?) {
        return Err(bytes.fail("another part of a NanoVDB file is expected here: the file is damaged"));
    }
    let version = bytes.u32()?;
    check(bytes, version)?;
    let (count, _) = (bytes.u16()?, bytes.u16()?);
    let first = all.len();
    for _ in 0..count {
        let mut own = *bytes;
        bytes.take(DESCRIPTION)?;
        let (size, packed) = (own.u64()?, own.u64()?);
        own.take(16)?;
        let (kind, class) = (own.u32()?, own.u32()?);
        own.take(48 + 24 + 24)?;
        let name_bytes = own.u32()? as usize;
        own.take(16 + 12)?;
        let codec = own.u16()?;
        let name = bytes.take(name_bytes)?;
        let packed = usize::try_from(packed).unwrap_or(usize::MAX);
        all.push(Entry { name: text(name), class, kind, codec, begin: 0, packed, size });
    }
    for entry in &mut all[first..] {
        entry.begin = bytes.at();
        bytes.take(entry.packed)?;
    }
    Ok(())
}

/// A grid as it is in memory.
fn bare(bytes: &mut Bytes, all: &mut Vec<Entry>) -> Result<(), FormatError> {
    let begin = bytes.at();
    let own = bytes.take(GRID)?;
    let mut head = *bytes;
    let number = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| own[at + i]));
    check(bytes, number(16))?;
    head.seek(begin as u64 + 32)?;
    let size = head.u64()?;
    let whole = usize::try_from(size).unwrap_or(usize::MAX);
    if whole < GRID {
        return Err(
            head.fail(format!("a grid of {size} bytes is shorter than its header: the file is damaged"))
        );
    }
    bytes.take(whole - GRID)?;
    let name = text(&own[NAME..NAME + NAME_BYTES]);
    let (class, kind) = (number(CLASS), number(CLASS + 4));
    all.push(Entry { name, class, kind, codec: PLAIN, begin, packed: whole, size });
    Ok(())
}

/// A text that ends with a zero.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|byte| *byte == 0).next().unwrap_or_default()).into_owned()
}

pub(super) fn list(source: &Source) -> Result<Catalogue, FormatError> {
    let listed = |(index, entry): (usize, Entry)| {
        let refused = if Numbers::of_type(entry.kind).is_none() {
            Some(format!("has values of type {}, but a density is one number for each voxel", entry.kind))
        } else {
            (entry.class == IS_LEVEL_SET).then(|| LEVEL_SET.to_owned())
        };
        let is_level_set = entry.class == IS_LEVEL_SET && Numbers::of_type(entry.kind).is_some();
        Listed { name: entry.name, index, refused, is_level_set }
    };
    Ok(Catalogue { grids: entries(source)?.into_iter().enumerate().map(listed).collect(), up: None })
}

pub(super) fn read(source: &Source, listed: &Listed, budget: &mut Budget) -> Result<Volume, FormatError> {
    with_tree(source, listed, budget, |found, budget, leaf| found.volume(source, budget, leaf))
}

pub(super) fn surface(
    source: &Source,
    listed: &Listed,
    budget: &mut Budget,
) -> Result<Option<Mesh>, FormatError> {
    with_tree(source, listed, budget, |found, budget, leaf| found.surface(source, budget, leaf))
}

/// Reads the tree of a grid, and makes something of it.
fn with_tree<T>(
    source: &Source,
    listed: &Listed,
    budget: &mut Budget,
    make: impl FnOnce(Found, &mut Budget, &mut ReadLeaf) -> Result<T, FormatError>,
) -> Result<T, FormatError> {
    let entry = &entries(source)?[listed.index];
    let unpacked = unpacked(source, entry, budget)?;
    let name: Arc<str> = format!("{}, in the grid '{}'", source.name, entry.name).into();
    let mut bytes = Bytes::new(&unpacked, &name);
    if !is_nano(bytes.take(8)?) {
        return Err(bytes.fail("a grid is expected here: the file is damaged"));
    }
    bytes.seek(CLASS as u64 + 4)?;
    let kind = bytes.u32()?;
    let numbers =
        Numbers::of_type(kind).ok_or_else(|| bytes.fail(format!("values of type {kind} are no density")))?;
    bytes.seek(MAP as u64)?;
    let matrix = DMat3::from_cols_array(&bytes.f64s::<9>()?).transpose();
    // The inverse lies between.
    bytes.f64s::<9>()?;
    let map = DMat4::from_translation(DVec3::from(bytes.f64s::<3>()?)) * DMat4::from_mat3(matrix);
    let placed = Placed { name: &listed.name, map };
    let (sparse, background) = Tree::follow(bytes, numbers, source, budget)?;
    let mut values = |at: usize, values: &mut LeafValues| leaf(bytes, at, numbers, background, values);
    make(Found { sparse, placed, background }, budget, &mut values)
}

/// The bytes of a grid.
fn unpacked<'a>(
    source: &Source<'a>,
    entry: &Entry,
    budget: &mut Budget,
) -> Result<Cow<'a, [u8]>, FormatError> {
    let mut bytes = Bytes::new(source.bytes, source.name);
    bytes.seek(entry.begin as u64)?;
    let mut packed = bytes.until(entry.begin as u64 + entry.packed as u64);
    if entry.codec == PLAIN {
        return Ok(Cow::Borrowed(packed.take(entry.packed)?));
    }
    budget.take_bytes(entry.size, source.name)?;
    // No compression of these gives more than a thousand times its bytes.
    if entry.size > 1100 * entry.packed as u64 {
        return Err(bytes.fail(format!(
            "{} bytes cannot become the {} of a grid: the file is damaged",
            entry.packed, entry.size
        )));
    }
    let mut out = vec![0; entry.size as usize];
    for part in out.chunks_mut(if entry.codec == BLOSC { LARGEST_RUN } else { usize::MAX }) {
        let length = usize::try_from(packed.u64()?).unwrap_or(usize::MAX);
        let run = packed.take(length)?;
        match entry.codec {
            ZIP => unzip(run, part),
            BLOSC => unblosc(run, part),
            other => Err(format!("the compression {other} is not known")),
        }
        .map_err(|message| bytes.fail(message))?;
    }
    Ok(Cow::Owned(out))
}

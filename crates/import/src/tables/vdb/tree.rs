//! The trees of OpenVDB: a root, two levels of nodes with 32³ and 16³ children, and leaves of 8³ voxels. The file has all nodes first,
//! then the values of the leaves in the same order.

use super::archive::{self, find};
use super::found::Found;
use super::maps;
use super::packing::{unblosc, unzip};
use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::Source;
use crate::tables::grids::{Bytes, LeafMask, LeafValues, Listed, Placed, ReadLeaf, Sparse, Volume};
use bilux_scene::Mesh;
use bilux_scene::media::from_binary16;

/// The bits of a grid's compression.
const ZIP: u32 = 1;
const ACTIVE_ONLY: u32 = 2;
const BLOSC: u32 = 4;

/// The levels of inner nodes: the binary logarithms of their children along each side, and the voxels along each side of a child.
const LEVELS: [(usize, i32); 2] = [(5, 128), (4, 8)];
/// The voxels along a side of a child of the root.
const TOP: i32 = 4096;

/// Encoding of the values of a grid.
#[derive(Clone, Copy, Debug)]
struct Encoding {
    /// Bytes of a value, and those of one among others, which may be a half.
    width: usize,
    stored: usize,
    compression: u32,
    background: f32,
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
    let found = find(source, listed.index)?;
    let mut bytes = Bytes::new(source.bytes, source.name);
    let (_, map) = before_tree(&mut bytes, found.own)?;
    let (compression, _) = before_tree(&mut bytes, found.tree)?;
    // The number of buffers, which is 1.
    bytes.u32()?;
    let stored = if found.halves { 2 } else { found.width };
    let mut encoding = Encoding { width: found.width, stored, compression, background: 0.0 };
    encoding.background = encoding.value(&mut bytes)?;
    let (leaves, mut sparse) = nodes(&mut bytes, &encoding, source, budget)?;
    for (origin, mask) in leaves {
        let at = bytes.at();
        bytes.take(mask.len())?;
        Run::read(&mut bytes, mask, &encoding)?;
        let mask = mask.first_chunk().ok_or_else(|| bytes.fail("a mask is missing"))?;
        sparse.leaf(origin, mask, at, source, budget)?;
    }
    let placed = Placed { name: &listed.name, map };
    let mut leaf = |at: usize, values: &mut LeafValues| leaf(bytes, at, &encoding, values);
    make(Found { sparse, placed, background: encoding.background }, budget, &mut leaf)
}

/// Goes to where the tree of a grid begins; what comes before is its compression and its map.
fn before_tree(bytes: &mut Bytes, begin: u64) -> Result<(u32, bilux_math::DMat4), FormatError> {
    bytes.seek(begin)?;
    let compression = bytes.u32()?;
    archive::metadata(bytes, |_, _| ())?;
    Ok((compression, maps::read(bytes)?))
}

/// The leaves of a tree in the order of the file.
type Leaves<'a> = Vec<([i32; 3], &'a [u8])>;

/// Reads the nodes of a tree: the tiles, and where leaves are.
fn nodes<'a>(
    bytes: &mut Bytes<'a>,
    encoding: &Encoding,
    source: &Source,
    budget: &mut Budget,
) -> Result<(Leaves<'a>, Sparse), FormatError> {
    let (tiles, children) = (bytes.u32()?, bytes.u32()?);
    let mut reader = Nodes { encoding, source, budget, leaves: Vec::new(), sparse: Sparse::default() };
    for _ in 0..tiles {
        let origin = bytes.i32s()?;
        let value = encoding.value(bytes)?;
        let is_active = bytes.u8()? != 0;
        reader.tile(origin, i64::from(TOP), value, is_active)?;
    }
    for _ in 0..children {
        let origin = bytes.i32s()?;
        reader.node(bytes, origin, 0)?;
    }
    Ok((reader.leaves, reader.sparse))
}

struct Nodes<'a, 'r> {
    encoding: &'r Encoding,
    source: &'r Source<'r>,
    budget: &'r mut Budget,
    leaves: Leaves<'a>,
    sparse: Sparse,
}

impl<'a> Nodes<'a, '_> {
    /// Reads a node and all below it.
    fn node(&mut self, bytes: &mut Bytes<'a>, origin: [i32; 3], level: usize) -> Result<(), FormatError> {
        let Some(&(bits, side)) = LEVELS.get(level) else {
            self.budget.take::<([i32; 3], &[u8])>(1, self.source.name)?;
            self.leaves.push((origin, bytes.take(size_of::<LeafMask>())?));
            return Ok(());
        };
        let count = 1 << (3 * bits);
        let (children, active) = (bytes.take(count / 8)?, bytes.take(count / 8)?);
        let mut values = vec![0.0; count];
        Run::read(bytes, active, self.encoding)?.values(bytes, active, self.encoding, &mut values)?;
        let below = |i: usize| {
            let part = [i >> (2 * bits), i >> bits, i].map(|part| (part & ((1 << bits) - 1)) as i32);
            [0, 1, 2].map(|axis: usize| origin[axis].wrapping_add(part[axis] * side))
        };
        for (i, value) in values.iter().enumerate().filter(|(i, _)| !is_on(children, *i)) {
            self.tile(below(i), i64::from(side), *value, is_on(active, i))?;
        }
        for i in (0..count).filter(|i| is_on(children, *i)) {
            self.node(bytes, below(i), level + 1)?;
        }
        Ok(())
    }

    fn tile(&mut self, origin: [i32; 3], side: i64, value: f32, is_active: bool) -> Result<(), FormatError> {
        let counts = value > 0.0 && (is_active || value != self.encoding.background);
        if counts { self.sparse.tile(origin, side, value, self.source, self.budget) } else { Ok(()) }
    }
}

fn is_on(mask: &[u8], i: usize) -> bool {
    mask[i / 8] >> (i % 8) & 1 != 0
}

/// Reads the values of a leaf.
fn leaf(
    mut bytes: Bytes,
    at: usize,
    encoding: &Encoding,
    values: &mut LeafValues,
) -> Result<(), FormatError> {
    bytes.seek(at as u64)?;
    let mask = bytes.take(size_of::<LeafMask>())?;
    Run::read(&mut bytes, mask, encoding)?.values(&bytes, mask, encoding, values)
}

/// The values of a node as the file has them.
#[derive(Debug)]
struct Run<'a> {
    /// Values of inactive voxels: of those whose bit in `selection` is off, and of those whose bit is on.
    inactive: [f32; 2],
    selection: &'a [u8],
    /// Number of stored values: all, or the active ones.
    count: usize,
    data: &'a [u8],
    is_packed: bool,
}

impl<'a> Run<'a> {
    /// Reads all but the values, which stay packed, and goes past them.
    fn read(bytes: &mut Bytes<'a>, active: &[u8], encoding: &Encoding) -> Result<Run<'a>, FormatError> {
        // What is inactive is: 0 the background, 1 its negative, 2 one value, 3 to 5 two of these by a mask, 6 stored.
        let kind = bytes.u8()?;
        if kind > 6 {
            return Err(bytes.fail(format!(
                "a node has the kind {kind} of inactive values, but only 0 to 6 exist: the file is damaged"
            )));
        }
        let background = encoding.background;
        let mut inactive = [if kind == 0 { background } else { -background }, background];
        if matches!(kind, 2 | 4 | 5) {
            inactive[0] = encoding.value(bytes)?;
        }
        if kind == 5 {
            inactive[1] = encoding.value(bytes)?;
        }
        let selection = if matches!(kind, 3..=5) { bytes.take(active.len())? } else { &[] };
        let are_all_stored = encoding.compression & ACTIVE_ONLY == 0 || kind == 6;
        let on = || active.iter().map(|bits| bits.count_ones() as usize).sum();
        let count = if are_all_stored { 8 * active.len() } else { on() };
        let (data, is_packed) = encoding.data(bytes, count * encoding.stored)?;
        Ok(Run { inactive, selection, count, data, is_packed })
    }

    fn values(
        &self,
        bytes: &Bytes,
        active: &[u8],
        encoding: &Encoding,
        values: &mut [f32],
    ) -> Result<(), FormatError> {
        let mut unpacked = Vec::new();
        let mut data = self.data;
        if self.is_packed && self.count > 0 {
            unpacked.resize(self.count * encoding.stored, 0);
            let unpack = if encoding.compression & BLOSC != 0 { unblosc } else { unzip };
            unpack(data, &mut unpacked).map_err(|message| bytes.fail(message))?;
            data = &unpacked;
        }
        let mut stored = data.chunks_exact(encoding.stored).map(|bytes| encoding.among(bytes));
        let are_all_stored = self.count == values.len();
        for (i, value) in values.iter_mut().enumerate() {
            let is_active = is_on(active, i);
            let is_chosen = !self.selection.is_empty() && is_on(self.selection, i);
            let one = if is_active || are_all_stored { stored.next() } else { None };
            *value = one.unwrap_or(self.inactive[usize::from(is_chosen)]);
            // What is outside counts as nothing.
            if !is_active && *value == encoding.background {
                *value = 0.0;
            }
        }
        Ok(())
    }
}

impl Encoding {
    /// A single value.
    fn value(&self, bytes: &mut Bytes) -> Result<f32, FormatError> {
        if self.width == 8 { bytes.f64().map(|value| value as f32) } else { bytes.f32() }
    }

    /// One value among others.
    fn among(&self, bytes: &[u8]) -> f32 {
        match *bytes {
            [a, b] => from_binary16(u16::from_le_bytes([a, b])),
            [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
            _ => 0.0,
        }
    }

    /// The bytes of values, and whether they are packed.
    fn data<'a>(&self, bytes: &mut Bytes<'a>, wanted: usize) -> Result<(&'a [u8], bool), FormatError> {
        let is_half = self.stored < self.width;
        if self.compression & (ZIP | BLOSC) == 0 || (is_half && wanted == 0) {
            return Ok((bytes.take(wanted)?, false));
        }
        // Negative where compression would not have made it shorter.
        let size = bytes.i64()?;
        let length = usize::try_from(size.unsigned_abs()).unwrap_or(usize::MAX);
        if size <= 0 && length != wanted {
            return Err(bytes.fail(format!(
                "{wanted} bytes are expected here, but there are {length}: the file is damaged"
            )));
        }
        Ok((bytes.take(length)?, size > 0))
    }
}

//! The trees of NanoVDB: nodes refer to others by distances in bytes.

use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::input::reading::Source;
use crate::tables::grids::{Bytes, LeafMask, LeafValues, Sparse};
use bilux_scene::media::BLOCK_VOXELS;

/// The bytes of a grid before its tree.
pub(super) const GRID: usize = 672;
/// Levels of inner nodes: below the root, and above the leaves.
const UPPER: Level = Level { bits: 5, side: 128 };
const LOWER: Level = Level { bits: 4, side: 8 };
/// The voxels along a side of a child of the root.
const TOP: i32 = 4096;

/// The bytes before the values of a leaf of floats or of fewer bits.
const LEAF: usize = 96;

/// An inner node: the binary logarithm of its children along each side, and the voxels along each side of a child.
#[derive(Clone, Copy, Debug)]
struct Level {
    bits: usize,
    side: i32,
}

/// Form in which values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    Floats,
    Doubles,
    /// As whole numbers of so many bits, between the least and the greatest value of each leaf.
    Bits(usize),
    /// As whole numbers too, whose number of bits differs from leaf to leaf.
    AnyBits,
}

impl Numbers {
    pub(super) fn of_type(kind: u32) -> Option<Numbers> {
        Some(match kind {
            1 => Numbers::Floats,
            2 => Numbers::Doubles,
            13 => Numbers::Bits(4),
            14 => Numbers::Bits(8),
            15 => Numbers::Bits(16),
            16 => Numbers::AnyBits,
            _ => return None,
        })
    }

    /// The bytes of a leaf, or the fewest.
    fn leaf_bytes(self) -> usize {
        match self {
            Numbers::Floats => LEAF + 4 * BLOCK_VOXELS,
            Numbers::Doubles => LEAF + 32 + 8 * BLOCK_VOXELS,
            Numbers::Bits(bits) => LEAF + bits * BLOCK_VOXELS / 8,
            Numbers::AnyBits => LEAF + BLOCK_VOXELS / 8,
        }
    }

    /// The value that eight bytes begin with.
    fn first(self, bytes: &[u8]) -> f32 {
        if self == Numbers::Doubles {
            f64::from_le_bytes(std::array::from_fn(|i| bytes[i])) as f32
        } else {
            f32::from_le_bytes(std::array::from_fn(|i| bytes[i]))
        }
    }

    /// A value of the tree itself.
    fn value(self, bytes: &mut Bytes) -> Result<f32, FormatError> {
        if self == Numbers::Doubles { bytes.f64().map(|value| value as f32) } else { bytes.f32() }
    }
}

/// A tree while it is being followed.
pub(super) struct Tree<'r> {
    numbers: Numbers,
    source: &'r Source<'r>,
    budget: &'r mut Budget,
    sparse: Sparse,
    leaves: usize,
    background: f32,
}

impl<'r> Tree<'r> {
    /// Finds all that is in a tree; also its background.
    pub(super) fn follow(
        bytes: Bytes,
        numbers: Numbers,
        source: &'r Source<'r>,
        budget: &'r mut Budget,
    ) -> Result<(Sparse, f32), FormatError> {
        let mut tree =
            Tree { numbers, source, budget, sparse: Sparse::default(), leaves: 0, background: 0.0 };
        tree.root(bytes)?;
        Ok((tree.sparse, tree.background))
    }

    fn root(&mut self, mut bytes: Bytes) -> Result<(), FormatError> {
        bytes.seek(GRID as u64 + 24)?;
        let distance = bytes.i64()?;
        let root = relative(&bytes, GRID, distance)?;
        bytes.seek(root as u64 + 24)?;
        let count = bytes.u32()?;
        // Numbers of eight bytes begin at multiples of eight.
        bytes.seek(root as u64 + if self.numbers == Numbers::Doubles { 32 } else { 28 })?;
        self.background = self.numbers.value(&mut bytes)?;
        bytes.seek(root as u64 + if self.numbers == Numbers::Doubles { 96 } else { 64 })?;
        for _ in 0..count {
            let mut tile = bytes;
            bytes.take(32)?;
            let (key, child, state) = (tile.u64()?, tile.i64()?, tile.u32()?);
            if self.numbers == Numbers::Doubles {
                tile.take(4)?;
            }
            let value = self.numbers.value(&mut tile)?;
            let part = |shift: u32| ((key >> shift & 0x1f_ffff) as i32).wrapping_mul(TOP);
            let origin = [part(42), part(21), part(0)];
            if child == 0 {
                self.tile(origin, TOP, value, state != 0)?;
            } else {
                let at = relative(&bytes, root, child)?;
                self.node(bytes, at, origin, UPPER)?;
            }
        }
        Ok(())
    }

    /// Follows an inner node.
    fn node(
        &mut self,
        mut bytes: Bytes,
        at: usize,
        origin: [i32; 3],
        level: Level,
    ) -> Result<(), FormatError> {
        let Level { bits, side } = level;
        let count = 1usize << (3 * bits);
        // Its box and its flags, two masks, and the range of values.
        bytes.seek(at as u64 + 32)?;
        let (active, children) = (bytes.take(count / 8)?, bytes.take(count / 8)?);
        bytes.take(32)?;
        for (i, entry) in bytes.take(8 * count)?.chunks_exact(8).enumerate() {
            let is_on = |mask: &[u8]| mask[i / 8] >> (i % 8) & 1 != 0;
            let part = [i >> (2 * bits), i >> bits, i].map(|part| (part & ((1 << bits) - 1)) as i32);
            let below = [0, 1, 2].map(|axis: usize| origin[axis].wrapping_add(part[axis] * side));
            if !is_on(children) {
                self.tile(below, side, self.numbers.first(entry), is_on(active))?;
                continue;
            }
            let child = relative(&bytes, at, i64::from_le_bytes(std::array::from_fn(|k| entry[k])))?;
            if side == LOWER.side {
                self.leaf(bytes, child, below)?
            } else {
                self.node(bytes, child, below, LOWER)?
            }
        }
        Ok(())
    }

    fn leaf(&mut self, mut bytes: Bytes, at: usize, origin: [i32; 3]) -> Result<(), FormatError> {
        self.leaves += 1;
        bytes.seek(0)?;
        if self.leaves > bytes.left() / self.numbers.leaf_bytes() {
            return Err(bytes.fail("the tree has more leaves than there are bytes for: the file is damaged"));
        }
        bytes.seek(at as u64 + 16)?;
        let mask = bytes.take(size_of::<LeafMask>())?;
        let mask = mask.first_chunk().ok_or_else(|| bytes.fail("a mask is missing"))?;
        self.sparse.leaf(origin, mask, at, self.source, self.budget)
    }

    fn tile(&mut self, origin: [i32; 3], side: i32, value: f32, is_active: bool) -> Result<(), FormatError> {
        let counts = value > 0.0 && (is_active || value != self.background);
        let side = i64::from(side);
        if counts { self.sparse.tile(origin, side, value, self.source, self.budget) } else { Ok(()) }
    }
}

/// The place at a distance from another.
fn relative(bytes: &Bytes, from: usize, distance: i64) -> Result<usize, FormatError> {
    let at = i64::try_from(from).ok().and_then(|from| from.checked_add(distance));
    at.and_then(|at| usize::try_from(at).ok()).ok_or_else(|| {
        bytes.fail(format!("it refers to {distance} bytes from byte {from}: the file is damaged"))
    })
}

/// Reads the values of a leaf.
pub(super) fn leaf(
    mut bytes: Bytes,
    at: usize,
    numbers: Numbers,
    background: f32,
    values: &mut LeafValues,
) -> Result<(), FormatError> {
    bytes.seek(at as u64)?;
    let head = bytes.take(16 + size_of::<LeafMask>())?;
    let (flags, mask) = (head[15], &head[16..]);
    match numbers {
        Numbers::Floats | Numbers::Doubles => {
            bytes.take(if numbers == Numbers::Doubles { 48 } else { 16 })?;
            for value in values.iter_mut() {
                *value = numbers.value(&mut bytes)?;
            }
        }
        Numbers::Bits(_) | Numbers::AnyBits => {
            let (least, step) = (bytes.f32()?, bytes.f32()?);
            bytes.take(8)?;
            let bits = if let Numbers::Bits(bits) = numbers { bits } else { 1 << (flags >> 5).min(4) };
            let codes = bytes.take(bits * BLOCK_VOXELS / 8)?;
            for (i, value) in values.iter_mut().enumerate() {
                *value = code(codes, i, bits) as f32 * step + least;
            }
        }
    }
    for (i, value) in values.iter_mut().enumerate() {
        let is_active = mask[i / 8] >> (i % 8) & 1 != 0;
        // What is outside counts as nothing.
        if !is_active && *value == background {
            *value = 0.0;
        }
    }
    Ok(())
}

/// A number of 1, 2, 4, 8 or 16 bits, of which the lowest come first.
fn code(codes: &[u8], i: usize, bits: usize) -> u16 {
    match bits {
        16 => u16::from_le_bytes([codes[2 * i], codes[2 * i + 1]]),
        8 => u16::from(codes[i]),
        _ => {
            let byte = codes[i * bits / 8];
            u16::from(byte >> (i * bits % 8)) & ((1 << bits) - 1)
        }
    }
}

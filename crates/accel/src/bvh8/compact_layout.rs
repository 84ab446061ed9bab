//! The memory layout of a compact tree: the same 32-byte units, and made of them nodes, leaves, and pools of corners.
//!
//! - A *node* is 3 units. It holds the lowest corner of its children, three numbers; a word with the exponents of
//!   three steps, one byte per axis, and a bit for each child that is present; the lower and upper planes of eight
//!   children, axis by axis, one byte each: the number of steps from the lowest corner; and eight references.
//! - A *block* is one unit. It holds, for each corner of four triangles, a byte with the corner's index in a pool;
//!   how many units further on the pool begins; and the primitives of the four triangles. A leaf is one to
//!   `MAX_BLOCKS` blocks.
//! - A *pool* holds up to [`POOL`] corners, each once, for as many of the preceding blocks as it suffices for.
//!
//! A step is a power of two, so that a multiple of it is exact and only the sum is rounded, equally in every kernel,
//! fused or not. A box is the smallest whose *decoded* planes contain the true box. [Ylitie 2017]

use super::layout::{EMPTY, LANES, Planes, Ref, Unit, WIDTH};
use crate::bvh::tree::union;

/// Units of a node.
pub(super) const NODE_UNITS: usize = 3;
/// Units of a block.
pub(super) const BLOCK_UNITS: usize = 1;
/// Corners of the largest pool: as many as a byte can distinguish.
pub(super) const POOL: usize = 256;
/// Bytes from the start of a node to the first planes.
pub(super) const PLANES: usize = 16;
/// Bytes from the start of a node to the references.
pub(super) const REFERENCES: usize = 64;
/// Bytes from the start of a block to the primitives.
pub(super) const PRIMITIVES: usize = 16;
/// Words per corner.
pub(super) const CORNER_WORDS: usize = 3;

/// The positions along an axis that a byte can represent.
#[derive(Clone, Copy)]
struct Steps {
    low: f32,
    /// The exponent as a float stores it; 0 for steps of no length.
    exponent: u8,
}

impl Steps {
    /// The smallest steps that reach from one position to the other.
    fn between(low: f32, high: f32) -> Steps {
        let mut steps = Steps { low, exponent: 0 };
        if high > low {
            let least = (high * 0.5 - low * 0.5) / 127.5;
            steps.exponent = (least.to_bits() >> 23).clamp(1, 254) as u8;
            while steps.exponent < 254 && steps.at(u8::MAX) < high {
                steps.exponent += 1;
            }
        }
        steps
    }

    #[inline(always)]
    fn length(&self) -> f32 {
        f32::from_bits(u32::from(self.exponent) << 23)
    }

    /// The decoding that every kernel performs.
    #[inline(always)]
    fn at(&self, number: u8) -> f32 {
        self.low + f32::from(number) * self.length()
    }

    /// The last position, or nearly, that is not above a plane.
    fn below(&self, plane: f32) -> u8 {
        let mut number = ((plane - self.low) / self.length()) as u8;
        while number > 0 && self.at(number) > plane {
            number -= 1;
        }
        number
    }

    /// The first position, or nearly, that is not below a plane.
    fn above(&self, plane: f32) -> u8 {
        let mut number = ((plane - self.low) / self.length()).ceil() as u8;
        while number < u8::MAX && self.at(number) < plane {
            number += 1;
        }
        number
    }
}

/// Writes a node.
pub(super) fn write_node(units: &mut [Unit], children: &[(Planes, Ref)]) {
    let [low, high] = children.iter().fold(EMPTY, |all, (planes, _)| union(&all, planes));
    let mut bytes = [0u8; (REFERENCES - PLANES) + 4];
    for axis in 0..3 {
        let steps = Steps::between(low[axis], high[axis]);
        put(units, axis, steps.low.to_bits());
        bytes[axis] = steps.exponent;
        for (child, ([low, high], _)) in children.iter().enumerate() {
            bytes[4 + axis * WIDTH + child] = steps.below(low[axis]);
            bytes[4 + (3 + axis) * WIDTH + child] = steps.above(high[axis]);
        }
    }
    bytes[3] = ((1u32 << children.len()) - 1) as u8;
    for (k, word) in bytes.chunks_exact(4).enumerate() {
        put(units, 3 + k, u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    }
    for child in 0..WIDTH {
        let reference = children.get(child).map_or(Ref::EMPTY, |(_, reference)| *reference);
        put(units, REFERENCES / 4 + child, reference.0);
    }
}

/// The box of a child and the reference to it, which is [`Ref::EMPTY`] where there is no child.
#[inline(always)]
pub(super) fn child(node: &[Unit], child: usize) -> (Planes, Ref) {
    let node: &[Unit; NODE_UNITS] = match node.first_chunk() {
        Some(node) => node,
        None => return (EMPTY, Ref::EMPTY),
    };
    let exponents = word(node, 3).to_le_bytes();
    let plane = |side: usize, axis: usize| {
        let steps = Steps { low: f32::from_bits(word(node, axis)), exponent: exponents[axis] };
        let first = PLANES / 4 + (side * 3 + axis) * 2;
        let row = u64::from(word(node, first)) | u64::from(word(node, first + 1)) << 32;
        steps.at((row >> (8 * child)) as u8)
    };
    let planes = [[plane(0, 0), plane(0, 1), plane(0, 2)], [plane(1, 0), plane(1, 1), plane(1, 2)]];
    (planes, Ref(word(node, REFERENCES / 4 + child)))
}

/// The children of a node.
#[cfg(test)]
pub(super) fn children(node: &[Unit]) -> impl Iterator<Item = (Planes, Ref)> + '_ {
    (0..WIDTH).map(|k| child(node, k)).filter(|(_, reference)| *reference != Ref::EMPTY)
}

/// A block whose pool is not yet known: the pool indices of its triangles' corners, and their primitives.
pub(super) fn block(corners: [[u8; 3]; LANES], primitives: [u32; LANES]) -> Unit {
    let corner = |k: usize| u32::from_le_bytes(corners.map(|triangle| triangle[k]));
    let [a, b, c, d] = primitives;
    Unit([corner(0), corner(1), corner(2), 0, a, b, c, d])
}

/// Stores in a block where its pool is.
pub(super) fn link(units: &mut [Unit], block: usize, pool: usize) {
    units[block].0[3] = (pool - block) as u32;
}

/// The corners of a triangle, and its primitive.
#[inline(always)]
pub(super) fn triangle(units: &[Unit], block: usize, lane: usize) -> ([[f32; 3]; 3], u32) {
    let Unit(words) = units[block];
    let pool = &units[block + words[3] as usize..];
    let corner = |k: usize| {
        let first = usize::from((words[k] >> (8 * lane)) as u8) * CORNER_WORDS;
        std::array::from_fn(|axis| f32::from_bits(word(pool, first + axis)))
    };
    ([corner(0), corner(1), corner(2)], words[PRIMITIVES / 4 + lane])
}

pub(super) fn put(units: &mut [Unit], word: usize, bits: u32) {
    units[word / 8].0[word % 8] = bits;
}

#[inline(always)]
fn word(units: &[Unit], word: usize) -> u32 {
    units[word / 8].0[word % 8]
}

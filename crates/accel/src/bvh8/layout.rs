//! The memory layout of the tree: one array of 32-byte units that holds both nodes and leaves.
//!
//! - A *node* is 7 units: the lower and the upper planes of its eight children, axis by axis, then eight references
//!   to them. A slot without a child has an empty box and the reference [`Ref::EMPTY`].
//! - A *leaf* is one to [`MAX_BLOCKS`] blocks of 5 units: for each axis the coordinates of the three corners of four
//!   triangles, then the primitives of the four. Lanes without a triangle repeat the corners of the last one and have
//!   the primitive [`NO_TRIANGLE`]; primitives ascend within a leaf.
//!
//! Nodes come before their children, and subtrees follow one another. A leaf holds each triangle once; in a tree
//! whose builder cuts triangles, a triangle may be in several leaves, each of whose boxes then contains only a piece
//! of it. All give the same hit, since the whole triangle is tested; a caller that collects hits may see the same one
//! more than once.

use std::ops::Range;

/// Children of a node.
pub(super) const WIDTH: usize = 8;
/// Triangles in a block.
pub(super) const LANES: usize = 4;
/// Blocks in the largest leaf.
pub(super) const MAX_BLOCKS: usize = 15;
/// Units in a node.
pub(super) const NODE_UNITS: usize = 7;
/// Units in a block.
pub(super) const BLOCK_UNITS: usize = 5;
/// The primitive of a lane without a triangle. Those of triangles are below 2³¹, so the sign bit distinguishes them.
pub(super) const NO_TRIANGLE: u32 = u32::MAX;
/// Maximum number of units that references can address.
pub(super) const MAX_UNITS: usize = 1 << 28;

/// 32 bytes, never across two cache lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Unit(pub(super) [u32; 8]);

/// A reference to a child: its first unit in the upper 28 bits, and below them the number of blocks of a leaf, or 0
/// for a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(super) struct Ref(pub(super) u32);

impl Ref {
    /// For a slot without a child: a node in the place of the root. Its box is empty, so no ray goes there; the plain
    /// kernel, which handles rays whose arithmetic overflows, checks for it.
    pub(super) const EMPTY: Ref = Ref(u32::MAX);

    pub(super) fn node(unit: usize) -> Ref {
        Ref((unit as u32) << 4)
    }

    pub(super) fn leaf(unit: usize, blocks: usize) -> Ref {
        Ref((unit as u32) << 4 | blocks as u32)
    }

    #[inline(always)]
    pub(super) fn is_node(self) -> bool {
        self.0 & 15 == 0
    }

    #[inline(always)]
    pub(super) fn blocks(self) -> usize {
        (self.0 & 15) as usize
    }

    #[inline(always)]
    pub(super) fn unit(self) -> usize {
        (self.0 >> 4) as usize
    }

    /// Bytes from the start of the first unit.
    #[inline(always)]
    pub(super) fn byte(self) -> usize {
        (self.0 & !15) as usize * 2
    }

    /// The units of a leaf's blocks.
    pub(super) fn leaf_units(self) -> Range<usize> {
        self.unit()..self.unit() + self.blocks() * BLOCK_UNITS
    }
}

/// The lower, then the upper corner of a box.
pub(super) type Planes = [[f32; 3]; 2];

/// The empty box.
pub(super) const EMPTY: Planes = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

/// Writes a node.
pub(super) fn write_node(units: &mut [Unit], children: &[(Planes, Ref)]) {
    for child in 0..WIDTH {
        let (planes, reference) = children.get(child).copied().unwrap_or((EMPTY, Ref::EMPTY));
        for side in 0..2 {
            for axis in 0..3 {
                units[side * 3 + axis].0[child] = planes[side][axis].to_bits();
            }
        }
        units[6].0[child] = reference.0;
    }
}

/// The children of a node, without the empty slots.
pub(super) fn children(units: &[Unit]) -> impl Iterator<Item = (Planes, Ref)> + '_ {
    let planes = move |child: usize| -> Planes {
        std::array::from_fn(|side| {
            std::array::from_fn(|axis| f32::from_bits(units[side * 3 + axis].0[child]))
        })
    };
    (0..WIDTH).map(move |child| (planes(child), Ref(units[6].0[child]))).filter(|(_, r)| *r != Ref::EMPTY)
}

/// Writes the blocks of a leaf for some triangles, each with its primitive.
pub(super) fn write_leaf(units: &mut [Unit], mut triangles: impl Iterator<Item = ([[f32; 3]; 3], u32)>) {
    let mut last = ([[0.0; 3]; 3], NO_TRIANGLE);
    for block in units.chunks_exact_mut(BLOCK_UNITS) {
        for lane in 0..LANES {
            last = triangles.next().unwrap_or((last.0, NO_TRIANGLE));
            write_triangle(block, lane, last.0, last.1);
        }
    }
}

fn write_triangle(block: &mut [Unit], lane: usize, triangle: [[f32; 3]; 3], primitive: u32) {
    let mut put = |row: usize, word: u32| block[row * LANES / 8].0[row * LANES % 8 + lane] = word;
    for (corner, point) in triangle.iter().enumerate() {
        for (axis, x) in point.iter().enumerate() {
            put(axis * 3 + corner, x.to_bits());
        }
    }
    put(9, primitive);
}

/// The triangles of a block, each with its primitive.
#[inline(always)]
pub(super) fn triangles(block: &[Unit]) -> impl Iterator<Item = ([[f32; 3]; 3], u32)> + '_ {
    (0..LANES).map(|lane| triangle(block, lane)).filter(|(_, primitive)| *primitive != NO_TRIANGLE)
}

/// The triangle in one lane of a block.
#[inline(always)]
pub(super) fn triangle(block: &[Unit], lane: usize) -> ([[f32; 3]; 3], u32) {
    let word = |row: usize| block[row * LANES / 8].0[row * LANES % 8 + lane];
    let corner = |corner: usize| std::array::from_fn(|axis| f32::from_bits(word(axis * 3 + corner)));
    ([corner(0), corner(1), corner(2)], word(9))
}

//! Access to nodes and blocks: the difference between the two layouts of a tree.

use crate::bvh8::layout::{self, Planes, Ref, Unit};

#[cfg(target_arch = "x86_64")]
use super::axes::{Axes, Reorder};
#[cfg(target_arch = "x86_64")]
use crate::bvh8::layout::LANES;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// A layout, as kernels read it.
///
/// # Safety
/// Functions that take pointers must be given pointers to whole nodes or blocks of the layout, on machines that have
/// the instructions that each function names.
pub(in crate::bvh8) trait NodeFormat {
    /// Units of a block.
    const BLOCK_UNITS: usize;
    /// Bytes from the start of a node to the references.
    #[cfg(target_arch = "x86_64")]
    const REFERENCES: usize;
    /// Bytes from the start of a block to the primitives.
    #[cfg(target_arch = "x86_64")]
    const PRIMITIVES: usize;
    /// Cache lines of a node, or of the start of a leaf.
    #[cfg(target_arch = "x86_64")]
    const LINES: usize;
    /// Data for decoding all planes of a node, in vectors of eight and of four.
    #[cfg(target_arch = "x86_64")]
    type Frame8: Copy;
    #[cfg(target_arch = "x86_64")]
    type Frame4: Copy;

    /// The box of a child and the reference to it, which is [`Ref::EMPTY`] where there is no child.
    fn child(node: &[Unit], child: usize) -> (Planes, Ref);
    /// The triangle in one lane of the block that begins at a unit.
    fn triangle(units: &[Unit], block: usize, lane: usize) -> ([[f32; 3]; 3], u32);
    // SAFETY: as the trait says.
    /// A bit for each child that is present; extra bits are allowed where empty boxes cannot be hit.
    #[cfg(target_arch = "x86_64")]
    unsafe fn occupied(node: *const u8) -> u32;
    // SAFETY: as the trait says.
    /// Requires AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    unsafe fn frame8(node: *const u8) -> Self::Frame8;
    // SAFETY: as the trait says.
    /// The planes of eight children along an axis; `row` is as in [`super::lane_ray::ROWS`]. Requires AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    unsafe fn planes8(node: *const u8, row: usize, axis: usize, frame: &Self::Frame8) -> __m256;
    // SAFETY: as the trait says.
    /// Requires SSE4.2.
    #[cfg(target_arch = "x86_64")]
    unsafe fn frame4(node: *const u8) -> Self::Frame4;
    // SAFETY: as the trait says.
    /// The planes of four children, starting at the child `from`. Requires SSE4.2.
    #[cfg(target_arch = "x86_64")]
    unsafe fn planes4(node: *const u8, row: usize, from: usize, axis: usize, frame: &Self::Frame4) -> __m128;
    // SAFETY: as the trait says.
    /// The corners of four triangles: `[axis][corner]`, axes in the order of sheared space. Requires the level.
    #[cfg(target_arch = "x86_64")]
    unsafe fn corners<L: Reorder>(block: *const u8, axes: &Axes) -> [[__m128; 3]; 3];
}

/// The reference to a child.
///
/// # Safety
/// `node` must point to a node, and `child` be one of eight.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) unsafe fn reference<F: NodeFormat>(node: *const u8, child: usize) -> Ref {
    // SAFETY: a node has eight references.
    unsafe { Ref(*node.add(F::REFERENCES + child * 4).cast::<u32>()) }
}

/// The layout of [`crate::Bvh8`].
pub(in crate::bvh8) struct Wide;

impl NodeFormat for Wide {
    const BLOCK_UNITS: usize = layout::BLOCK_UNITS;
    #[cfg(target_arch = "x86_64")]
    const REFERENCES: usize = 192;
    #[cfg(target_arch = "x86_64")]
    const PRIMITIVES: usize = 9 * LANES * 4;
    #[cfg(target_arch = "x86_64")]
    const LINES: usize = 4;
    #[cfg(target_arch = "x86_64")]
    type Frame8 = ();
    #[cfg(target_arch = "x86_64")]
    type Frame4 = ();

    #[inline(always)]
    fn child(node: &[Unit], child: usize) -> (Planes, Ref) {
        let plane = |row: usize| f32::from_bits(node[row].0[child]);
        let planes = [[plane(0), plane(1), plane(2)], [plane(3), plane(4), plane(5)]];
        (planes, Ref(node[6].0[child]))
    }

    #[inline(always)]
    fn triangle(units: &[Unit], block: usize, lane: usize) -> ([[f32; 3]; 3], u32) {
        layout::triangle(&units[block..block + layout::BLOCK_UNITS], lane)
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn occupied(_: *const u8) -> u32 {
        // No regular ray hits an empty box.
        u32::MAX
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn frame8(_: *const u8) {}

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn planes8(node: *const u8, row: usize, _: usize, (): &()) -> __m256 {
        // SAFETY: a node is aligned to 32 bytes and holds six rows of eight numbers.
        unsafe { _mm256_load_ps(node.add(row).cast()) }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn frame4(_: *const u8) {}

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn planes4(node: *const u8, row: usize, from: usize, _: usize, (): &()) -> __m128 {
        // SAFETY: as above.
        unsafe { _mm_load_ps(node.add(row + from * 4).cast()) }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn corners<L: Reorder>(block: *const u8, axes: &Axes) -> [[__m128; 3]; 3] {
        // SAFETY: a block is aligned to 32 bytes and holds nine rows of four numbers.
        unsafe {
            let rows = |axis: usize| {
                let row = block.add(axes.rows[axis]).cast::<f32>();
                [_mm_load_ps(row), _mm_load_ps(row.add(LANES)), _mm_load_ps(row.add(2 * LANES))]
            };
            [rows(0), rows(1), rows(2)]
        }
    }
}

//! The axes of sheared space, of which the third is the one along which a ray is steepest.

use crate::bvh8::layout::LANES;
use std::arch::x86_64::__m128;

/// A level that brings coordinates into the order of sheared space.
///
/// # Safety
/// The function must be called only on machines that have the level.
pub(in crate::bvh8) trait Reorder {
    // SAFETY: as the trait says.
    /// Permutes coordinates of world space into the order of sheared space.
    unsafe fn reorder(numbers: __m128, axes: &Axes) -> __m128;
}

/// [`Reorder`] for the levels with a permutation of four numbers.
macro_rules! reorder_by_lanes {
    () => {
        // SAFETY: as the trait demands.
        #[inline(always)]
        unsafe fn reorder(numbers: __m128, axes: &super::axes::Axes) -> __m128 {
            // SAFETY: as the trait demands.
            unsafe { _mm_permutevar_ps(numbers, _mm_load_si128(axes.order.as_ptr().cast())) }
        }
    };
}
pub(super) use reorder_by_lanes;

/// Bytes of a row of three corners along one axis.
const ROW_BYTES: usize = 3 * LANES * 4;

/// Which axes of space are x, y and z of sheared space, and the byte offsets of their rows from the start of a block.
#[repr(C, align(16))]
pub(in crate::bvh8) struct Axes {
    pub(super) order: [u32; 4],
    /// Byte shuffle for the order.
    pub(super) bytes: [u8; 16],
    pub(super) rows: [usize; 3],
}

/// Indexed by which components are the maximum, one bit each: the last of them becomes z.
pub(super) static AXES: [Axes; 8] = [axes(2), axes(0), axes(1), axes(1), axes(2), axes(2), axes(2), axes(2)];

const fn axes(z: usize) -> Axes {
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let order = [x as u32, y as u32, z as u32, z as u32];
    let mut bytes = [0; 16];
    let mut byte = 0;
    while byte < 16 {
        bytes[byte] = (order[byte / 4] * 4) as u8 + (byte % 4) as u8;
        byte += 1;
    }
    Axes { order, bytes, rows: [x * ROW_BYTES, y * ROW_BYTES, z * ROW_BYTES] }
}

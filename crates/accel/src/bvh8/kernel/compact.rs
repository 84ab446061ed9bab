//! Reads the compact layout: bytes become planes, and corners are gathered from the pool.

use super::node_format::NodeFormat;
use crate::bvh8::compact_layout as layout;
use crate::bvh8::layout::{Planes, Ref, Unit};

#[cfg(target_arch = "x86_64")]
use super::axes::{Axes, Reorder};
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// The layout of [`crate::bvh8::CompactBvh8`].
pub(in crate::bvh8) struct Compact;

/// The lowest corner of a node, and its steps, axis by axis, with a lane for each child.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(in crate::bvh8) struct Frame<V> {
    low: [V; 3],
    step: [V; 3],
}

/// The steps of a node, contiguous; the fourth lane has no meaning.
///
/// # Safety
/// The machine must have SSE4.2, and `node` must point to a node.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn steps(node: *const u8) -> __m128 {
    // SAFETY: a node stores its three exponents after three numbers.
    unsafe {
        let exponents = _mm_cvtsi32_si128(node.add(12).cast::<i32>().read());
        _mm_castsi128_ps(_mm_slli_epi32::<23>(_mm_cvtepu8_epi32(exponents)))
    }
}

/// Byte offset of a row of planes from the start of a node; a wide node has four bytes per plane.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn place(row: usize) -> usize {
    layout::PLANES + row / 4
}

impl NodeFormat for Compact {
    const BLOCK_UNITS: usize = layout::BLOCK_UNITS;
    #[cfg(target_arch = "x86_64")]
    const REFERENCES: usize = layout::REFERENCES;
    #[cfg(target_arch = "x86_64")]
    const PRIMITIVES: usize = layout::PRIMITIVES;
    #[cfg(target_arch = "x86_64")]
    const LINES: usize = 2;
    #[cfg(target_arch = "x86_64")]
    type Frame8 = Frame<__m256>;
    #[cfg(target_arch = "x86_64")]
    type Frame4 = Frame<__m128>;

    #[inline(always)]
    fn child(node: &[Unit], child: usize) -> (Planes, Ref) {
        layout::child(node, child)
    }

    #[inline(always)]
    fn triangle(units: &[Unit], block: usize, lane: usize) -> ([[f32; 3]; 3], u32) {
        layout::triangle(units, block, lane)
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn occupied(node: *const u8) -> u32 {
        // SAFETY: the byte after the exponents.
        unsafe { u32::from(*node.add(15)) }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn frame8(node: *const u8) -> Frame<__m256> {
        // SAFETY: a node begins with three numbers.
        unsafe {
            let low = node.cast::<f32>();
            let steps = steps(node);
            let lane =
                |lane: i32| _mm256_permutevar8x32_ps(_mm256_castps128_ps256(steps), _mm256_set1_epi32(lane));
            Frame {
                low: [_mm256_set1_ps(*low), _mm256_set1_ps(*low.add(1)), _mm256_set1_ps(*low.add(2))],
                step: [_mm256_broadcastss_ps(steps), lane(1), lane(2)],
            }
        }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn planes8(node: *const u8, row: usize, axis: usize, frame: &Frame<__m256>) -> __m256 {
        // SAFETY: a node holds six rows of eight bytes.
        unsafe {
            let numbers = _mm256_cvtepu8_epi32(_mm_loadl_epi64(node.add(place(row)).cast()));
            _mm256_fmadd_ps(_mm256_cvtepi32_ps(numbers), frame.step[axis], frame.low[axis])
        }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn frame4(node: *const u8) -> Frame<__m128> {
        // SAFETY: a node begins with three numbers.
        unsafe {
            let low = node.cast::<f32>();
            let steps = steps(node);
            Frame {
                low: [_mm_set1_ps(*low), _mm_set1_ps(*low.add(1)), _mm_set1_ps(*low.add(2))],
                step: [
                    _mm_shuffle_ps::<0>(steps, steps),
                    _mm_shuffle_ps::<0b01_01_01_01>(steps, steps),
                    _mm_shuffle_ps::<0b10_10_10_10>(steps, steps),
                ],
            }
        }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn planes4(
        node: *const u8,
        row: usize,
        from: usize,
        axis: usize,
        frame: &Frame<__m128>,
    ) -> __m128 {
        // SAFETY: a node holds six rows of eight bytes.
        unsafe {
            let bytes = node.add(place(row) + from).cast::<i32>().read();
            let numbers = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(bytes)));
            // The product is exact, so the result is that of a fused operation.
            _mm_add_ps(_mm_mul_ps(numbers, frame.step[axis]), frame.low[axis])
        }
    }

    // SAFETY: as the trait demands.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn corners<L: Reorder>(block: *const u8, axes: &Axes) -> [[__m128; 3]; 3] {
        // SAFETY: a block says how many units further on its pool begins; the pool has all corners that the bytes of
        // the block name, and at least one number after the last.
        unsafe {
            let pool =
                block.add(block.cast::<u32>().add(3).read() as usize * size_of::<Unit>()).cast::<f32>();
            let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (
                four::<L>(pool, block, axes),
                four::<L>(pool, block.add(4), axes),
                four::<L>(pool, block.add(8), axes),
            );
            [[ax, bx, cx], [ay, by, cy], [az, bz, cz]]
        }
    }
}

/// Four corners of a pool, axis by axis, that four bytes index.
///
/// # Safety
/// The machine must have the level, and the pool must have the corners and a number after the last.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn four<L: Reorder>(pool: *const f32, numbers: *const u8, axes: &Axes) -> [__m128; 3] {
    // SAFETY: as the caller promises.
    unsafe {
        let (a, b) = (corner::<L>(pool, *numbers, axes), corner::<L>(pool, *numbers.add(1), axes));
        let (c, d) = (corner::<L>(pool, *numbers.add(2), axes), corner::<L>(pool, *numbers.add(3), axes));
        let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
        let z = _mm_movelh_ps(_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
        [_mm_movelh_ps(ab, cd), _mm_movehl_ps(cd, ab), z]
    }
}

/// A corner, with its axes in the order of sheared space.
///
/// # Safety
/// As for [`four`].
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn corner<L: Reorder>(pool: *const f32, number: u8, axes: &Axes) -> __m128 {
    // SAFETY: as the caller promises.
    unsafe { L::reorder(_mm_loadu_ps(pool.add(usize::from(number) * 3)), axes) }
}

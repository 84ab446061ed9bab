//! The sign stage of the triangle test on sixteen triangles at once: a scalar version, and AVX2 and AVX-512 kernels.
//!
//! No operation is fused: each product and difference is rounded as in [`PreparedRay::cross`], so that every level
//! gives the same mask.
#![allow(unsafe_code)] // Calls and loads of the wide kernels; each call says why it is sound.

use crate::CpuLevel;
use crate::triangle::PreparedRay;

/// Triangles in a block.
pub(super) const LANES: usize = 16;

/// Sixteen triangles: `[corner][axis][lane]`.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Block([[[f32; LANES]; 3]; 3]);

impl Block {
    /// Packs up to sixteen triangles; the remaining lanes are all zero.
    pub(super) fn new(triangles: &[[[f32; 3]; 3]]) -> Block {
        let mut block = Block([[[0.0; LANES]; 3]; 3]);
        for (lane, triangle) in triangles.iter().take(LANES).enumerate() {
            for (corner, p) in triangle.iter().enumerate() {
                for (axis, &x) in p.iter().enumerate() {
                    block.0[corner][axis][lane] = x;
                }
            }
        }
        block
    }
}

/// For each block, sets a bit for each triangle that the signs of its edges do not reject. The level must be one that
/// [`CpuLevel::available`] returned.
#[inline]
pub(super) fn sign_stage(level: CpuLevel, blocks: &[Block], ray: &PreparedRay, masks: &mut [u16]) {
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: `available` found this level on this machine.
        CpuLevel::Avx512 => unsafe { wide::sign_stage_avx512(blocks, ray, masks) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        CpuLevel::Avx2 => unsafe { wide::sign_stage_avx2(blocks, ray, masks) },
        _ => sign_stage_plain(blocks, ray, masks),
    }
}

/// The scalar version that the others are tested against.
fn sign_stage_plain(blocks: &[Block], ray: &PreparedRay, masks: &mut [u16]) {
    for (block, mask) in blocks.iter().zip(masks) {
        let [a, b, c] = [0, 1, 2].map(|corner| shear(&block.0[corner], ray));
        let mut kept = [0u16; LANES];
        for lane in 0..LANES {
            let [ax, bx, cx] = [a[0][lane], b[0][lane], c[0][lane]];
            let [ay, by, cy] = [a[1][lane], b[1][lane], c[1][lane]];
            let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
            let below = (u < 0.0) | (v < 0.0) | (w < 0.0);
            let above = (u > 0.0) | (v > 0.0) | (w > 0.0);
            kept[lane] = u16::from(!(below & above)) << lane;
        }
        *mask = kept.iter().fold(0, |mask, bit| mask | bit);
    }
}

fn shear(corner: &[[f32; LANES]; 3], ray: &PreparedRay) -> [[f32; LANES]; 2] {
    let [kx, ky, kz] = ray.axes;
    let [sx, sy] = ray.shear;
    let o = &ray.ray.origin;
    let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let z = corner[kz][lane] - o[kz];
        x[lane] = (corner[kx][lane] - o[kx]) - sx * z;
        y[lane] = (corner[ky][lane] - o[ky]) - sy * z;
    }
    [x, y]
}

#[cfg(target_arch = "x86_64")]
mod wide {
    use super::{Block, LANES};
    use crate::triangle::PreparedRay;
    use std::arch::x86_64::*;

    #[target_feature(enable = "avx512f")]
    pub(super) fn sign_stage_avx512(blocks: &[Block], ray: &PreparedRay, masks: &mut [u16]) {
        let [kx, ky, kz] = ray.axes;
        let [ox, oy, oz] = ray.axes.map(|k| _mm512_set1_ps(ray.ray.origin[k]));
        let [sx, sy] = ray.shear.map(|s| _mm512_set1_ps(s));
        let zero = _mm512_setzero_ps();
        // SAFETY: a row holds sixteen floats.
        let load = |row: &[f32; LANES]| unsafe { _mm512_loadu_ps(row.as_ptr()) };
        let edge = |px, py, qx, qy| _mm512_sub_ps(_mm512_mul_ps(px, qy), _mm512_mul_ps(py, qx));
        for (block, mask) in blocks.iter().zip(masks) {
            let shear = |corner: &[[f32; LANES]; 3]| {
                let z = _mm512_sub_ps(load(&corner[kz]), oz);
                let x = _mm512_sub_ps(_mm512_sub_ps(load(&corner[kx]), ox), _mm512_mul_ps(sx, z));
                let y = _mm512_sub_ps(_mm512_sub_ps(load(&corner[ky]), oy), _mm512_mul_ps(sy, z));
                (x, y)
            };
            let [(ax, ay), (bx, by), (cx, cy)] = [shear(&block.0[0]), shear(&block.0[1]), shear(&block.0[2])];
            let (u, v, w) = (edge(cx, cy, bx, by), edge(ax, ay, cx, cy), edge(bx, by, ax, ay));
            let below = |x| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(x, zero);
            let above = |x| _mm512_cmp_ps_mask::<_CMP_GT_OQ>(x, zero);
            *mask = !((below(u) | below(v) | below(w)) & (above(u) | above(v) | above(w)));
        }
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn sign_stage_avx2(blocks: &[Block], ray: &PreparedRay, masks: &mut [u16]) {
        let [kx, ky, kz] = ray.axes;
        let [ox, oy, oz] = ray.axes.map(|k| _mm256_set1_ps(ray.ray.origin[k]));
        let [sx, sy] = ray.shear.map(|s| _mm256_set1_ps(s));
        let zero = _mm256_setzero_ps();
        // SAFETY: a row holds sixteen floats, and `half` is 0 or 8.
        let load = |row: &[f32; LANES], half: usize| unsafe { _mm256_loadu_ps(row.as_ptr().add(half)) };
        let edge = |px, py, qx, qy| _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx));
        for (block, mask) in blocks.iter().zip(masks) {
            let rejected = [0, LANES / 2].map(|half| {
                let shear = |corner: &[[f32; LANES]; 3]| {
                    let z = _mm256_sub_ps(load(&corner[kz], half), oz);
                    let x = _mm256_sub_ps(_mm256_sub_ps(load(&corner[kx], half), ox), _mm256_mul_ps(sx, z));
                    let y = _mm256_sub_ps(_mm256_sub_ps(load(&corner[ky], half), oy), _mm256_mul_ps(sy, z));
                    (x, y)
                };
                let [(ax, ay), (bx, by), (cx, cy)] =
                    [shear(&block.0[0]), shear(&block.0[1]), shear(&block.0[2])];
                let (u, v, w) = (edge(cx, cy, bx, by), edge(ax, ay, cx, cy), edge(bx, by, ax, ay));
                let either = |p, q, r| _mm256_or_ps(_mm256_or_ps(p, q), r);
                let below = |x| _mm256_cmp_ps::<_CMP_LT_OQ>(x, zero);
                let above = |x| _mm256_cmp_ps::<_CMP_GT_OQ>(x, zero);
                let mixed =
                    _mm256_and_ps(either(below(u), below(v), below(w)), either(above(u), above(v), above(w)));
                _mm256_movemask_ps(mixed) as u16
            });
            *mask = !(rejected[0] | rejected[1] << 8);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;
    use bilux_math::hash::hash_words;

    /// Arbitrary bits, or small integers, which produce many zeros.
    fn number(seed: u64, i: u64) -> f32 {
        let word = hash_words([seed, i]);
        if seed.is_multiple_of(3) { f32::from_bits(word as u32) } else { (word % 9) as f32 - 4.0 }
    }

    #[test]
    fn every_level_gives_the_scalar_mask_and_keeps_what_the_test_accepts() {
        let mut kept = 0;
        for seed in 0..20_000 {
            let vector = |i: u64| std::array::from_fn(|k| number(seed, i * 3 + k as u64));
            let triangles: Vec<_> =
                (0..LANES as u64).map(|i| std::array::from_fn(|c| vector(3 * i + c as u64))).collect();
            let Some(ray) = PreparedRay::new(&Ray::new(vector(100), vector(101))) else { continue };
            let (block, mut plain) = ([Block::new(&triangles)], [0]);
            sign_stage_plain(&block, &ray, &mut plain);
            for level in CpuLevel::ALL.into_iter().filter(|&level| level <= CpuLevel::detect()) {
                let mut mask = [0];
                sign_stage(level, &block, &ray, &mut mask);
                assert_eq!(mask, plain, "{level:?} {ray:?}");
            }
            for (lane, triangle) in triangles.iter().enumerate() {
                assert!(ray.cross(triangle).is_none() || plain[0] >> lane & 1 == 1);
            }
            kept += plain[0].count_ones();
        }
        assert!(kept > 10_000, "{kept}");
    }
}

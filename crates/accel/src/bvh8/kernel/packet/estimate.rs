//! The first stage of the triangle test for a group of rays, in single precision: signs that are true where they are not
//! zero, and a distance with bounds.

use super::super::wide::Wide;

/// Result of the first stage for a triangle that may be hit.
pub(super) struct Estimate<W> {
    /// No distance is less, and none is greater.
    pub(super) t: [W; 2],
    /// Rays whose hit is beyond doubt, but for its distance.
    pub(super) certain: u32,
    /// Rays to which the edges run clockwise.
    pub(super) below: u32,
}

/// The error of an estimated distance, relative to the largest distance of a corner and to the condition of the
/// determinant: 32 units of rounding, where the proof in docs/adr/0008-bvh8.md needs 20.
const ESTIMATE: f32 = 32.0 / 16_777_216.0;

/// Below this, products may have lost digits to underflow.
const TINY: f32 = 1.0 / (1u128 << 100) as f32;

/// Determinants that are this much smaller than their terms are left to the exact stage.
const WORST_CONDITION: f32 = 1024.0;

/// On which side of an edge the rays pass, and the size of the terms from which that is computed.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
pub(super) unsafe fn edge<W: Wide>(x: [W; 3], y: [W; 3], p: usize, q: usize) -> (W, W) {
    // SAFETY: as the caller promises.
    unsafe {
        let (a, b) = (x[p].mul(y[q]), y[p].mul(x[q]));
        (a.sub(b), a.abs().add(b.abs()))
    }
}

/// Estimates a triangle whose edges, with the sizes of their terms, and distances along the third axis are given, for
/// rays of this slowness. `forwards` gives a number along that axis the sign that it has along the ray, and `inside`
/// says for which rays the signs leave no doubt.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
pub(super) unsafe fn estimate<W: Wide>(
    [u, v, w]: [(W, W); 3],
    z: [W; 3],
    slowness: W,
    inside: u32,
    forwards: impl FnOnce(W) -> W,
) -> Estimate<W> {
    // SAFETY: as the caller promises.
    unsafe {
        let det = u.0.add(v.0).add(w.0);
        let inverse = W::splat(1.0).div(det);
        let along = u.0.fmadd(z[0], v.0.fmadd(z[1], w.0.mul(z[2])));
        let t = forwards(along.mul(inverse)).mul(slowness);
        let size = u.1.add(v.1).add(w.1);
        let reach = z[0].abs().max(z[1].abs()).max(z[2].abs());
        let condition = size.mul(inverse.abs());
        let error = condition.mul(W::splat(ESTIMATE)).mul(reach.mul(slowness));
        let (low, high) = (t.sub(error), t.add(error));
        let (tiny, infinity) = (W::splat(TINY), W::splat(f32::INFINITY));
        let certain = inside
            & condition.lt(W::splat(WORST_CONDITION))
            & tiny.lt(size)
            & tiny.lt(size.mul(reach))
            & tiny.lt(error)
            & W::splat(f32::NEG_INFINITY).lt(low)
            & high.lt(infinity);
        Estimate { t: [low, high], certain, below: det.lt(W::splat(0.0)) }
    }
}

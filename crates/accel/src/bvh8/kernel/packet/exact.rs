//! The exact stage of the triangle test for half a group of rays, in double precision.

use super::super::wide::Half;
use super::orientation::Corners;

/// Result of the exact stage.
pub(super) struct Exact<H: Half> {
    /// Rays that pass the edges on different sides.
    pub(super) mixed: u32,
    /// Rays whose determinant is neither zero nor infinite nor NaN.
    pub(super) sound: u32,
    /// Rays whose determinant is negative.
    pub(super) below: u32,
    pub(super) det: H,
    pub(super) v: H,
    pub(super) w: H,
    pub(super) t: H::Narrow,
}

/// The values for corners in sheared space, given the directions along the third axis.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
pub(super) unsafe fn exact<H: Half>([x, y, z]: Corners<H>, depth: H::Narrow) -> Exact<H> {
    // SAFETY: as the caller promises.
    unsafe {
        let edge = |p: usize, q: usize| x[p].mul(y[q]).sub(y[p].mul(x[q]));
        let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
        let zero = H::splat(0.0);
        let mixed = (u.lt(zero) | v.lt(zero) | w.lt(zero)) & (zero.lt(u) | zero.lt(v) | zero.lt(w));
        let det = u.add(v).add(w);
        let infinity = H::splat(f64::INFINITY);
        let (below, above) = (det.lt(zero), zero.lt(det));
        let sound = (below & zero.sub(infinity).lt(det)) | (above & det.lt(infinity));
        let along = u.mul(z[0]).add(v.mul(z[1])).add(w.mul(z[2]));
        let t = along.div(det.mul(H::widen(depth))).narrow();
        Exact { mixed, sound, below, det, v, w, t }
    }
}

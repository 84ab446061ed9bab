//! A ray as the kernels want it.
//!
//! Where `bvh` takes a plane's distance as `(plane − origin) · inverse`, the wide kernels take it as the fused
//! `plane · inverse − bias`, with `bias = origin · inverse` rounded once a ray. That rounding displaces every plane of
//! an axis by at most `2⁻²⁴ · |origin|`, so twice that is added to the pad; see `docs/adr/0008-bvh8.md`.

use crate::ray::Ray;
use crate::slab::SlabRay;
use crate::triangle::PreparedRay;
use bilux_math::Aabb;

/// A ray prepared for boxes and triangles.
pub(super) struct WideRay {
    pub(super) prepared: PreparedRay,
    pub(super) slabs: SlabRay,
    /// For each axis, `enter_origin · inverse`.
    pub(super) enter_bias: [f32; 3],
    /// For each axis, `leave_origin · inverse`.
    pub(super) leave_bias: [f32; 3],
    /// No hit has an `s` below this; 0 or more for a tame ray.
    pub(super) nearest: f32,
    /// True when no distance is negative, and none that is not finite can come up: what the wide kernels rely on.
    pub(super) is_tame: bool,
}

impl WideRay {
    /// `None` for rays that can hit nothing.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, bounds: &Aabb) -> Option<WideRay> {
        let prepared = PreparedRay::new(ray)?;
        // Written so that a box that holds nothing, or ends that are not numbers, give none.
        if !(ray.t_min <= ray.t_max) {
            return None;
        }
        let [x, y, z] = ray.origin.map(f32::abs);
        let pad = prepared.pad(bounds) + x.max(y).max(z) * BIAS_PAD + f32::MIN_POSITIVE;
        let slabs = SlabRay::new(ray.origin, ray.direction, ray.t_min, pad);
        let enter_bias = std::array::from_fn(|k| slabs.enter_origin[k] * slabs.inverse[k]);
        let leave_bias = std::array::from_fn(|k| slabs.leave_origin[k] * slabs.inverse[k]);
        let spread = (0..3).fold(0.0, |sum, k| sum + (enter_bias[k] * 0.0 + leave_bias[k] * 0.0));
        let is_tame = ray.t_min >= 0.0 && spread == 0.0;
        let nearest = if slabs.nearest > 0.0 || !is_tame { slabs.nearest } else { 0.0 };
        Some(WideRay { prepared, slabs, enter_bias, leave_bias, nearest, is_tame })
    }
}

/// 2 units of f32 rounding.
const BIAS_PAD: f32 = 2.0 / 16_777_216.0;

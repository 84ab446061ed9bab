//! Between the numbers that are given and the double precision in which crossings are computed.

use bilux_math::glam::DVec3;

/// Converts exactly.
pub(super) fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// The bounding box of two corners, rounded outwards.
pub(super) fn outwards(low: DVec3, high: DVec3) -> [[f32; 3]; 2] {
    [low.to_array().map(|x| (x as f32).next_down()), high.to_array().map(|x| (x as f32).next_up())]
}

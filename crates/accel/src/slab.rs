//! A ray as boxes and axis-aligned planes see it: conservative, so that it never misses what the triangle test
//! accepts.
//!
//! Distances are measured along the dominant axis of the direction, `s = t · |d_kz|`, in units of the geometry, so
//! that nothing here depends on the direction's length. The pad of the lemma in [`crate::triangle`] is folded into
//! two origins, one for planes where the ray enters and one for those where it leaves; it therefore costs nothing per
//! box.
//!
//! The error that the arithmetic here adds (rounding of the plane distances, the clamp of the inverse direction) is
//! below 6 · 2⁻²⁴ of the distance to the box; the lemma's pad is twice what its proof requires, which leaves 8. See
//! `docs/adr/0002-one-answer.md`.

use bilux_math::Aabb;

/// A ray prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// For each axis, the coordinate from which the distance to the entry plane is measured.
    pub enter_origin: [f32; 3],
    /// For each axis, the coordinate from which the distance to the exit plane is measured.
    pub leave_origin: [f32; 3],
    /// `|d_kz| / d` for each axis; its magnitude lies between 1 and 2⁴⁰.
    pub inverse: [f32; 3],
    /// For each axis, 1 when the ray enters through the upper plane.
    pub enters_high: [usize; 3],
    /// No hit has an `s` below this.
    pub nearest: f32,
    /// `|d_kz|`.
    pace: f32,
    /// Compensates for underflow, in `t` and in `s`. A normal number, because denormals are slow.
    least: f32,
}

/// Directions closer to a plane than this are tilted: over any distance the tilt is far less than the pad.
pub(crate) const STEEPEST: f32 = (1u64 << 40) as f32;

/// One unit of f32 rounding.
const UNIT: f32 = 1.0 / 16_777_216.0;

/// Covers the roundings of the products below.
pub(crate) const SLACK: f32 = 4.0 * UNIT;

/// See [`SlabRay::limit`].
#[inline(always)]
pub(crate) fn limit_of(t: f32, pace: f32, least: f32) -> f32 {
    let s = t * pace;
    let limit = s + s.abs() * SLACK + least;
    // Only infinities can have produced a NaN: they limit nothing.
    smaller(limit, f32::INFINITY)
}

/// Compensates for underflow in [`limit_of`]: a normal number, because denormals are slow.
#[inline(always)]
pub(crate) fn least_of(pace: f32) -> f32 {
    larger(pace, 1.0) * f32::MIN_POSITIVE
}

impl SlabRay {
    /// Prepares a ray whose origin and direction are finite and whose direction is not zero; `pad` is the distance by
    /// which every box has to grow, see [`crate::triangle::PreparedRay::pad`].
    #[inline]
    pub fn new(origin: [f32; 3], direction: [f32; 3], t_min: f32, pad: f32) -> SlabRay {
        // A NaN pad comes from overflow: then nothing may be skipped.
        let pad = if pad < f32::INFINITY { pad } else { f32::INFINITY };
        let pace = direction[0].abs().max(direction[1].abs()).max(direction[2].abs());
        let inverse = direction.map(|d| (pace / d).clamp(-STEEPEST, STEEPEST));
        // Two more units of rounding, so that the sums are on the safe side.
        let beyond = origin.map(|o| pad + o.abs() * (2.0 * UNIT));
        let upper: [f32; 3] = std::array::from_fn(|k| origin[k] + beyond[k]);
        let lower: [f32; 3] = std::array::from_fn(|k| origin[k] - beyond[k]);
        let down = direction.map(f32::is_sign_negative);
        let pick = |when: bool| std::array::from_fn(|k| if down[k] == when { lower[k] } else { upper[k] });
        let mut ray = SlabRay {
            enter_origin: pick(true),
            leave_origin: pick(false),
            inverse,
            enters_high: down.map(usize::from),
            nearest: 0.0,
            pace,
            least: least_of(pace),
        };
        ray.nearest = -ray.limit(-t_min);
        ray
    }

    /// The smallest `s` that no hit at `t` or before can exceed.
    #[inline]
    pub fn limit(&self, t: f32) -> f32 {
        limit_of(t, self.pace, self.least)
    }

    /// The distances at which the ray enters and leaves a box given as `[min, max]` corners; it misses the box when
    /// the first exceeds the second.
    #[inline(always)]
    pub fn span(&self, planes: &[[f32; 3]; 2]) -> [f32; 2] {
        let enter = |k: usize| (planes[self.enters_high[k] & 1][k] - self.enter_origin[k]) * self.inverse[k];
        let leave =
            |k: usize| (planes[(self.enters_high[k] & 1) ^ 1][k] - self.leave_origin[k]) * self.inverse[k];
        [larger(larger(enter(0), enter(1)), enter(2)), smaller(smaller(leave(0), leave(1)), leave(2))]
    }

    /// [`SlabRay::span`] of a box.
    #[inline]
    pub fn span_of(&self, bounds: &Aabb) -> [f32; 2] {
        self.span(&[bounds.min.to_array(), bounds.max.to_array()])
    }
}

/// The larger of two numbers in one instruction, unlike `f32::max`. With a NaN the result is `b`, so a NaN plane
/// distance either drops out or makes the whole comparison reject nothing.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[f32; 3]; 2] = [[-1.0; 3], [1.0; 3]];

    fn hits(ray: &SlabRay) -> bool {
        let [enter, leave] = ray.span(&CUBE);
        enter <= leave && leave >= ray.nearest
    }

    #[test]
    fn distances_are_in_units_of_the_geometry() {
        let ray = SlabRay::new([-3.0, 0.0, 0.0], [1e-3, 0.0, 0.0], 0.0, 0.0);
        let [enter, leave] = ray.span(&CUBE);
        assert!((enter - 2.0).abs() < 1e-5 && (leave - 4.0).abs() < 1e-5);
        assert!(ray.limit(2000.0) >= 2.0 && ray.limit(2000.0) < 2.000_01);
    }

    #[test]
    fn rays_along_a_face_hit_the_box() {
        for (direction, zero) in
            [([1.0, 0.0, 0.0], 0.0f32), ([1.0, -0.0, 0.0], -0.0), ([1e-42, 0.0, -0.0], 0.0)]
        {
            let ray = SlabRay::new([-3.0, 1.0, zero], direction, 0.0, 1e-6);
            assert!(hits(&ray), "{direction:?}");
            assert!(!hits(&SlabRay::new([-3.0, 1.001, zero], direction, 0.0, 1e-6)));
        }
    }

    #[test]
    fn an_overflowing_pad_hits_every_box() {
        for pad in [f32::INFINITY, f32::NAN, f32::MAX] {
            assert!(hits(&SlabRay::new([3e38, -3e38, 5.0], [1.0, 1.0, 0.0], -f32::INFINITY, pad)));
        }
    }

    #[test]
    fn limits_never_cut_off_their_own_distance() {
        for t in [0.0, 1e-45, 1.0, 3e38, f32::INFINITY, -1.0, -1e-45] {
            for d in [1e-45f32, 1e-20, 1.0, 1e20, 3e38] {
                let limit = SlabRay::new([0.0; 3], [0.0, d, 0.0], 0.0, 0.0).limit(t);
                assert!(f64::from(limit) >= f64::from(t) * f64::from(d), "{t} {d}");
            }
        }
    }
}

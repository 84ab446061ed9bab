//! The cone that most light of a lamp goes into, and the part of a ray in it.

use bilux_math::Vec3;

/// A cone from the middle of a lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Axis of the cone, a unit vector away from the lamp.
    pub axis: Vec3,
    /// The cosine of the angle from the axis to its edge, above 0.
    pub cos: f32,
    /// The fraction of the lamp's light in it, above 0; 1 for all.
    pub share: f32,
}

/// By how much the cosine of a beam is less than that of its light: more than rounding moves the light's edge.
const MARGIN: f32 = 5e-7;

impl Beam {
    /// Beam of a light that goes no further from the axis than an angle of this cosine; `None` where that is more than half of all
    /// directions.
    pub(crate) fn of_edge(axis: Vec3, cos: f32) -> Option<Beam> {
        (cos > MARGIN).then_some(Beam { axis, cos: cos - MARGIN, share: 1.0 })
    }

    /// Between which distances, in metres, a ray along a unit vector is in it, given from where it comes, relative to the lamp; `None` where
    /// it is nowhere. The end may be infinite.
    pub fn along(&self, origin: Vec3, direction: Vec3) -> Option<[f32; 2]> {
        let [axis, origin, direction] = [self.axis, origin, direction].map(Vec3::as_dvec3);
        let (from_lamp, ahead) = (origin.dot(axis), direction.dot(axis));
        let square = f64::from(self.cos) * f64::from(self.cos);
        // Along the axis at least the cosine times the distance: a t² + 2 b t + c is not negative, nor is the way along the axis.
        let a = ahead * ahead - square;
        let b = from_lamp * ahead - square * origin.dot(direction);
        let c = from_lamp * from_lamp - square * origin.length_squared();
        let root = (b * b - a * c).max(0.0).sqrt();
        // Without cancellation.
        let q = -(b + root.copysign(b));
        let [first, second] = if q == 0.0 { [0.0, 0.0] } else { [q / a, c / q] };
        let [low, high] = [first.min(second), first.max(second)];
        let is_ahead = |t: f64| from_lamp + ahead * t >= 0.0;
        let [begin, end] = match (a < 0.0, ahead > 0.0) {
            // A ray that is steeper than the cone crosses one of its halves.
            (true, _) if b * b - a * c > 0.0 && is_ahead(0.5 * (low + high)) => [low, high],
            (true, _) => return None,
            // One that is less steep is in one half from some place on, or up to there.
            (false, true) => [high, f64::INFINITY],
            (false, false) => [f64::NEG_INFINITY, low],
        };
        let ends = [begin.max(0.0) as f32, end as f32];
        (ends[0] < ends[1]).then_some(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};
    use bilux_math::transcendental::cos;

    /// Points of rays from anywhere are in the beam where the angle to its axis says so.
    #[test]
    fn rays_are_in_the_cone_between_their_distances() {
        let number = |i: u64, k: u64| unit_f32(hash_words([i, k]) as u32) * 2.0 - 1.0;
        let point = |i: u64, k: u64| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2));
        let mut found = [0; 2];
        for i in 0..4000 {
            let angle = [0.5f32, 6.0, 40.0, 85.0][i as usize % 4].to_radians();
            let beam = Beam { axis: point(i, 0).normalize(), cos: cos(angle), share: 1.0 };
            let (origin, direction) = (point(i, 3) * 3.0, point(i, 6).normalize());
            // Half of the rays go to the axis.
            let direction = if i % 2 == 0 { direction } else { (beam.axis * 2.0 - origin).normalize() };
            let ends = beam.along(origin, direction);
            found[usize::from(ends.is_some())] += 1;
            for k in 0..60 {
                let t = 0.11 * k as f32;
                let p = origin + direction * t;
                let off = p.normalize().dot(beam.axis) - beam.cos;
                let is_within = ends.is_some_and(|[begin, end]| (begin..=end).contains(&t));
                assert!(off.abs() < 2e-6 || is_within == (off > 0.0), "{i}: {t} of {ends:?}, {off}");
            }
        }
        assert!(found.iter().all(|count| *count > 500), "{found:?}");
    }
}

//! Extent of a finite light: where it is, and in which directions it shines.

use bilux_math::transcendental::{acos, sin_cos};
use bilux_math::{Aabb, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Bounds of where a light is and where it shines, or of several lights: they leave no point out that a light reaches.
/// [Conty Estevez & Kulla 2018]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightExtent {
    /// In world space, in metres, wherever it moves.
    pub bounds: Aabb,
    /// The directions in which its surfaces face.
    pub facing: DirectionCone,
    /// Angle from these directions up to which it shines, in radians, at most π. It fades by the cosine.
    pub spread: f32,
    /// Whether it shines to the opposite side in the same way.
    pub both_sides: bool,
}

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionCone {
    /// A unit vector.
    pub axis: Vec3,
    /// In radians, at most π.
    pub angle: f32,
}

impl LightExtent {
    /// A light that may shine in any direction.
    pub fn all_around(bounds: Aabb) -> LightExtent {
        LightExtent { bounds, facing: DirectionCone::ALL, spread: FRAC_PI_2, both_sides: false }
    }

    /// Both together.
    #[must_use]
    pub fn union(self, other: LightExtent) -> LightExtent {
        LightExtent {
            bounds: self.bounds.union(other.bounds),
            facing: self.facing.union(other.facing),
            spread: self.spread.max(other.spread),
            both_sides: self.both_sides || other.both_sides,
        }
    }

    /// The measure of the directions in which it shines, where each counts as much as it fades. [Conty Estevez & Kulla 2018, sec. 4.1]
    pub(super) fn measure(&self) -> f32 {
        let angle = self.facing.angle;
        if angle >= PI {
            return 4.0 * PI;
        }
        let widest = (angle + self.spread).min(PI);
        let (sin, cos) = sin_cos(angle);
        let fading = 2.0 * widest * sin - sin_cos(angle - 2.0 * widest).1 - 2.0 * angle * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * fading
    }
}

impl DirectionCone {
    /// All directions.
    pub const ALL: DirectionCone = DirectionCone { axis: Vec3::Z, angle: PI };

    /// A single direction, a unit vector.
    pub fn of(axis: Vec3) -> DirectionCone {
        DirectionCone { axis, angle: 0.0 }
    }

    /// A cone around both.
    #[must_use]
    pub fn union(self, other: DirectionCone) -> DirectionCone {
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        if wide.angle >= PI {
            return wide;
        }
        let between = acos(wide.axis.dot(narrow.axis).clamp(-1.0, 1.0));
        if (between + narrow.angle).min(PI) <= wide.angle {
            return wide;
        }
        let angle = 0.5 * (wide.angle + between + narrow.angle);
        let across = narrow.axis - wide.axis * wide.axis.dot(narrow.axis);
        match across.try_normalize() {
            Some(across) if angle < PI => {
                let (sin, cos) = sin_cos(angle - wide.angle);
                DirectionCone { axis: (wide.axis * cos + across * sin).normalize(), angle }
            }
            // The same axis, or the opposite one.
            None if between < FRAC_PI_2 => wide,
            _ => DirectionCone::ALL,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(i: u32) -> Vec3 {
        let (a, b) = (i as f32 * 2.4, (i as f32 + 0.5) / 500.0 * 2.0 - 1.0);
        let ((sin, cos), r) = (sin_cos(a), (1.0 - b * b).sqrt());
        Vec3::new(cos * r, sin * r, b)
    }

    #[test]
    fn a_union_contains_both_cones() {
        let is_in =
            |cone: &DirectionCone, d: Vec3| acos(cone.axis.dot(d).clamp(-1.0, 1.0)) <= cone.angle + 1e-3;
        for (i, j) in (0..500).step_by(23).flat_map(|i| (0..500).step_by(37).map(move |j| (i, j))) {
            for (a, b) in [(0.0, 0.0), (0.3, 0.0), (0.4, 1.2), (2.5, 0.7), (PI, 0.1)] {
                let pair = [(i, a), (j, b)].map(|(k, angle)| DirectionCone { axis: direction(k), angle });
                let both = pair[0].union(pair[1]);
                for d in (0..500).map(direction) {
                    let is_in_one = pair.iter().any(|cone| is_in(cone, d));
                    assert!(!is_in_one || is_in(&both, d), "{pair:?} {both:?} {d}");
                }
            }
        }
    }

    #[test]
    fn measures_are_those_of_closed_forms() {
        // A disc shines into a hemisphere by the cosine, π; a point all around, 4π.
        let flat = LightExtent {
            bounds: Aabb::EMPTY,
            facing: DirectionCone::of(Vec3::X),
            spread: FRAC_PI_2,
            both_sides: false,
        };
        assert!((flat.measure() - PI).abs() < 1e-5, "{}", flat.measure());
        let around = LightExtent::all_around(Aabb::EMPTY).measure();
        assert!((around - 4.0 * PI).abs() < 1e-5, "{around}");
    }
}

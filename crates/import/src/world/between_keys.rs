//! Interpolation of animations between their keys.

use bilux_math::glam::DQuat;
use bilux_math::transcendental::{atan2_f64, sin_f64};

/// The part of an interval at which a tangent's end lies, if it has no weight.
pub const THIRD: f64 = 1.0 / 3.0;

/// A cubic Bézier curve.
pub fn bezier([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let s = 1.0 - t;
    s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c + t * t * t * d
}

/// The parameter at which a part of the interval is reached; the same number if both weights are a third.
pub fn parameter(weights: [f64; 2], part: f64) -> f64 {
    if weights.iter().all(|weight| (weight - THIRD).abs() < 1e-4) {
        return part;
    }
    let points = [0.0, weights[0].clamp(0.0, 1.0), 1.0 - weights[1].clamp(0.0, 1.0), 1.0];
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if bezier(points, middle) < part { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Interpolates along the shorter great arc at constant speed. [Shoemake 1985]
pub fn slerp(a: &[f64], b: &[f64], t: f64) -> Vec<f64> {
    let quaternion = |q: &[f64]| DQuat::from_xyzw(q[0], q[1], q[2], q[3]).normalize();
    let (a, mut b) = (quaternion(a), quaternion(b));
    if a.dot(b) < 0.0 {
        b = -b;
    }
    let half = 2.0 * atan2_f64((b - a).length(), (b + a).length());
    let whole = sin_f64(half);
    let part = |part: f64| if whole > 1e-9 { sin_f64(part * half) / whole } else { part };
    let between = a * part(1.0 - t) + b * part(t);
    between.to_array().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubic_curves_are_hermite_splines_unless_weighted() {
        // From 0 to 1 with slopes 0 and 0: 3 t² - 2 t³.
        let flat = |part: f64, weights| bezier([0.0, 0.0, 1.0, 1.0], parameter(weights, part));
        assert!((flat(0.25, [THIRD; 2]) - 0.156_25).abs() < 1e-12);
        // The parameter at x = 1/2 is 1/2 by symmetry. With weights of 1, x does not rise there at all, and a parameter
        // is as good as the cube root of what numbers distinguish.
        assert!((flat(0.5, [0.9; 2]) - 0.5).abs() < 1e-9);
        assert!((flat(0.5, [1.0; 2]) - 0.5).abs() < 1e-4);
        assert!(flat(0.4, [1.0; 2]) < 0.4);
    }

    #[test]
    fn rotations_take_the_shorter_way() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // A quarter turn about z, written as the negated quaternion.
        let turned = slerp(&[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, -half, -half], 1.0 / 3.0);
        let expected = 15f64.to_radians();
        assert!((2.0 * atan2_f64(turned[2], turned[3]) - 2.0 * expected).abs() < 1e-12, "{turned:?}");
        assert_eq!(slerp(&[0.0, 0.0, 0.0, 2.0], &[0.0, 0.0, 0.0, 1.0], 0.5), [0.0, 0.0, 0.0, 1.0]);
    }
}

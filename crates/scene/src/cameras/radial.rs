//! Lenses that are the same all around their axis: the distance from the middle of the film is a function of the angle.

use super::central::Projection;
use super::pixels::Pixels;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DVec2, DVec3};

/// Such a function, for a film at distance 1; it grows with the angle.
pub(super) trait Lens: Send + Sync + 'static {
    /// The distance from the middle for an angle in radians from the axis, 0..=[`Lens::widest`], and how it grows with it.
    fn radius(&self, angle: f64) -> (f64, f64);
    /// The angle of a distance from the middle, not negative. `None` beyond the widest.
    fn angle(&self, radius: f64) -> Option<f64>;
    /// The angle up to which it sees, at most π.
    fn widest(&self) -> f64;
}

/// A camera with such a lens.
pub(super) struct Radial<L> {
    pub(super) lens: L,
    pub(super) pixels: Pixels,
    pub(super) warnings: Vec<String>,
}

impl<L: Lens> Projection for Radial<L> {
    fn direction(&self, film: DVec2) -> Option<DVec3> {
        let plane = self.pixels.to_plane(film);
        let radius = plane.length();
        if radius == 0.0 {
            return Some(DVec3::Z);
        }
        let (sin, cos) = sin_cos_f64(self.lens.angle(radius)?);
        Some((plane * (sin / radius)).extend(cos))
    }

    fn seen(&self, towards: DVec3) -> Option<(DVec2, f64)> {
        let (aside, length) = (towards.truncate().length(), towards.length());
        let angle = atan2_f64(aside, towards.z);
        if angle.is_nan() || angle > self.lens.widest() {
            return None;
        }
        let (radius, slope) = self.lens.radius(angle);
        // The film has r dr of area where directions have sin θ dθ of solid angle. On the axis both ratios are the slope.
        let (outwards, around) = match aside {
            0.0 if towards.z > 0.0 => (DVec2::ZERO, slope),
            _ => (towards.truncate() * (radius / aside), radius * length / aside),
        };
        Some((self.pixels.to_film(outwards), slope * around * self.pixels.density()))
    }

    fn height_at(&self, p: DVec3) -> f64 {
        p.length() * self.pixels.height() / self.lens.radius(0.0).1
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

/// Starts of a search for the inverse of a function that grows, in a table.
pub(super) struct Starts {
    /// The factors from values to arguments, at squares of values with this distance.
    factors: Vec<f64>,
    per_square: f64,
}

impl Starts {
    /// Starts for a function that is 0 at 0 and grows up to `limit`, for values up to a bit more than `reach`.
    pub(super) fn new(limit: f64, reach: f64, function: impl Fn(f64) -> f64) -> Starts {
        const COUNT: usize = 512;
        let solve = |value: f64| {
            let (mut low, mut high) = (0.0, limit);
            for _ in 0..64 {
                let middle = 0.5 * (low + high);
                *(if function(middle) < value { &mut low } else { &mut high }) = middle;
            }
            low
        };
        let most = (1.2 * reach).min(function(limit));
        let step = most * most / (COUNT - 1) as f64;
        let factor = |i: usize| {
            // At 0 the factor is one over the slope, which it is close to 0 too.
            let value = (step * (i as f64).max(1e-6)).sqrt();
            solve(value) / value
        };
        Starts { factors: (0..COUNT).map(factor).collect(), per_square: 1.0 / step }
    }

    /// Factor from a value to its argument, by the square of the value.
    #[inline]
    pub(super) fn factor(&self, square: f64) -> f64 {
        let at = (square * self.per_square).min((self.factors.len() - 2) as f64);
        let (index, rest) = (at as usize, at.fract());
        let [low, high] = [self.factors[index], self.factors[index + 1]];
        low + (high - low) * rest
    }
}

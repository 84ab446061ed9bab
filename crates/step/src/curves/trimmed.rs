//! Curves that are parts of others, or others one after the other.

use super::curve::{Curve, least};
use bilux_math::DVec3;

/// Part of a curve, from one parameter to another, which may be lower. Its parameter goes from 0 to 1.
pub(super) struct Trimmed {
    pub(super) basis: Box<dyn Curve>,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Trimmed {
    fn inner(&self, t: f64) -> f64 {
        self.from + (self.to - self.from) * t
    }
}

impl Curve for Trimmed {
    fn point(&self, t: f64) -> DVec3 {
        self.basis.point(self.inner(t))
    }

    fn range(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn circle(&self) -> Option<(DVec3, DVec3, f64)> {
        self.basis.circle()
    }

    fn size(&self) -> usize {
        256 + self.basis.size()
    }

    fn period(&self) -> Option<f64> {
        let length = (self.to - self.from).abs();
        self.basis.period().filter(|&period| (length - period).abs() <= 1e-9 * period).map(|_| 1.0)
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let (a, b) = (self.inner(from), self.inner(to));
        let mut all: Vec<f64> = self.basis.breaks(a.min(b), a.max(b));
        all.iter_mut().for_each(|t| *t = (*t - self.from) / (self.to - self.from));
        all.sort_by(f64::total_cmp);
        all
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let pieces = self.breaks(0.0, 1.0).len() + 1;
        least([0.0, 1.0], pieces, |t| self.point(t).distance_squared(p))
    }
}

/// Curves that continue each other; the parameter counts them.
pub(super) struct Composite {
    /// Each with whether it is followed in its own direction.
    pub(super) parts: Vec<(Box<dyn Curve>, bool)>,
}

impl Curve for Composite {
    fn point(&self, t: f64) -> DVec3 {
        let i = (t.max(0.0) as usize).min(self.parts.len() - 1);
        let (part, is_forward) = &self.parts[i];
        let [from, to] = part.range();
        let share = (t - i as f64).clamp(0.0, 1.0);
        part.point(from + (to - from) * if *is_forward { share } else { 1.0 - share })
    }

    fn range(&self) -> [f64; 2] {
        [0.0, self.parts.len() as f64]
    }

    fn size(&self) -> usize {
        256 + self.parts.iter().map(|(part, _)| part.size()).sum::<usize>()
    }

    fn period(&self) -> Option<f64> {
        let [from, to] = self.range();
        let middle = self.point(0.5 * to).distance(self.point(from));
        (self.point(from).distance(self.point(to)) <= 1e-6 * middle).then_some(to)
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let mut all = Vec::new();
        for (i, (part, is_forward)) in self.parts.iter().enumerate() {
            let [a, b] = part.range();
            let share = |t: f64| if *is_forward { (t - a) / (b - a) } else { (b - t) / (b - a) };
            let mut own: Vec<f64> = part.breaks(a, b).into_iter().map(|t| i as f64 + share(t)).collect();
            own.push(i as f64);
            own.sort_by(f64::total_cmp);
            all.extend(own);
        }
        all.retain(|&t| t > from && t < to);
        all
    }

    fn parameter(&self, p: DVec3) -> f64 {
        let [from, to] = self.range();
        least([from, to], self.breaks(from, to).len() + 1, |t| self.point(t).distance_squared(p))
    }
}

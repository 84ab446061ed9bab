//! The basis functions of B-splines, for curves and surfaces of all formats. [Piegl 1997, chapter 2]

use bilux_math::DVec3;
use bilux_math::glam::DVec4;

/// The highest degree that is read; programs write up to 25.
pub const MAX_DEGREE: usize = 31;

/// Knots with multiplicities, and a degree.
#[derive(Clone, Debug)]
pub struct Basis {
    pub degree: usize,
    knots: Vec<f64>,
}

/// The first control point with an influence, and the values of the basis functions and their derivatives there.
pub struct Weights {
    pub first: usize,
    pub values: [f64; MAX_DEGREE + 1],
    pub slopes: [f64; MAX_DEGREE + 1],
}

impl Basis {
    /// From all knots; `None` if they do not make a curve of this degree.
    pub fn new(degree: usize, knots: Vec<f64>) -> Option<Basis> {
        let fits = (1..=MAX_DEGREE).contains(&degree)
            && knots.len() >= 2 * (degree + 1)
            && knots.is_sorted()
            && knots.iter().all(|knot| knot.is_finite());
        fits.then_some(Basis { degree, knots }).filter(|basis| basis.range()[0] < basis.range()[1])
    }

    /// From knots and multiplicities, for a number of control points; `None` if they do not fit each other.
    pub fn of_multiple(degree: usize, count: usize, knots: &[f64], times: &[usize]) -> Option<Basis> {
        let total = times.iter().try_fold(0usize, |sum, &n| sum.checked_add(n))?;
        let fits = degree <= MAX_DEGREE
            && knots.len() == times.len()
            && total == count.checked_add(degree + 1)?
            && knots.windows(2).all(|pair| pair[0] < pair[1]);
        if !fits {
            return None;
        }
        let all = knots.iter().zip(times).flat_map(|(&knot, &n)| std::iter::repeat_n(knot, n)).collect();
        Basis::new(degree, all)
    }

    /// Equal distances between knots, with full multiplicity at the ends if it is clamped.
    pub fn uniform(degree: usize, count: usize, is_clamped: bool) -> Option<Basis> {
        let pieces = count.checked_sub(degree).filter(|&pieces| pieces > 0)?;
        if is_clamped {
            let knots: Vec<f64> = (0..=pieces).map(|i| i as f64).collect();
            let times: Vec<usize> =
                (0..=pieces).map(|i| if i == 0 || i == pieces { degree + 1 } else { 1 }).collect();
            return Basis::of_multiple(degree, count, &knots, &times);
        }
        let knots: Vec<f64> = (0..=count + degree).map(|i| i as f64 - degree as f64).collect();
        Basis::new(degree, knots)
    }

    /// The knots of Bézier pieces that follow each other.
    pub fn bezier(degree: usize, count: usize) -> Option<Basis> {
        let pieces = count.checked_sub(1)?.checked_div(degree)?;
        let knots: Vec<f64> = (0..=pieces).map(|i| i as f64).collect();
        let times: Vec<usize> =
            (0..=pieces).map(|i| if i == 0 || i == pieces { degree + 1 } else { degree }).collect();
        Basis::of_multiple(degree, count, &knots, &times)
    }

    pub fn range(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.knots.len() - 1 - self.degree]]
    }

    /// The number of control points.
    pub fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// The number of pieces between different knots.
    pub fn pieces(&self) -> usize {
        self.inner().count() + 1
    }

    /// The ends of all pieces.
    pub fn ends(&self) -> Vec<f64> {
        let [from, to] = self.range();
        std::iter::once(from).chain(self.inner()).chain([to]).collect()
    }

    /// The different knots within the range.
    pub fn inner(&self) -> impl Iterator<Item = f64> {
        let [from, to] = self.range();
        let pairs = self.knots.windows(2).filter(|pair| pair[0] < pair[1]).map(|pair| pair[1]);
        pairs.filter(move |&knot| knot > from && knot < to)
    }

    /// The functions that are not zero at a parameter, which is taken into the range.
    pub fn at(&self, t: f64) -> Weights {
        let (p, knots) = (self.degree, &self.knots);
        let [from, to] = self.range();
        let t = t.clamp(from, to);
        let last = knots.len() - 2 - p;
        // The piece that contains t: its last knot that is not above.
        let span = (knots[..=last].partition_point(|&knot| knot <= t).max(p + 1) - 1).min(last);
        // At the end of the range the last piece may have no length.
        let span = (p..=span).rev().find(|&i| knots[i] < knots[i + 1]).unwrap_or(span);
        let mut weights =
            Weights { first: span - p, values: [0.0; MAX_DEGREE + 1], slopes: [0.0; MAX_DEGREE + 1] };
        let (mut left, mut right) = ([0.0; MAX_DEGREE + 1], [0.0; MAX_DEGREE + 1]);
        let mut lower = [0.0; MAX_DEGREE + 1];
        weights.values[0] = 1.0;
        for j in 1..=p {
            if j == p {
                lower = weights.values;
            }
            left[j] = t - knots[span + 1 - j];
            right[j] = knots[span + j] - t;
            let mut saved = 0.0;
            for r in 0..j {
                let width = right[r + 1] + left[j - r];
                let share = if width > 0.0 { weights.values[r] / width } else { 0.0 };
                weights.values[r] = saved + right[r + 1] * share;
                saved = left[j - r] * share;
            }
            weights.values[j] = saved;
        }
        for r in 0..=p {
            let term = |value: f64, a: usize, b: usize| {
                let width = knots[b] - knots[a];
                if width > 0.0 { p as f64 * value / width } else { 0.0 }
            };
            let i = span - p + r;
            let before = if r > 0 { term(lower[r - 1], i, i + p) } else { 0.0 };
            let after = if r < p { term(lower[r], i + 1, i + p + 1) } else { 0.0 };
            weights.slopes[r] = before - after;
        }
        weights
    }
}

/// A control point with its weight, as the curve in four dimensions has it.
pub fn weighted(p: DVec3, weight: f64) -> DVec4 {
    (p * weight).extend(weight)
}

/// The point and the derivatives of a rational curve or surface, from those in four dimensions.
pub fn projected(point: DVec4, slope: DVec4) -> (DVec3, DVec3) {
    let p = point.truncate() / point.w;
    (p, (slope.truncate() - p * slope.w) / point.w)
}

//! Pixel filters. Points are sampled in proportion to the filter (filter importance sampling, [Ernst 2006]), so each
//! sample counts fully and only in its own pixel.

use crate::film::error::RenderError;
use bilux_math::Vec2;
use bilux_math::registry::Entry;
use bilux_math::transcendental::{cos_f64, exp_f64};
use bilux_scene::SceneError;
use bilux_scene::parameters::Span;
use std::f64::consts::PI;

/// A row of [`FILTERS`]: a separable filter, the same on both axes and on both sides.
#[derive(Clone, Copy, Debug)]
pub struct FilterEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// Extent from the centre, in pixels.
    pub radius: f64,
    /// Height, at any scale, at a distance from the centre as a fraction of the radius; not negative.
    pub shape: fn(f64) -> f64,
}

/// All filters; the first is the default.
pub static FILTERS: &[FilterEntry] = &[
    FilterEntry { entry: filter("box", "constant over the pixel", ""), radius: 0.5, shape: |_| 1.0 },
    FilterEntry {
        entry: filter("tent", "linear fall-off to the neighbours' centres", ""),
        radius: 1.0,
        shape: |x| 1.0 - x,
    },
    FilterEntry {
        entry: filter("gaussian", "Gaussian with a standard deviation of 0.5 pixels, truncated at 1.5", ""),
        radius: 1.5,
        shape: |x| exp_f64(-4.5 * x * x) - exp_f64(-4.5),
    },
    FilterEntry {
        entry: filter(
            "blackman-harris",
            "a bell-shaped window that ends smoothly at 1.5 pixels",
            "Harris 1978",
        ),
        radius: 1.5,
        shape: |x| {
            let wave = |n: f64| cos_f64(n * PI * (x + 1.0));
            0.35875 - 0.48829 * wave(1.0) + 0.14128 * wave(2.0) - 0.01168 * wave(3.0)
        },
    },
];

const fn filter(name: &'static str, summary: &'static str, source: &'static str) -> Entry {
    Entry { name, summary, source, parameters: &[] }
}

/// A filter, ready for sampling.
#[derive(Clone, Debug)]
pub struct Filter {
    name: &'static str,
    /// `quantiles[i]` is the distance from the centre within which `i / PIECES` of the filter lies.
    quantiles: Vec<f32>,
}

const PIECES: usize = 512;

impl Default for Filter {
    fn default() -> Filter {
        Filter::new(&FILTERS[0])
    }
}

impl Filter {
    /// From a row of the table.
    pub fn new(row: &FilterEntry) -> Filter {
        const STEPS: usize = 16 * PIECES;
        let mut sums = vec![0.0];
        for i in 0..STEPS {
            sums.push(sums[i] + (row.shape)((i as f64 + 0.5) / STEPS as f64).max(0.0));
        }
        let quantile = |i: usize| {
            let wanted = sums[STEPS] * i as f64 / PIECES as f64;
            let after = sums.partition_point(|&sum| sum < wanted).clamp(1, STEPS);
            let (low, high) = (sums[after - 1], sums[after]);
            let rest = if high > low { (wanted - low) / (high - low) } else { 0.0 };
            (row.radius * ((after - 1) as f64 + rest.clamp(0.0, 1.0)) / STEPS as f64) as f32
        };
        Filter { name: row.entry.name, quantiles: (0..=PIECES).map(quantile).collect() }
    }

    /// The filter with this name.
    ///
    /// # Errors
    /// When there is none.
    pub fn from_name(name: &str) -> Result<Filter, RenderError> {
        let names = FILTERS.iter().map(|row| row.entry.name);
        match FILTERS.iter().find(|row| row.entry.name == name) {
            Some(row) => Ok(Filter::new(row)),
            None => Err(SceneError::unknown("filter", name, names, &Span::default()).into()),
        }
    }

    /// Name in [`FILTERS`].
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// A point relative to the pixel's centre, in pixels; exactly the centre for `(½, ½)`.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec2 {
        Vec2::new(self.sample_axis(u.x), self.sample_axis(u.y))
    }

    /// Extent from the centre on each axis, in pixels.
    pub fn radius(&self) -> f32 {
        self.quantiles[PIECES]
    }

    /// Density of [`Filter::sample`] along one axis, at a distance from the centre in pixels.
    pub fn density(&self, x: f32) -> f32 {
        let x = x.abs();
        let after = self.quantiles.partition_point(|&q| q <= x);
        if after == 0 || after > PIECES {
            return 0.0;
        }
        0.5 / (PIECES as f32 * (self.quantiles[after] - self.quantiles[after - 1]))
    }

    fn sample_axis(&self, u: f32) -> f32 {
        let signed = 2.0 * u - 1.0;
        let place = signed.abs() * PIECES as f32;
        let piece = (place as usize).min(PIECES - 1);
        let (near, far) = (self.quantiles[piece], self.quantiles[piece + 1]);
        (near + (far - near) * (place - piece as f32)).copysign(signed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_exact_and_the_edges_are_those_of_the_filter() {
        for row in FILTERS {
            let filter = Filter::new(row);
            assert_eq!(filter.sample(Vec2::splat(0.5)), Vec2::ZERO, "{}", row.entry.name);
            let edge = filter.sample(Vec2::new(0.0, 1.0));
            assert!((f64::from(edge.y) - row.radius).abs() < 1e-6 && edge.x == -edge.y, "{edge}");
        }
    }

    /// Maximum difference between the fraction of sampled points below a position and the filter's own fraction.
    fn distance(filter: &Filter, row: &FilterEntry) -> f64 {
        const N: usize = 20_000;
        let share = |low: f64, high: f64| {
            let at = |i: usize| low + (high - low) * (i as f64 + 0.5) / 2000.0;
            (0..2000).map(|i| (row.shape)((at(i) / row.radius).abs())).sum::<f64>() * (high - low)
        };
        let total = share(-row.radius, row.radius);
        let draw = |i: usize| f64::from(filter.sample(Vec2::new((i as f32 + 0.5) / N as f32, 0.5)).x);
        let difference = |edge: f64| {
            let drawn = (0..N).filter(|&i| draw(i) < edge).count() as f64 / N as f64;
            (drawn - share(-row.radius, edge) / total).abs()
        };
        (1..8).map(|i| difference(row.radius * (f64::from(i) / 4.0 - 1.0))).fold(0.0, f64::max)
    }

    #[test]
    fn points_are_sampled_in_proportion_to_the_filter() {
        for row in FILTERS {
            let off = distance(&Filter::new(row), row);
            assert!(off < 1e-3, "{}: off by {off}", row.entry.name);
        }
        // Negative control: a filter sampled by another's quantiles is detected.
        assert!(distance(&Filter::new(&FILTERS[2]), &FILTERS[3]) > 1e-2);
    }

    #[test]
    fn misspelt_names_suggest_the_nearest() {
        let error = Filter::from_name("gausian").unwrap_err();
        assert!(error.to_string().contains("did you mean 'gaussian'?"), "{error}");
    }
}

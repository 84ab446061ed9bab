//! Choosing among many by given weights.

use super::guide;

/// A cumulative distribution.
pub(super) struct Cumulative {
    /// `sums[i]` is the total probability of `0..=i`; the last is 1.
    sums: Vec<f32>,
    /// A guide to search them; empty if they are few.
    guide: Vec<u32>,
}

/// The numbers from 0 to 1 that pick one.
#[derive(Clone, Copy, Debug)]
pub struct CumulativePart {
    /// The least of them.
    pub begin: f32,
    /// `begin` as the probability implies it, the same but for rounding.
    below: f32,
    probability: f32,
}

impl CumulativePart {
    /// The position of a number within the part, from 0 to 1.
    #[inline(always)]
    pub fn rest(&self, u: f32) -> f32 {
        let rest = ((u - self.below) / self.probability).clamp(0.0, 1.0);
        if self.probability > 0.0 { rest } else { 0.0 }
    }
}

/// Up to this many, compare with all of them: that avoids unpredictable branches.
const FEW: usize = 8;

impl Cumulative {
    /// The distribution with probabilities in proportion to weights, which are at least 0; at least one is above.
    pub(super) fn new(weights: &[f64]) -> Cumulative {
        let (mut sum, all) = (0.0, weights.iter().sum::<f64>());
        let add = |weight: &f64| {
            sum += weight;
            (sum / all) as f32
        };
        let mut sums: Vec<f32> = weights.iter().map(add).collect();
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        let guide = if sums.len() > FEW { guide::guide(&sums).collect() } else { Vec::new() };
        Cumulative { sums, guide }
    }

    /// The probability of one.
    #[inline]
    pub(super) fn probability(&self, index: usize) -> f32 {
        self.sums[index] - if index == 0 { 0.0 } else { self.sums[index - 1] }
    }

    /// The index for a number from 0 to 1, and the position of that number within the index's part, from 0 to 1.
    #[inline]
    pub(super) fn sample(&self, u: f32) -> (usize, f32) {
        let index = self.find(u);
        (index, self.part(index).rest(u))
    }

    /// The part of 0..1 of each, in their order, if they are few.
    pub(super) fn few(&self) -> Option<impl Iterator<Item = CumulativePart>> {
        self.guide.is_empty().then(|| (0..self.sums.len()).map(|index| self.part(index)))
    }

    #[inline]
    fn part(&self, index: usize) -> CumulativePart {
        let begin = if index == 0 { 0.0 } else { self.sums[index - 1] };
        let probability = self.probability(index);
        CumulativePart { begin, below: self.sums[index] - probability, probability }
    }

    /// The number of sums that are at most `u`, but never all of them.
    #[inline]
    fn find(&self, u: f32) -> usize {
        if self.guide.is_empty() {
            let last = self.sums.len() - 1;
            return self.sums.iter().map(|&sum| usize::from(sum <= u)).sum::<usize>().min(last);
        }
        guide::find(&self.sums, &self.guide, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    #[test]
    fn the_guide_finds_what_a_search_finds() {
        for count in [1usize, 3, 8, 9, 100, 1000] {
            // Many have no weight; a few have nearly all of it.
            let number = |i: usize| unit_f32(hash_words([count as u64, i as u64]) as u32);
            let cube = |x: f64| x * x * x;
            let some = |i: usize| cube(cube(f64::from(number(i + 5000))));
            let weight = |i: usize| if number(i) < 0.4 { 0.0 } else { some(i) };
            let mut weights: Vec<f64> = (0..count).map(weight).collect();
            weights[count / 2] += 1.0;
            let cumulative = Cumulative::new(&weights);
            let sums = &cumulative.sums;
            let exact = sums.iter().flat_map(|&sum| [sum.next_down(), sum, sum.next_up()]);
            let even = (0..=5000).map(|i| i as f32 / 5000.0);
            for u in exact.chain(even).filter(|u| (0.0..=1.0).contains(u)) {
                let wanted = sums.partition_point(|&sum| sum <= u).min(count - 1);
                let (found, within) = cumulative.sample(u);
                assert_eq!(found, wanted, "{count}: {u}");
                assert!((0.0..=1.0).contains(&within));
            }
        }
    }
}

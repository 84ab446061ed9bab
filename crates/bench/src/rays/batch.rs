//! Rays for the same kind of query, and what they find.

use bilux::accel::{Hit, Ray};

/// Rays for the same kind of query.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The class of the rays.
    pub class: String,
    /// Whether any hit is enough, instead of the closest.
    pub any: bool,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// Answers to the rays of a batch, ray by ray.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Answers {
    /// Closest hits; empty for an any-hit batch.
    pub(super) closest: Vec<Option<Hit>>,
    /// Whether anything was hit; empty for a closest-hit batch.
    pub(super) any: Vec<bool>,
}

impl Answers {
    pub(super) fn fill(&mut self, any: bool, hits: impl Iterator<Item = Option<Hit>>) {
        *self = Answers::default();
        if any {
            self.any = hits.map(|hit| hit.is_some()).collect();
        } else {
            self.closest = hits.collect();
        }
    }

    /// Counts the rays for which one side reports a hit and the other a miss, or which hit different primitives at
    /// distances that differ by more than a ten-thousandth; if answers must be `equal`, all rays with any difference.
    pub(super) fn mismatches(&self, reference: &Answers, equal: bool) -> usize {
        let differ = |(a, b): &(&Option<Hit>, &Option<Hit>)| match (a, b) {
            (Some(a), Some(b)) if !equal => {
                a.primitive != b.primitive && (a.t - b.t).abs() > 1e-4 * a.t.abs().max(b.t.abs())
            }
            (a, b) => a != b,
        };
        let closest = self.closest.iter().zip(&reference.closest).filter(differ).count();
        closest + self.any.iter().zip(&reference.any).filter(|(a, b)| a != b).count()
    }
}

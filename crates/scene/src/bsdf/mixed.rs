//! Mixtures of sums of lobes.

use super::{Bsdf, MAX_LOBES};

impl Bsdf {
    /// A mixture: `1 - share` of this BSDF plus `share`, 0..=1, of another about the same normal. A coat with its own
    /// normal keeps it. Lobes beyond [`MAX_LOBES`] are left out.
    pub fn mixed(&self, other: &Bsdf, share: f32) -> Bsdf {
        let Bsdf { frame, n_geom, bends, splits, .. } = *self;
        let mut sum = Bsdf { bends, splits, ..Bsdf::empty(frame, n_geom) };
        let parts = self.weighted().map(|(w, lobe)| (w * (1.0 - share), lobe));
        let parts = parts.chain(other.weighted().map(|(w, lobe)| (w * share, lobe)));
        for (i, (weight, lobe)) in parts.enumerate().take(MAX_LOBES) {
            sum.set(i, lobe, weight);
        }
        sum
    }
}

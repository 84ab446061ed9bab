//! Contributions by brightness: a histogram per block and set of techniques.

/// Number of bins, of two octaves each, around 1.
pub(super) const BINS: usize = 32;

/// The contributions that the techniques of a set would find in a block, binned by the brightness of a single one.
#[derive(Clone, Debug, Default)]
pub(super) struct Contributions(pub(super) [Bin; BINS]);

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bin {
    /// The sum of the mean contributions.
    pub(super) light: f64,
    /// The sum of the mean contributions times what a single one brings: their second moment.
    pub(super) square: f64,
}

impl Contributions {
    /// Adds `light` on average, in contributions of `found` each.
    pub(super) fn add(&mut self, light: f64, found: f64) {
        let octave = (found.to_bits() >> 52 & 0x7ff) as i32 - 1023;
        let bin = (octave.div_euclid(2) + BINS as i32 / 2).clamp(0, BINS as i32 - 1) as usize;
        self.0[bin].light += light;
        self.0[bin].square += light * found;
    }

    /// Adds other contributions, times `share`.
    pub(super) fn plus(&mut self, others: &Contributions, share: f64) {
        for (bin, other) in self.0.iter_mut().zip(&others.0) {
            bin.light += share * other.light;
            bin.square += share * other.square;
        }
    }

    /// The second moment of all contributions.
    pub(super) fn square(&self) -> f64 {
        self.0.iter().map(|bin| bin.square).sum()
    }
}

//! Numbers that cannot be densities.

/// The bits of infinity: those of smaller numbers without a sign are below.
const INFINITY: u32 = f32::INFINITY.to_bits();

/// Counts of numbers that could not be densities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Numbers below 0.
    pub negative: u64,
    /// Infinities, and what is not a number.
    pub not_finite: u64,
}

impl Faults {
    /// The density nearest to a number, which is counted if that is another one.
    #[inline]
    pub fn density(&mut self, value: f32) -> f32 {
        if (0.0..f32::INFINITY).contains(&value) {
            // Zero has no sign.
            return value + 0.0;
        }
        *(if value.is_finite() { &mut self.negative } else { &mut self.not_finite }) += 1;
        0.0
    }

    /// Makes densities of all these.
    pub(super) fn densities(&mut self, values: &mut [f32]) {
        let largest = values.iter().fold(0, |largest: u32, value| largest.max(value.to_bits()));
        if largest >= INFINITY {
            values.iter_mut().for_each(|value| *value = self.density(*value));
        }
    }

    /// These and others.
    pub(super) fn and(self, others: Faults) -> Faults {
        Faults { negative: self.negative + others.negative, not_finite: self.not_finite + others.not_finite }
    }
}

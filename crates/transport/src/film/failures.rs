//! Bad samples: counted and located, pixel by pixel, so that nothing is hidden.

/// The bad samples of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PixelFailures {
    pub(crate) non_finite: u32,
    pub(crate) first_non_finite: u32,
    pub(crate) overflowed: u32,
    pub(crate) first_overflowed: u32,
}

/// The position of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplePlace {
    /// Column.
    pub x: u32,
    /// Row, counted downwards.
    pub y: u32,
    /// Index of the sample within the pixel.
    pub sample: u32,
}

/// The bad samples of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleFailures {
    /// Number of samples that were infinite or NaN; they are left out of their pixels' means.
    pub non_finite: u64,
    /// The first of them, row by row.
    pub first_non_finite: Option<SamplePlace>,
    /// Number of samples that were brighter than the film can hold; they are clamped to its maximum.
    pub overflowed: u64,
    /// The first of them, row by row.
    pub first_overflowed: Option<SamplePlace>,
}

impl PixelFailures {
    pub(crate) fn non_finite_at(sample: u32) -> PixelFailures {
        PixelFailures { non_finite: 1, first_non_finite: sample, ..PixelFailures::default() }
    }

    pub(crate) fn overflowed_at(sample: u32) -> PixelFailures {
        PixelFailures { overflowed: 1, first_overflowed: sample, ..PixelFailures::default() }
    }

    pub(crate) fn is_any(&self) -> bool {
        self.non_finite > 0 || self.overflowed > 0
    }

    /// Adds counts; the first sample is the minimum of both.
    pub(crate) fn absorb(&mut self, other: &PixelFailures) {
        let first = |n: u32, first: u32, m: u32, second: u32| match (n, m) {
            (_, 0) => first,
            (0, _) => second,
            _ => first.min(second),
        };
        self.first_non_finite =
            first(self.non_finite, self.first_non_finite, other.non_finite, other.first_non_finite);
        self.first_overflowed =
            first(self.overflowed, self.first_overflowed, other.overflowed, other.first_overflowed);
        self.non_finite = self.non_finite.saturating_add(other.non_finite);
        self.overflowed = self.overflowed.saturating_add(other.overflowed);
    }
}

//! Pixels that are computed side by side.

/// Number of them: a register of AVX-512.
pub(super) const LANES: usize = 16;

/// Columns of a tile of a pass. Tiles at the right edge are as wide, and what they compute beyond it is not used.
pub(super) const COLUMNS: usize = 4 * LANES;

/// A number for each of them.
pub(super) type Lanes = [f32; LANES];

/// The numbers from index `first` on.
#[inline(always)]
pub(super) fn lanes_at(numbers: &[f32], first: usize) -> Lanes {
    let numbers = &numbers[first..first + LANES];
    std::array::from_fn(|lane| numbers[lane])
}

/// Adds a · b to sums, lane by lane.
#[inline(always)]
pub(super) fn add_products(sums: &mut Lanes, a: &Lanes, b: &Lanes) {
    for lane in 0..LANES {
        sums[lane] += a[lane] * b[lane];
    }
}

/// Adds numbers times a factor to sums, lane by lane.
#[inline(always)]
pub(super) fn add_scaled(sums: &mut Lanes, numbers: &Lanes, factor: f32) {
    for lane in 0..LANES {
        sums[lane] += numbers[lane] * factor;
    }
}

/// The products of both, lane by lane.
#[inline(always)]
pub(super) fn product(a: &Lanes, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

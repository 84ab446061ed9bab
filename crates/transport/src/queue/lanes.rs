//! Columns of many paths, on which stages work.
//!
//! A column is one array of [`LANES`] numbers for each quantity. The loops of a [`Stage`] have no branches and no calls
//! that are not inlined, so the compiler turns them into vector instructions of each level.

pub(super) use bilux_math::cpu_level::{Stage, run_at};
use bilux_math::{Rgb, Vec3};

/// The length of a column: enough to hide the latency of divisions and square roots, small enough for the first cache.
pub(super) const LANES: usize = 64;

/// A quantity of [`LANES`] paths.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Column(pub(super) [f32; LANES]);

impl Column {
    pub(super) const ZERO: Column = Column([0.0; LANES]);
}

/// Three columns: vectors, or colours.
pub(super) type Columns3 = [Column; 3];

pub(super) const ZERO3: Columns3 = [Column::ZERO; 3];

#[inline(always)]
pub(super) fn vec3(columns: &Columns3, i: usize) -> Vec3 {
    Vec3::new(columns[0].0[i], columns[1].0[i], columns[2].0[i])
}

#[inline(always)]
pub(super) fn rgb(columns: &Columns3, i: usize) -> Rgb {
    Rgb::new(columns[0].0[i], columns[1].0[i], columns[2].0[i])
}

#[inline(always)]
pub(super) fn put(columns: &mut Columns3, i: usize, [x, y, z]: [f32; 3]) {
    (columns[0].0[i], columns[1].0[i], columns[2].0[i]) = (x, y, z);
}

/// A lane of many columns.
#[inline(always)]
pub(super) fn numbers_at<const N: usize>(columns: &[Column; N], i: usize) -> [f32; N] {
    let mut numbers = [0.0; N];
    for (number, column) in numbers.iter_mut().zip(columns) {
        *number = column.0[i];
    }
    numbers
}

#[inline(always)]
pub(super) fn put_numbers<const N: usize>(columns: &mut [Column; N], i: usize, numbers: [f32; N]) {
    for (column, number) in columns.iter_mut().zip(numbers) {
        column.0[i] = number;
    }
}

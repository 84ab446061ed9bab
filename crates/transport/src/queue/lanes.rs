//! Loops over many paths, compiled for each level of instructions.
//!
//! A stage works on columns: one array of [`LANES`] numbers for each quantity. Its loops have no branches and no calls
//! that are not inlined, so the compiler turns them into vector instructions. All operations are exactly rounded and
//! nothing is contracted into fused products, so every level computes the same bits.
#![allow(unsafe_code)] // One call for each level, after a check that the machine supports it.

use bilux_math::{Rgb, Vec3};
use bilux_scene::CpuLevel;

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

/// A loop over columns. `run` has to be `#[inline(always)]`.
///
/// It has one or two fields, each a reference or a number. Only then are they passed as arguments, of which the compiler
/// knows that they do not overlap; otherwise it checks that at run time, and keeps a scalar loop beside the vector one.
/// What else keeps a loop scalar is in docs/adr/0011-one-path-or-waves.md: look at its instructions after a change.
pub(super) trait Stage {
    fn run(self);
}

/// Runs a stage with the instructions of a level, or of the highest that the machine supports if that is lower.
#[inline]
pub(super) fn run_at(level: CpuLevel, stage: impl Stage) {
    #[cfg(target_arch = "x86_64")]
    match level.available() {
        // SAFETY: the machine supports the level.
        CpuLevel::Avx512 => return unsafe { avx512(stage) },
        // SAFETY: as above.
        CpuLevel::Avx2 => return unsafe { avx2(stage) },
        // SAFETY: as above.
        CpuLevel::Sse42 => return unsafe { sse42(stage) },
        CpuLevel::Baseline => {}
    }
    let _ = level;
    baseline(stage);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn avx512(stage: impl Stage) {
    stage.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn avx2(stage: impl Stage) {
    stage.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "sse4.2,popcnt")]
fn sse42(stage: impl Stage) {
    stage.run();
}

/// A function of its own: inlined into its caller, a loop loses the information that its columns do not overlap.
#[inline(never)]
fn baseline(stage: impl Stage) {
    stage.run();
}

//! The instruction sets that kernels may use, and loops that are compiled for each of them.
//!
//! All operations of such a loop are exactly rounded and nothing is contracted into fused products, so every level computes the same bits.
#![allow(unsafe_code)] // One call for each level, after a check that the machine supports it.

/// Levels of instruction sets, each including those before it. The level is chosen when a structure is built, never
/// per ray, and never changes an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CpuLevel {
    /// The baseline that every machine of the target has.
    Baseline,
    /// SSE4.2 with POPCNT, found in all machines since 2009: four lanes.
    Sse42,
    /// AVX2 with FMA, BMI and related sets, found in all machines since 2013: eight lanes.
    Avx2,
    /// AVX-512 F, VL, DQ and BW, found in all server machines since 2017: sixteen lanes, and masks for eight.
    Avx512,
}

impl CpuLevel {
    /// All levels, lowest first.
    pub const ALL: [CpuLevel; 4] = [CpuLevel::Baseline, CpuLevel::Sse42, CpuLevel::Avx2, CpuLevel::Avx512];

    /// The highest level that this machine supports.
    pub fn detect() -> CpuLevel {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let avx2 = has!("avx2") && has!("fma") && has!("lzcnt") && has!("popcnt");
            let avx2 = avx2 && has!("bmi1") && has!("bmi2");
            let avx512 = has!("avx512f") && has!("avx512vl") && has!("avx512dq") && has!("avx512bw");
            if avx2 && avx512 {
                return CpuLevel::Avx512;
            }
            if avx2 {
                return CpuLevel::Avx2;
            }
            if has!("sse4.2") && has!("popcnt") {
                return CpuLevel::Sse42;
            }
        }
        CpuLevel::Baseline
    }

    /// This level, or the highest that the machine supports if that is lower.
    pub fn available(self) -> CpuLevel {
        self.min(CpuLevel::detect())
    }

    /// The name used in settings.
    pub const fn name(self) -> &'static str {
        match self {
            CpuLevel::Baseline => "baseline",
            CpuLevel::Sse42 => "sse4.2",
            CpuLevel::Avx2 => "avx2",
            CpuLevel::Avx512 => "avx512",
        }
    }
}

impl Default for CpuLevel {
    /// The highest level that this machine supports.
    fn default() -> CpuLevel {
        CpuLevel::detect()
    }
}

/// A loop over arrays of numbers. `run` has to be `#[inline(always)]`.
///
/// It has one or two fields, each a reference or a number. Only then are they passed as arguments, of which the compiler
/// knows that they do not overlap; otherwise it checks that at run time, and keeps a scalar loop beside the vector one.
/// What else keeps a loop scalar is in docs/adr/0011-one-path-or-waves.md: look at its instructions after a change.
pub trait Stage {
    /// Runs it.
    fn run(self);
}

/// Runs a stage with the instructions of a level, or of the highest that the machine supports if that is lower.
#[inline]
pub fn run_at(level: CpuLevel, stage: impl Stage) {
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

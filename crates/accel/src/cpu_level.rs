//! The instruction sets that kernels may use.

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

//! Which instructions kernels may use.

/// Levels of instruction sets, each holding those before. What is asked for is chosen when a structure is
/// built, never per ray, and never changes an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CpuLevel {
    /// What every machine of the target has.
    Baseline,
    /// AVX2, eight lanes.
    Avx2,
    /// AVX-512 F, sixteen lanes.
    Avx512,
}

impl CpuLevel {
    /// All levels, the lowest first.
    pub const ALL: [CpuLevel; 3] = [CpuLevel::Baseline, CpuLevel::Avx2, CpuLevel::Avx512];

    /// The highest level that this machine has.
    pub fn detect() -> CpuLevel {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") {
                return CpuLevel::Avx512;
            }
            if std::arch::is_x86_feature_detected!("avx2") {
                return CpuLevel::Avx2;
            }
        }
        CpuLevel::Baseline
    }

    /// This level, or the highest that the machine has if that is lower.
    pub fn available(self) -> CpuLevel {
        self.min(CpuLevel::detect())
    }

    /// The name that people type.
    pub const fn name(self) -> &'static str {
        match self {
            CpuLevel::Baseline => "baseline",
            CpuLevel::Avx2 => "avx2",
            CpuLevel::Avx512 => "avx512",
        }
    }
}

impl Default for CpuLevel {
    /// The highest that this machine has.
    fn default() -> CpuLevel {
        CpuLevel::detect()
    }
}

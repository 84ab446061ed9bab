//! What `-V` says.

use bilux::accel::CpuLevel;

/// Version, commit, and the CPU level that kernels are chosen for.
pub fn text() -> String {
    let (version, commit) = (env!("CARGO_PKG_VERSION"), env!("BILUX_COMMIT"));
    format!("{version} ({commit}, CPU level {})", CpuLevel::detect().name())
}

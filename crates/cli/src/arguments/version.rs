//! Text that `-V` prints.

use crate::sandbox;
use bilux::accel::CpuLevel;

/// The version, the commit, the CPU level that kernels are chosen for, and what enforces `--sandbox`.
pub fn text() -> String {
    let (version, commit) = (env!("CARGO_PKG_VERSION"), env!("BILUX_COMMIT"));
    format!(
        "{version} ({commit}, CPU level {}, sandbox {})",
        CpuLevel::detect().name(),
        sandbox::available().describe()
    )
}

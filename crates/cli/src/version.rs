//! What `-V` says.

/// Version and commit.
pub fn text() -> String {
    let (version, commit) = (env!("CARGO_PKG_VERSION"), env!("BILUX_COMMIT"));
    format!("{version} ({commit})")
}

//! Files that are released with the binary.

use crate::licences::PAGE as NOTICES;

/// The files that accompany the binary.
pub(super) const PAGES: &[&str] = &["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE", NOTICES];

/// The scenes that the commands on the front page use.
pub(super) const SCENES: &str = "scenes";

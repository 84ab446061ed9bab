//! What Bilux itself writes into the `extras` of its files.

/// The key in those of a scene that records its surroundings: "none" beyond the file's lights.
pub(super) const SURROUNDINGS: &str = "surroundings";

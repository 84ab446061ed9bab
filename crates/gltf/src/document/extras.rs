//! Keys that Bilux itself writes into the `extras` of its files, and reads there.

/// The key in those of a scene that records its surroundings: "none" beyond the file's lights.
pub(crate) const SURROUNDINGS: &str = "surroundings";

/// The key in those of a node or a mesh that says what kind of thing it is, such as "chair". It is that of all nodes below, too.
pub(crate) const CATEGORY: &str = "category";

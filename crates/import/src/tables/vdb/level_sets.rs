//! Level sets, which both kinds of files may have.

/// Why a level set is no density.
pub(super) const LEVEL_SET: &str = "is a level set, distances from a surface, and not a density: convert it to a fog volume where it \
                         was made, or export its surface as a mesh";

//! Meaning of a file's instances: placements, units, styles, and the tree of products.

pub(super) mod axes;
pub(super) mod placements;
pub(super) mod products;
pub(super) mod styles;
pub(super) mod units;

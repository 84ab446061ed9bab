//! The choice of an acceleration structure.

use bilux_accel::{BuildOptions, Query};

/// The acceleration structure that traces the rays.
#[derive(Clone, Debug)]
pub struct AccelChoice {
    /// Name in [`bilux_accel::ACCELERATORS`], or `auto`.
    pub name: String,
    /// Options with which it is built.
    pub options: BuildOptions,
    /// Query with which it is traversed.
    pub query: Query<'static>,
}

impl Default for AccelChoice {
    fn default() -> AccelChoice {
        AccelChoice { name: "auto".to_owned(), options: BuildOptions::default(), query: Query::default() }
    }
}

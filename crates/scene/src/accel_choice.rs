//! The choice of an acceleration structure.

use bilux_accel::{BuildOptions, Query};

/// The acceleration structure that traces the rays.
#[derive(Clone, Debug)]
pub struct AccelChoice {
    /// Its name in [`bilux_accel::ACCELERATORS`], or `auto`.
    pub name: String,
    /// How it is built.
    pub options: BuildOptions,
    /// How it is traversed.
    pub query: Query<'static>,
}

impl Default for AccelChoice {
    fn default() -> AccelChoice {
        AccelChoice { name: "auto".to_owned(), options: BuildOptions::default(), query: Query::default() }
    }
}

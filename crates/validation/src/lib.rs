//! Development only: contract suites, reference scenes and statistical tests, each with a planted bug that it
//! catches.

pub mod agreement;
pub mod bsdf_contract;
pub mod camera_contract;
pub mod chi_square;
pub mod course_oracle;
mod judging;
pub mod light_contract;
pub mod statistics;
pub mod tally;

use bilux_testing::verdicts::Suite;

/// The comparisons of this crate.
pub const SUITE: Suite = Suite::new(env!("CARGO_PKG_NAME"));

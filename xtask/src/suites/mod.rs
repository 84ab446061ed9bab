//! The suites of tests: each binary that cargo has built runs in several processes, as many at a time as there are cores,
//! and what each test takes is measured in CPU time.

mod chunks;
mod found;
mod printed;
mod process;
mod report;
mod running;
mod totals;

use anyhow::Result;
pub(crate) use running::{Options, Running};
pub(crate) use totals::Totals;

/// Builds the suites and runs each as soon as it is built. A test that fails is an error, and so is none that ran.
pub(crate) fn run(options: Options, totals: &mut Totals) -> Result<()> {
    let running = Running::start(options);
    crate::build::watched(|message| running.add(message))?;
    running.finish(totals)
}

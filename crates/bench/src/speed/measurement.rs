//! One way of filling rows of the table, and what it is given.

use super::options::Options;
use super::row::Row;
use crate::ProgressFn;
use bilux::Error;

/// One way of filling rows of the table.
pub struct Measurement {
    /// Name for the user.
    pub name: &'static str,
    /// Summary of the rows that it fills.
    pub summary: &'static str,
    pub(super) run: fn(&Context) -> Result<Vec<Row>, Error>,
}

/// Inputs of a measurement.
pub(super) struct Context<'a> {
    pub(super) options: &'a Options,
    pub(super) progress: ProgressFn<'a>,
    /// Nothing else is measured by this process.
    pub(super) is_alone: bool,
}

impl Context<'_> {
    /// Says what is being measured.
    pub(super) fn say(&self, what: &str) {
        (self.progress)(what);
    }

    /// Numbers of rounds, from 0.
    pub(super) fn rounds(&self) -> std::ops::Range<u32> {
        0..self.options.repeats.max(1)
    }
}

//! What else a render can give beside its picture.

use bilux_math::registry::Entry;
use bilux_scene::{SceneError, Span};

/// What it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// [`crate::strategies()`].
    Strategies,
    /// [`crate::Interval`].
    Interval,
}

/// A row of [`AOVS`].
#[derive(Clone, Copy, Debug)]
pub struct AovEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// Which one.
    pub aov: Aov,
}

/// Every one that there is.
pub const AOVS: &[AovEntry] = &[
    AovEntry {
        entry: Entry {
            name: "strategies",
            summary: "each way of joining paths from both ends on its own, weighted and not (bdpt, vcm)",
            source: "Veach 1997",
            parameters: &[],
        },
        aov: Aov::Strategies,
    },
    AovEntry {
        entry: Entry {
            name: "interval",
            summary: "how far to both sides of a pixel its true light may lie: half of the 95% interval",
            source: "Owen 1997",
            parameters: &[],
        },
        aov: Aov::Interval,
    },
];

/// The row of this name, wanted at `at`.
///
/// # Errors
/// When there is none.
pub fn find(name: &str, at: &Span) -> Result<&'static AovEntry, SceneError> {
    let names = AOVS.iter().map(|row| row.entry.name);
    let row = AOVS.iter().find(|row| row.entry.name == name);
    row.ok_or_else(|| SceneError::unknown("aov", name, names, at))
}

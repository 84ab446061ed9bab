//! A file of MTL.

use super::habits::Habit;
use bilux_import::oddities::Oddities;
use bilux_import::reading::{Reading, Source};
use bilux_import::text::{Cursor, Places};

/// A library while it is read.
pub(super) struct Library<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) cursor: Cursor<'a>,
    pub(super) places: Places<'a>,
    pub(super) oddities: Oddities,
    /// What its program means by the specular keywords, where that is not Phong's.
    pub(super) habit: Option<Habit>,
}

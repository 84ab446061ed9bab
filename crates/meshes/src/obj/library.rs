//! A file of MTL.

use super::habits::Habit;
use bilux_import::bytes::text::{Cursor, Places};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};

/// A library while it is read.
pub(super) struct Library<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) cursor: Cursor<'a>,
    pub(super) places: Places<'a>,
    pub(super) diagnostics: Diagnostics,
    /// Meaning of the specular keywords to the program that wrote the library, where that is not Phong's.
    pub(super) habit: Option<Habit>,
}

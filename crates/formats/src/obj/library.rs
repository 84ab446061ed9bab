//! A file of MTL.

use crate::oddities::Oddities;
use crate::reading::{Reading, Source};
use crate::text::{Cursor, Places};

/// A library while it is read.
pub(super) struct Library<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) cursor: Cursor<'a>,
    pub(super) places: Places<'a>,
    pub(super) oddities: Oddities,
}

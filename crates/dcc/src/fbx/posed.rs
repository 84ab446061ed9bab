//! A document as it is at one time.

use super::animation::Pose;
use super::document::{Document, Index, Properties};
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;

/// A document with the values that its animation gives to properties.
pub(super) struct Posed<'d> {
    pub(super) document: &'d Document<'d>,
    pub(super) pose: Pose<'d>,
}

impl<'d> Posed<'d> {
    /// The document at a time in seconds, with the animation that the options name.
    pub(super) fn read(
        document: &'d Document<'d>,
        time: f32,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<Posed<'d>, FormatError> {
        let wanted = reading.options.animation.as_deref();
        let pose = Pose::read(document, time, wanted, &mut reading.budget, diagnostics)?;
        Ok(Posed { document, pose })
    }

    /// The properties of an object at this time.
    pub(super) fn properties(&self, index: Index) -> Properties<'d, '_> {
        self.document.properties(index).animated(self.pose.animated.get(&index))
    }
}

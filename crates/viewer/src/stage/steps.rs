//! Steps of a render, between which requests are looked at.

use crate::inbox::Inbox;
use bilux::transport::Progress;
use std::time::Duration;

/// Time that a step of the picture takes: then requests are looked at.
pub(super) const STEP: Duration = Duration::from_millis(60);

/// Stops a step whose picture is out of date.
pub(super) struct Interruptible<'a>(pub(super) &'a Inbox);

impl Progress for Interruptible<'_> {
    fn begin(&self, _samples: u64) {}

    fn advance(&self, _samples: u64, _rays: u64) {}

    fn is_cancelled(&self) -> bool {
        self.0.interrupts()
    }
}

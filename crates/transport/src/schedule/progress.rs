//! Progress, by which a caller follows the work, and stops it.

/// Receives progress, and may cancel the work. Called from many threads, about once per tile.
pub trait Progress: Sync {
    /// This many more samples and rays have been taken.
    fn advance(&self, samples: u64, rays: u64);
    /// This many samples will be taken.
    fn begin(&self, _samples: u64) {}
    /// True when the work must stop; what is finished is kept.
    fn is_cancelled(&self) -> bool;
}

/// Ignores progress, and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn advance(&self, _samples: u64, _rays: u64) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}

//! The limits that settings and films keep to; messages name them.

/// Default number of scattering events after the camera.
pub const DEFAULT_MAX_DEPTH: u32 = 16;

/// The maximum depth that may be requested.
pub const MAX_DEPTH: u32 = 1000;

/// Maximum number of samples of one pixel, so that sums cannot overflow.
pub const MAX_SAMPLES: u32 = 1 << 22;

/// A sample is clamped to ±2⁴¹ steps.
pub(crate) const SAMPLE_BITS: i32 = 41;

/// Maximum length of a side of a film, in pixels.
pub const MAX_SIDE: u32 = 1 << 16;

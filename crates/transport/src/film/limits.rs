//! The limits that settings and films keep to; messages name them.

/// Default number of scattering events after the camera.
pub const DEFAULT_MAX_DEPTH: u32 = 16;

/// Maximum number of events in media behind surfaces, one after the other, from one surface of a path to the next, and before the first and after the last. Of light
/// in white milk without end, less than one part in a hundred goes on for longer.
pub const MAX_MEDIUM_EVENTS: u32 = 1 << 16;

/// Maximum number of events in media behind surfaces, one after the other, between which two subpaths are connected. Walks through milk have
/// thousands: whatever joins them finds hardly more than walks find by themselves, and takes the square of the time.
pub(crate) const MAX_CONNECTED_ROW: u32 = if cfg!(test) { 3 } else { 16 };

/// Events that limit a path: those on surfaces and in fog, and those in skin, milk and the like since the last surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Events {
    pub(crate) counted: u32,
    pub(crate) in_row: u32,
}

impl Events {
    /// With another one, which may be behind a surface.
    #[inline]
    pub(crate) fn and(self, is_inside: bool) -> Events {
        match is_inside {
            true => Events { in_row: self.in_row + 1, ..self },
            false => Events { counted: self.counted + 1, in_row: 0 },
        }
    }

    /// Of a path that merges the ends of two into one event, behind a surface or not.
    #[inline]
    pub(crate) fn merged(self, other: Events, is_inside: bool) -> Events {
        let Events { counted, in_row } = self.joined(other);
        match is_inside {
            true => Events { counted, in_row: in_row - 1 },
            false => Events { counted: counted - 1, in_row },
        }
    }

    /// Of a path that connects the ends of two.
    #[inline]
    pub(crate) fn joined(self, other: Events) -> Events {
        Events { counted: self.counted + other.counted, in_row: self.in_row + other.in_row }
    }

    /// Whether paths of this depth have them: events behind surfaces do not count against it. Without any, there is nothing but
    /// emission.
    #[inline]
    pub(crate) fn are_within(self, max_depth: u32) -> bool {
        let most_in_row = if max_depth > 0 { MAX_MEDIUM_EVENTS } else { 0 };
        self.counted <= max_depth && self.in_row <= most_in_row
    }
}

/// The maximum depth that may be requested.
pub const MAX_DEPTH: u32 = 1000;

/// Maximum number of samples of one pixel, so that sums cannot overflow.
pub const MAX_SAMPLES: u32 = 1 << 22;

/// A sample is clamped to ±2⁴¹ steps.
pub(crate) const SAMPLE_BITS: i32 = 41;

/// Maximum length of a side of a film, in pixels.
pub const MAX_SIDE: u32 = 1 << 16;

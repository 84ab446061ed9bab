//! No curve: values brighter than white are clipped to white.

use super::ToneMapEntry;
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// The row of `none`.
pub(super) const ENTRY: ToneMapEntry = ToneMapEntry {
    entry: Entry {
        name: "none",
        summary: "no curve: values are clamped to the range from 0 to 1",
        source: "",
        parameters: &[],
    },
    map: |colour: Rgb| colour.clamp(0.0, 1.0),
};

//! Reinhard's global curve with a white point.

use super::ToneMapEntry;
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// The row of `reinhard`.
pub(super) const ENTRY: ToneMapEntry = ToneMapEntry {
    entry: Entry {
        name: "reinhard",
        summary: "Reinhard's curve on luminance, with the white point at 4",
        source: "Reinhard 2002",
        parameters: &[],
    },
    map: reinhard,
};

/// The lowest luminance that is shown as white.
const WHITE: f32 = 4.0;

/// Scales the colour so that its luminance becomes L (1 + L / white²) / (1 + L). [Reinhard 2002, eq. 4]
fn reinhard(colour: Rgb) -> Rgb {
    let luminance = colour.luminance();
    if luminance <= 0.0 || luminance >= f32::MAX {
        return colour.clamp(0.0, 1.0);
    }
    let scale = (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance);
    (colour * scale).clamp(0.0, 1.0)
}

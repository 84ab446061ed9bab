//! A filmic curve: the fit of the ACES reference rendering by Narkowicz.

use super::ToneMapEntry;
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// The row of `aces`.
pub(super) const ENTRY: ToneMapEntry = ToneMapEntry {
    entry: Entry {
        name: "aces",
        summary: "filmic: soft shoulder and toe, after the ACES reference rendering",
        source: "Narkowicz 2015",
        parameters: &[],
    },
    map: |colour: Rgb| colour.map(filmic),
};

/// The rational fit, in f64 so that the squares of the brightest samples do not overflow.
fn filmic(light: f32) -> f32 {
    let x = f64::from(light);
    let shown = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
    shown.clamp(0.0, 1.0) as f32
}

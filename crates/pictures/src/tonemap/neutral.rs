//! Khronos PBR Neutral: shows the base colours of products unchanged up to where highlights begin; highlights are
//! compressed and desaturated.

use super::ToneMapEntry;
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// The row of `neutral`.
pub(super) const ENTRY: ToneMapEntry = ToneMapEntry {
    entry: Entry {
        name: "neutral",
        summary: "Khronos PBR Neutral: true product colours; only highlights are compressed",
        source: "Khronos 2024",
        parameters: &[],
    },
    map: neutral,
};

/// The fraction that glossy surfaces reflect at normal incidence, which the curve subtracts.
const F90: f32 = 0.04;
/// Light at which compression begins, after that subtraction.
const START: f32 = 0.8 - F90;
/// Rate at which highlights desaturate.
const DESATURATION: f32 = 0.15;

fn neutral(colour: Rgb) -> Rgb {
    let least = colour.r.min(colour.g).min(colour.b);
    let offset = if least < 2.0 * F90 { least - least * least / (4.0 * F90) } else { F90 };
    let colour = colour - Rgb::grey(offset);
    let peak = colour.max_channel();
    if peak < START {
        return colour.clamp(0.0, 1.0);
    }
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    let colour = colour * (compressed / peak);
    (colour * (1.0 - white) + Rgb::grey(compressed * white)).clamp(0.0, 1.0)
}

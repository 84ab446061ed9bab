//! Radiance's units in those of Bilux.

use bilux_math::Rgb;
use bilux_math::photometry::LUMENS_PER_WATT;

/// The luminous efficacy by which Radiance's programs turn W into lm. [Ward 1994]
pub(super) const EFFICACY: f64 = 179.0;

/// The greatest radiance that lights have here.
const MOST: f32 = 1e12;

/// Light here for an amount of light in Radiance, so that its lumens stay the same: 179 of 1 W there, 683 here.
pub(super) fn light(colour: [f64; 3]) -> Rgb {
    let factor = EFFICACY / f64::from(LUMENS_PER_WATT);
    let [r, g, b] = colour.map(|c| (c * factor) as f32);
    Rgb::new(r, g, b).clamp(0.0, MOST)
}

/// A reflectance or a transmittance.
pub(super) fn share(colour: [f64; 3]) -> Rgb {
    let [r, g, b] = colour.map(|c| c as f32);
    Rgb::new(r, g, b).clamp(0.0, 1.0)
}

//! What is between surfaces: nothing, or glass that absorbs.

use bilux_math::Rgb;
use bilux_math::transcendental::exp;

/// The share of light that is left after a distance in metres, by Beer's law.
#[inline]
pub(crate) fn transmittance(sigma_a: Rgb, distance: f32) -> Rgb {
    if sigma_a.is_black() { Rgb::WHITE } else { sigma_a.map(|sigma| exp(-sigma * distance)) }
}

//! Sources in their places.

use super::look::PlacedSky;
use bilux_math::DVec3;
use bilux_math::transcendental::sin_f64;
use bilux_scene::Span;
use std::f64::consts::PI;
use std::rc::Rc;

/// A source in its place.
pub(super) struct DistantSource {
    pub(super) name: Rc<str>,
    /// Towards its middle, with z up.
    pub(super) direction: DVec3,
    /// Angular diameter.
    pub(super) degrees: f64,
    /// Radiance in Radiance's units; with a sky, a factor on that of the sky.
    pub(super) colour: [f64; 3],
    pub(super) sky: Option<PlacedSky>,
    pub(super) at: Span,
}

impl DistantSource {
    /// The irradiance of a surface that faces it.
    pub(super) fn irradiance(&self) -> [f64; 3] {
        let sin = sin_f64((0.5 * self.degrees).to_radians());
        self.colour.map(|c| c * PI * sin * sin)
    }

    /// Radiance below the horizon.
    pub(super) fn ground(&self) -> [f64; 3] {
        let factor = self.sky.as_ref().map_or(1.0, |placed| placed.sky.ground);
        self.colour.map(|c| c * factor)
    }
}

//! Bounds of where splats count.

use bilux_math::Vec2;

/// The part of the film's plane (the film is 0..1 on both axes) that its pixels' filters reach. Beyond the film's edge it is
/// as wide as the filter is wider than a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplatBounds {
    pub(crate) min: Vec2,
    pub(crate) max: Vec2,
}

impl SplatBounds {
    /// Whether some pixel's filter reaches a point.
    #[inline]
    pub(crate) fn contains(&self, film: Vec2) -> bool {
        film.cmpge(self.min).all() && film.cmplt(self.max).all()
    }
}

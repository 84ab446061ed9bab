//! What lights infinitely far have in common: their rays enter the scene through a disc across them, as wide as
//! the sphere around the scene and just outside of it. [Georgiev 2012]

use crate::surface::gamma;
use bilux_math::{Aabb, Frame, Vec2, Vec3, warp};

/// Density over area of the points of [`sample_disc`]; zero where the scene has no size, or none that can be squared.
pub(super) fn disc_pdf_area(bounds: &Aabb) -> f32 {
    let radius = bounds.radius();
    let pdf = warp::disc_pdf_area() / (radius * radius);
    if pdf.is_finite() { pdf } else { 0.0 }
}

/// A point from which light along `direction` may reach anything within `bounds`, which must not be empty.
pub(super) fn sample_disc(bounds: &Aabb, direction: Vec3, u: Vec2) -> Vec3 {
    let (centre, radius) = (bounds.centre(), bounds.radius());
    let across = Frame::from_normal(direction);
    let d = warp::sample_disc(u) * radius;
    // Beyond what rounding can do to the sphere and to the point.
    let away = radius + gamma(16) * (radius + centre.abs().max_element());
    centre + across.s * d.x + across.t * d.y - direction * away
}

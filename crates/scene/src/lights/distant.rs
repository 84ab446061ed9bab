//! Shared by infinite lights: their rays enter the scene through a perpendicular disc as wide as the scene's bounding
//! sphere, and just outside of it. [Georgiev 2012]

use super::EmissionSample;
use crate::surface::gamma;
use bilux_accel::Primitive;
use bilux_math::{Aabb, Frame, Rgb, Vec2, Vec3, warp};

/// Area density of points on the disc; zero where the scene has no size, or a size whose square is out of range.
pub(super) fn disc_pdf_area(bounds: &Aabb) -> f32 {
    let radius = bounds.radius();
    let pdf = warp::disc_pdf_area() / (radius * radius);
    if pdf.is_finite() { pdf } else { 0.0 }
}

/// Place where light along a direction enters a scene, which must not be empty.
#[derive(Clone, Copy)]
pub(super) enum Across {
    /// Through a uniform point of the disc.
    Anywhere(Vec2),
    /// At a point of the square around the disc. See [`place_across`].
    At(Vec2),
}

/// A ray of light along `direction`, with the densities `pdf_direct` and `pdf_emission`; `None` if the latter is zero.
pub(super) fn ray(
    bounds: &Aabb,
    place: Across,
    direction: Vec3,
    le: Rgb,
    pdf_emission: f32,
    pdf_direct: f32,
) -> Option<EmissionSample> {
    let (centre, radius) = (bounds.centre(), bounds.radius());
    let across = Frame::from_normal(direction);
    let d = match place {
        Across::Anywhere(u) => warp::sample_disc(u),
        Across::At(at) => at * 2.0 - Vec2::ONE,
    } * radius;
    // Far enough that rounding of the sphere and of the point cannot matter.
    let away = radius + gamma(16) * (radius + centre.abs().max_element());
    (pdf_emission > 0.0).then(|| EmissionSample {
        p: centre + across.s * d.x + across.t * d.y - direction * away,
        p_error: Vec3::ZERO,
        n_light: Vec3::ZERO,
        direction,
        le,
        pdf_emission,
        pdf_direct,
        primitive: Primitive::NONE,
    })
}

/// Point at which the line through `p` along `direction` crosses the square around the disc: 0..=1 on both axes within it.
pub(super) fn place_across(bounds: &Aabb, p: Vec3, direction: Vec3) -> Vec2 {
    let across = Frame::from_normal(direction);
    let d = (p - bounds.centre()) / bounds.radius();
    Vec2::new(across.s.dot(d), across.t.dot(d)) * 0.5 + Vec2::splat(0.5)
}

/// Density over area of uniform points on that square; zero where it has no size.
pub(super) fn square_pdf_area(bounds: &Aabb) -> f32 {
    disc_pdf_area(bounds) * (0.25 / warp::disc_pdf_area())
}

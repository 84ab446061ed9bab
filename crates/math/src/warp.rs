//! Warps of the unit square: each `sample_x` with its density, and its inverse where the tests use one.

use crate::transcendental::{atan2, powf, sin_cos, sin_cos_near_zero};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

/// Maps the unit square to the unit disc and keeps neighbours close together. It has no branch, so that loops over many
/// points can be vectorised. [Shirley 1997]
#[inline(always)]
pub fn sample_disc(u: Vec2) -> Vec2 {
    let p = u * 2.0 - Vec2::ONE;
    let is_wide = p.x.abs() > p.y.abs();
    let (radius, across) = if is_wide { (p.x, p.y) } else { (p.y, p.x) };
    let ratio = if radius == 0.0 { 0.0 } else { across / radius };
    // In the upper and lower quarters the angle is π/2 minus this one.
    let (sin, cos) = sin_cos_near_zero(FRAC_PI_4 * ratio);
    let (x, y) = if is_wide { (cos, sin) } else { (sin, cos) };
    Vec2::new(radius * x, radius * y)
}

/// Density of [`sample_disc`] over the disc's area.
pub fn disc_pdf_area() -> f32 {
    FRAC_1_PI
}

/// Directions about +z with density cosθ/π, by Malley's method: points of the disc, projected up onto the sphere.
#[inline(always)]
pub fn sample_cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = sample_disc(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of [`sample_cosine_hemisphere`]; zero below the horizon.
pub fn cosine_hemisphere_pdf_solid_angle(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Uniformly distributed directions.
pub fn sample_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec3::new(r * c, r * s, z)
}

/// Density of [`sample_sphere`].
pub fn sphere_pdf_solid_angle() -> f32 {
    1.0 / (4.0 * PI)
}

/// Maps the unit square to the sphere, preserving areas and keeping neighbours close together: its centre to +z, its
/// corners to -z. [Clarberg 2008]
pub fn square_to_sphere(u: Vec2) -> Vec3 {
    let p = u * 2.0 - Vec2::ONE;
    let (x, y) = (p.x.abs(), p.y.abs());
    // How far inside the diamond of the upper hemisphere; negative in the lower one.
    let inside = 1.0 - (x + y);
    let r = 1.0 - inside.abs();
    let angle = if r == 0.0 { 0.0 } else { ((y - x) / r + 1.0) * FRAC_PI_4 };
    let z = (1.0 - r * r).copysign(inside);
    let across = r * (2.0 - r * r).max(0.0).sqrt();
    let (sin, cos) = sin_cos(angle);
    Vec3::new((cos * across).copysign(p.x), (sin * across).copysign(p.y), z)
}

/// The inverse of [`square_to_sphere`] for a unit vector.
pub fn sphere_to_square(d: Vec3) -> Vec2 {
    let r = (1.0 - d.z.abs()).max(0.0).sqrt();
    let y = atan2(d.y.abs(), d.x.abs()) * (2.0 * FRAC_1_PI) * r;
    let (x, y) = if d.z < 0.0 { (1.0 - y, 1.0 - (r - y)) } else { (r - y, y) };
    (Vec2::new(x.copysign(d.x), y.copysign(d.y)) * 0.5 + Vec2::splat(0.5)).clamp(Vec2::ZERO, Vec2::ONE)
}

/// Directions about +z, uniform within a cone with a minimum cosine of `cos_max`, -1..=1.
pub fn sample_cone(u: Vec2, cos_max: f32) -> Vec3 {
    sample_cap(u, 1.0 - cos_max)
}

/// Density of [`sample_cone`] within the cone; infinite for a cone of zero width.
pub fn cone_pdf_solid_angle(cos_max: f32) -> f32 {
    cap_pdf_solid_angle(1.0 - cos_max)
}

/// Directions about +z, uniform over a cap of the unit sphere of this height, 0..=2. The height is one minus the
/// cosine of the cone, which keeps the digits of a narrow one.
pub fn sample_cap(u: Vec2, height: f32) -> Vec3 {
    let below = u.x * height;
    // From one minus the cosine, because the cosine of a narrow cone would lose it.
    let r = (below * (2.0 - below)).max(0.0).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec3::new(r * c, r * s, 1.0 - below)
}

/// Density of [`sample_cap`] within the cap; infinite for a cap of zero height.
pub fn cap_pdf_solid_angle(height: f32) -> f32 {
    1.0 / (TAU * height)
}

/// Directions about +z with density (n+1)/2π · cosⁿα, the Phong lobe. [Lafortune 1994]
pub fn sample_power_cosine(u: Vec2, exponent: f32) -> Vec3 {
    let cos_alpha = powf(1.0 - u.x, 1.0 / (exponent + 1.0));
    let sin_alpha = (1.0 - cos_alpha * cos_alpha).max(0.0).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec3::new(sin_alpha * c, sin_alpha * s, cos_alpha)
}

/// Density of [`sample_power_cosine`]; zero below the horizon.
pub fn power_cosine_pdf_solid_angle(cos_alpha: f32, exponent: f32) -> f32 {
    if cos_alpha <= 0.0 { 0.0 } else { (exponent + 1.0) / TAU * powf(cos_alpha, exponent) }
}

/// Barycentric weights (of the second and third vertex), uniform over a triangle's area.
#[inline]
pub fn sample_triangle(u: Vec2) -> Vec2 {
    let root = u.x.sqrt();
    Vec2::new(root * (1.0 - u.y), root * u.y)
}

/// The inverse of [`sample_triangle`]: the point of the unit square for these weights.
pub fn invert_triangle(weights: Vec2) -> Vec2 {
    let root = weights.x + weights.y;
    Vec2::new(root * root, if root > 0.0 { weights.y / root } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangle_round_trips() {
        for i in 1..20 {
            for j in 0..20 {
                let u = Vec2::new(i as f32 / 20.0, j as f32 / 20.0);
                assert!(invert_triangle(sample_triangle(u)).abs_diff_eq(u, 1e-5));
            }
        }
    }

    #[test]
    fn square_to_sphere_is_uniform_and_invertible() {
        const SIDE: u32 = 64;
        let mut octants = [0u32; 8];
        let mut sum = Vec3::ZERO;
        for i in 0..SIDE * SIDE {
            let u = (Vec2::new((i % SIDE) as f32, (i / SIDE) as f32) + Vec2::splat(0.5)) / SIDE as f32;
            let d = square_to_sphere(u);
            assert!((d.length() - 1.0).abs() < 1e-6, "{u}: {d}");
            assert!(sphere_to_square(d).distance(u) < 1e-5, "{u}: {d}, {}", sphere_to_square(d));
            octants[(0..3).map(|k| usize::from(d[k] > 0.0) << k).sum::<usize>()] += 1;
            sum += d * d / (SIDE * SIDE) as f32;
        }
        // The diamond's edge passes through the centres of cells, which fall on either side of it.
        assert!(octants.iter().all(|n| n.abs_diff(SIDE * SIDE / 8) <= SIDE / 2), "{octants:?}");
        assert!((sum - Vec3::splat(1.0 / 3.0)).abs().max_element() < 1e-3, "{sum}");
        for d in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!(square_to_sphere(sphere_to_square(d)).distance(d) < 1e-6, "{d}");
        }
    }

    #[test]
    fn cones_are_sampled_uniformly_to_the_rim_however_narrow() {
        for cos_max in [-1.0f32, -0.3, 0.5, 0.999, 1.0 - f32::EPSILON] {
            let width = 1.0 - cos_max;
            for i in 0..=16 {
                let u = Vec2::new(i as f32 / 16.0, 0.3);
                let d = sample_cone(u, cos_max);
                // The fraction of the cone's solid angle about the axis, by the sine, which keeps its digits in a
                // narrow cone.
                let sin2 = f64::from(d.x) * f64::from(d.x) + f64::from(d.y) * f64::from(d.y);
                let below = 1.0 - (1.0 - sin2).max(0.0).sqrt() * f64::from(1f32.copysign(d.z));
                assert!((below - f64::from(u.x * width)).abs() < 1e-5 * f64::from(width), "{cos_max}: {d}");
            }
            assert!((cone_pdf_solid_angle(cos_max) * TAU * width - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn power_cosine_density_integrates_to_one() {
        for exponent in [0.0, 1.0, 8.0, 100.0] {
            let n = 20_000;
            let sum: f64 = (0..n)
                .map(|i| {
                    let c = (i as f32 + 0.5) / n as f32;
                    f64::from(power_cosine_pdf_solid_angle(c, exponent)) * f64::from(TAU) / n as f64
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-3, "exponent {exponent}: {sum}");
        }
    }
}

//! A uniformly bright disc at infinity: the sun, which casts soft shadows and appears in mirrors.

use super::distant::{Across, disc_pdf_area, ray};
use super::{ClassicLighting, EmissionSample, Light, LightSample, LightTracing};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use bilux_math::transcendental::sin;
use bilux_math::{Aabb, Frame, Rgb, Vec2, Vec3, warp};
use std::f32::consts::{FRAC_1_PI, PI};

pub(super) struct Sun {
    towards: Vec3,
    /// The height of the cap of the unit sphere that it covers.
    height: f32,
    radiance: Rgb,
    irradiance: Rgb,
    classic: Option<Rgb>,
}

impl Sun {
    /// A sun in direction `towards`, with an angular diameter in radians above 0 and at most π.
    ///
    /// `irradiance` is that of a surface that faces it.
    pub(super) fn new(towards: Vec3, diameter: f32, irradiance: Rgb, classic: Option<Rgb>) -> Sun {
        let (quarter, half) = (sin(diameter * 0.25), sin(diameter * 0.5));
        let radiance = irradiance / (PI * half * half);
        // 1 minus the cosine of half of its diameter.
        Sun { towards, height: 2.0 * quarter * quarter, radiance, irradiance, classic }
    }

    fn direction(&self, u: Vec2) -> Vec3 {
        Frame::from_normal(self.towards).to_world(warp::sample_cap(u, self.height)).normalize()
    }
}

impl Light for Sun {
    fn sample_li(&self, _from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        Some(LightSample {
            wi: self.direction(u),
            li: self.radiance,
            point: None,
            n_light: Vec3::ZERO,
            pdf_solid_angle: warp::cap_pdf_solid_angle(self.height),
            clearance: 0.0,
            pdf_start: None,
        })
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        if hit.is_some() || self.le(wi).is_black() { 0.0 } else { warp::cap_pdf_solid_angle(self.height) }
    }

    /// Compares the chord between the directions, which keeps digits that their cosine would lose.
    fn le(&self, direction: Vec3) -> Rgb {
        let is_within = (direction - self.towards).length_squared() <= 2.0 * self.height * (1.0 + 1e-4);
        if is_within { self.radiance } else { Rgb::BLACK }
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn power(&self, bounds: &Aabb) -> f32 {
        let radius = bounds.radius();
        // Integrated over the disc perpendicular to each ray, not over a surface that faces the sun's centre.
        self.radiance.luminance() * 2.0 * PI * self.height * PI * radius * radius
    }
}

impl LightTracing for Sun {
    fn sample_le(&self, bounds: &Aabb, _: f32, u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let towards = self.direction(u_direction);
        let pdf_direct = warp::cap_pdf_solid_angle(self.height);
        let pdf_emission = self.emission_pdf(bounds, pdf_direct, -towards, 1.0);
        ray(bounds, Across::Anywhere(u_point), -towards, self.radiance, pdf_emission, pdf_direct)
    }

    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let pdf = warp::cap_pdf_solid_angle(self.height);
        ray(bounds, Across::At(aim), -self.direction(u), self.radiance, pdf, pdf)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start
    }

    fn emission_pdf(&self, bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start * disc_pdf_area(bounds)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

impl ClassicLighting for Sun {
    fn classic(&self, _from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        Some(ClassicLight { wi: self.towards, position: None, strength: 1.0, clearance: 0.0 })
    }

    fn classic_colour(&self, _bounds: &Aabb) -> Rgb {
        self.classic.unwrap_or(self.irradiance * FRAC_1_PI)
    }
}

//! `point`: light from a point, the same in all directions.

use super::{
    BuiltLight, CLASSIC, ClassicLighting, EmissionSample, GROUP, Light, LightEntry, LightExtent, LightSample,
    LightTracing, colour, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use bilux_accel::Primitive;
use bilux_math::registry::Entry;
use bilux_math::{Aabb, Rgb, Vec2, Vec3, warp};
use std::f32::consts::PI;
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "point",
        summary: "isotropic point light",
        source: "",
        parameters: &[
            vector("position", "position", "0 5 0"),
            colour("intensity", "intensity in every direction", "W/sr", "100"),
            CLASSIC,
            GROUP,
        ],
    },
    surrounds: false,
    flux_per_intensity: super::ALL_AROUND,
    build: |reader, _| {
        Ok(BuiltLight::Light(Arc::new(Point {
            position: reader.vector("position"),
            intensity: reader.colour("intensity"),
            classic: given_classic(reader),
        })))
    },
};

/// A ray of light from a point, emitted with density `pdf_emission`; `None` if that is zero.
pub(super) fn ray(position: Vec3, direction: Vec3, le: Rgb, pdf_emission: f32) -> Option<EmissionSample> {
    (pdf_emission > 0.0).then_some(EmissionSample {
        p: position,
        p_error: Vec3::ZERO,
        n_light: Vec3::ZERO,
        direction,
        le,
        pdf_emission,
        pdf_direct: 1.0,
        primitive: Primitive::NONE,
    })
}

struct Point {
    position: Vec3,
    intensity: Rgb,
    classic: Option<Rgb>,
}

impl Light for Point {
    fn sample_li(&self, from: Vec3, _time: f32, _u: Vec2) -> Option<LightSample> {
        let to_light = self.position - from;
        let distance2 = to_light.length_squared();
        (distance2 > 0.0).then(|| LightSample {
            wi: to_light / distance2.sqrt(),
            li: self.intensity / distance2,
            point: Some(self.position),
            n_light: Vec3::ZERO,
            pdf_solid_angle: 1.0,
            clearance: 0.0,
            pdf_start: None,
        })
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, _wi: Vec3, _hit: Option<&Surface>) -> f32 {
        0.0
    }

    fn middle_and_reach(&self) -> Option<(Vec3, f32)> {
        Some((self.position, 0.0))
    }

    fn extent(&self, _shutter: [f32; 2]) -> Option<LightExtent> {
        Some(LightExtent::all_around(Aabb::of_points([self.position])))
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        self.intensity.luminance() * 4.0 * PI
    }
}

impl LightTracing for Point {
    fn sample_le(&self, bounds: &Aabb, _: f32, _u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let direction = warp::sample_sphere(u_direction);
        ray(self.position, direction, self.intensity, self.emission_pdf(bounds, 1.0, direction, 1.0))
    }

    fn sample_le_aimed(&self, _: &Aabb, _time: f32, _u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        ray(self.position, warp::square_to_sphere(aim).normalize(), self.intensity, 1.0)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start * warp::sphere_pdf_solid_angle()
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for Point {
    fn classic(&self, from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        let wi = (self.position - from).try_normalize()?;
        Some(ClassicLight { wi, position: Some(self.position), strength: 1.0, clearance: 0.0 })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        self.classic.unwrap_or_else(|| super::classic_colour_of(self.intensity, self.position, bounds))
    }
}

//! `spot`: light from a point into a cone, with a soft edge.

use super::{
    Beam, BuiltLight, CLASSIC, ClassicLighting, DirectionCone, EmissionSample, GROUP, Light, LightEntry,
    LightExtent, LightSample, LightTracing, colour, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use crate::surface::Surface;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::{acos, cos};
use bilux_math::{Aabb, Frame, Rgb, Vec2, Vec3, warp};
use std::f32::consts::TAU;
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "spot",
        summary: "spotlight: a point light that shines into a cone, with a soft edge",
        source: "",
        parameters: &[
            vector("position", "position", "0 5 0"),
            vector("look_at", "the point at the centre of the cone", "0 0 0"),
            colour("intensity", "intensity along its axis", "W/sr", "100"),
            angle("angle", "angle from the axis to the edge of the cone", "30"),
            angle("inner_angle", "angle from the axis at which it begins to fade", "25"),
            CLASSIC,
            GROUP,
        ],
    },
    surrounds: false,
    flux_per_intensity: |reader| {
        let [cos_inner, cos_outer] = cosines(reader);
        flux_per_intensity(cos_inner, cos_outer)
    },
    build: |reader, _| {
        let position = reader.vector("position");
        let axis = (reader.vector("look_at") - position).try_normalize().ok_or_else(|| {
            SceneError::invalid("a spotlight must not point at its own position", reader.span("look_at"))
        })?;
        let [cos_inner, cos_outer] = cosines(reader);
        Ok(BuiltLight::Light(Arc::new(Spot {
            position,
            axis,
            intensity: reader.colour("intensity"),
            cos_outer,
            cos_inner,
            classic: given_classic(reader),
        })))
    },
};

/// The cosines of the angles at which the cone begins to fade and ends.
fn cosines(reader: &Reader) -> [f32; 2] {
    let outer = reader.number("angle");
    [reader.number("inner_angle").min(outer), outer].map(|angle| cos(angle.to_radians()))
}

/// The smooth edge emits half of the light in its range of cosines.
fn flux_per_intensity(cos_inner: f32, cos_outer: f32) -> f32 {
    TAU * (1.0 - 0.5 * (cos_inner + cos_outer))
}

const fn angle(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    let kind = ParameterKind::Number { min: 0.0, max: 180.0 };
    Parameter { name, summary, unit: "degrees", kind, default }
}

struct Spot {
    position: Vec3,
    axis: Vec3,
    intensity: Rgb,
    cos_outer: f32,
    cos_inner: f32,
    classic: Option<Rgb>,
}

impl Spot {
    /// 1 within the inner cone, 0 outside of the outer one, and smooth in between.
    fn falloff(&self, towards_light: Vec3) -> f32 {
        let cos = -towards_light.dot(self.axis);
        if cos >= self.cos_inner {
            return 1.0;
        }
        let x = ((cos - self.cos_outer) / (self.cos_inner - self.cos_outer)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

impl Light for Spot {
    fn sample_li(&self, from: Vec3, _time: f32, _u: Vec2) -> Option<LightSample> {
        let to_light = self.position - from;
        let distance2 = to_light.length_squared();
        let wi = to_light.try_normalize()?;
        let falloff = self.falloff(wi);
        (falloff > 0.0).then(|| LightSample {
            wi,
            li: self.intensity * (falloff / distance2),
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

    fn beam(&self) -> Option<Beam> {
        Beam::of_edge(self.axis, self.cos_outer)
    }

    fn extent(&self, _shutter: [f32; 2]) -> Option<LightExtent> {
        let [inner, outer] = [self.cos_inner, self.cos_outer].map(acos);
        let facing = DirectionCone { axis: self.axis, angle: inner };
        let bounds = Aabb::of_points([self.position]);
        Some(LightExtent { bounds, facing, spread: outer - inner, both_sides: false })
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        // The smooth edge emits half of the light in its range of cosines.
        self.intensity.luminance() * TAU * (1.0 - 0.5 * (self.cos_inner + self.cos_outer))
    }
}

impl LightTracing for Spot {
    fn sample_le(&self, bounds: &Aabb, _: f32, _u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let local = warp::sample_cone(u_direction, self.cos_outer);
        let direction = Frame::from_normal(self.axis).to_world(local).normalize();
        let le = self.intensity * self.falloff(-direction);
        super::point::ray(self.position, direction, le, self.emission_pdf(bounds, 1.0, direction, 1.0))
    }

    fn sample_le_aimed(&self, _: &Aabb, _time: f32, _u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let direction = warp::square_to_sphere(aim).normalize();
        let falloff = self.falloff(-direction);
        let shines = if falloff > 0.0 { 1.0 } else { 0.0 };
        super::point::ray(self.position, direction, self.intensity * falloff, shines)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_start: f32, direction: Vec3, _cos: f32) -> f32 {
        let pdf = warp::cone_pdf_solid_angle(self.cos_outer);
        if pdf.is_finite() && self.falloff(-direction) > 0.0 { pdf_start * pdf } else { 0.0 }
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for Spot {
    fn classic(&self, from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        let wi = (self.position - from).try_normalize()?;
        let strength = self.falloff(wi);
        (strength > 0.0).then_some(ClassicLight {
            wi,
            position: Some(self.position),
            strength,
            clearance: 0.0,
        })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        self.classic.unwrap_or_else(|| super::classic_colour_of(self.intensity, self.position, bounds))
    }
}

//! `ambient`: the constant light of Equation 1. Nature has no such light, and the physical integrators ignore it: use
//! an `environment` for them.

use super::{
    BuiltLight, ClassicLighting, EmissionSample, Light, LightEntry, LightSample, LightTracing, colour,
};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use bilux_math::registry::Entry;
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "ambient",
        summary: "the constant light Ia of Equation 1, in cast, whitted and cook only",
        source: "Phong 1975",
        parameters: &[colour("colour", "light that reaches every point equally", "", "0.3"), super::GROUP],
    },
    surrounds: false,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| Ok(BuiltLight::Light(Arc::new(Ambient { colour: reader.colour("colour") }))),
};

struct Ambient {
    colour: Rgb,
}

impl Light for Ambient {
    fn sample_li(&self, _from: Vec3, _time: f32, _u: Vec2) -> Option<LightSample> {
        None
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, _wi: Vec3, _hit: Option<&Surface>) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        0.0
    }
}

impl LightTracing for Ambient {
    fn sample_le(&self, _: &Aabb, _time: f32, _u_point: Vec2, _u_direction: Vec2) -> Option<EmissionSample> {
        None
    }

    fn sample_le_aimed(&self, _: &Aabb, _time: f32, _u: Vec2, _aim: Vec2) -> Option<EmissionSample> {
        None
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        0.0
    }

    fn emission_pdf(&self, _bounds: &Aabb, _pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        0.0
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for Ambient {
    fn classic(&self, _from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        None
    }

    fn classic_colour(&self, _bounds: &Aabb) -> Rgb {
        Rgb::BLACK
    }

    fn classic_ambient(&self) -> Rgb {
        self.colour
    }
}

//! `directional`: parallel light from infinitely far, as from the sun.

use super::distant::{Across, disc_pdf_area, ray};
use super::sun::Sun;
use super::{
    BuiltLight, CLASSIC, ClassicLighting, EmissionSample, GROUP, Light, LightEntry, LightSample,
    LightTracing, colour, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::messages::error::SceneError;
use crate::surface::Surface;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "directional",
        summary: "distant light: parallel rays, or those of a disc such as the sun",
        source: "",
        parameters: &[
            vector("direction", "direction in which the light travels", "-1 -1 -1"),
            colour("irradiance", "irradiance on a surface that faces it", "W/m²", "3"),
            Parameter {
                name: "diameter",
                summary: "angular diameter, which softens the edges of shadows: 0.533 for the sun, 0 for a point",
                unit: "degrees",
                kind: ParameterKind::Number { min: 0.0, max: 180.0 },
                default: "0",
            },
            CLASSIC,
            GROUP,
        ],
    },
    surrounds: false,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| {
        let towards = (-reader.vector("direction")).try_normalize().ok_or_else(|| {
            SceneError::invalid("a light's direction must not be zero", reader.span("direction"))
        })?;
        let (irradiance, classic) = (reader.colour("irradiance"), given_classic(reader));
        let diameter = reader.number("diameter").to_radians();
        // A smaller sun has no area in f32.
        if diameter > 1e-6 {
            return Ok(BuiltLight::Light(Arc::new(Sun::new(towards, diameter, irradiance, classic))));
        }
        Ok(BuiltLight::Light(Arc::new(Directional { towards, irradiance, classic })))
    },
};

struct Directional {
    towards: Vec3,
    irradiance: Rgb,
    classic: Option<Rgb>,
}

impl Light for Directional {
    fn sample_li(&self, _from: Vec3, _time: f32, _u: Vec2) -> Option<LightSample> {
        Some(LightSample {
            wi: self.towards,
            li: self.irradiance,
            point: None,
            n_light: Vec3::ZERO,
            pdf_solid_angle: 1.0,
            clearance: 0.0,
            pdf_start: None,
        })
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, _wi: Vec3, _hit: Option<&Surface>) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn power(&self, bounds: &Aabb) -> f32 {
        let radius = bounds.radius();
        self.irradiance.luminance() * PI * radius * radius
    }
}

impl LightTracing for Directional {
    fn sample_le(&self, bounds: &Aabb, _time: f32, u_point: Vec2, _u: Vec2) -> Option<EmissionSample> {
        let pdf_emission = self.emission_pdf(bounds, 1.0, -self.towards, 1.0);
        ray(bounds, Across::Anywhere(u_point), -self.towards, self.irradiance, pdf_emission, 1.0)
    }

    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, _u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        ray(bounds, Across::At(aim), -self.towards, self.irradiance, 1.0, 1.0)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        1.0
    }

    fn emission_pdf(&self, bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start * disc_pdf_area(bounds)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

impl ClassicLighting for Directional {
    fn classic(&self, _from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        Some(ClassicLight { wi: self.towards, position: None, strength: 1.0, clearance: 0.0 })
    }

    fn classic_colour(&self, _bounds: &Aabb) -> Rgb {
        self.classic.unwrap_or(self.irradiance * FRAC_1_PI)
    }
}

//! `environment`: an infinite light all around: one colour, a gradient sky, or an environment map.

use super::distant::{Across, disc_pdf_area, ray};
use super::environment_map::EnvironmentMap;
use super::{BuiltLight, ClassicLighting, EmissionSample, Light, LightEntry, LightSample, LightTracing};
use crate::classic::ClassicLight;
use crate::messages::error::SceneError;
use crate::surface::Surface;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Rgb, Vec2, Vec3, warp};
use std::f32::consts::PI;
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "environment",
        summary: "environment light: a constant colour, a vertical gradient, or an environment map",
        source: "",
        parameters: &[
            Parameter {
                name: "radiance",
                summary: "radiance from every direction; a texture is a longitude-latitude map, with its centre \
                          towards -z",
                unit: "W/(m² sr)",
                kind: ParameterKind::ColourTexture { min: 0.0, max: 1e12 },
                default: "1",
            },
            super::colour("scale", "factor on the whole light", "", "1"),
            Parameter {
                name: "rotation",
                summary: "rotation of the environment map about the y axis, to the right",
                unit: "degrees",
                kind: ParameterKind::Number { min: -360.0, max: 360.0 },
                default: "0",
            },
            sky("zenith", "radiance from straight above; -1 uses 'radiance'"),
            sky("horizon", "radiance from the horizon; -1 uses 'radiance'"),
            sky("ground", "radiance from straight below; -1 uses 'radiance'"),
            Parameter {
                name: "backdrop",
                summary: "show it to the camera in place of the environments that light the scene; it lights nothing itself",
                unit: "",
                kind: ParameterKind::Bool,
                default: "false",
            },
            super::GROUP,
        ],
    },
    surrounds: true,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, textures| {
        let (scale, backdrop) = (reader.colour("scale"), reader.bool("backdrop"));
        if let Some(index) = reader.texture("radiance") {
            let missing = || SceneError::invalid(format!("no texture {index}"), reader.span("radiance"));
            let picture = textures.get(index).ok_or_else(missing)?.clone();
            let rotation = reader.number("rotation").to_radians();
            let map = EnvironmentMap::new(picture, scale, rotation, backdrop);
            return Ok(BuiltLight::Light(Arc::new(map)));
        }
        let radiance = reader.colour("radiance");
        let part = |key| {
            let colour = reader.colour(key);
            (if colour.r < 0.0 { radiance } else { colour }) * scale
        };
        Ok(BuiltLight::Light(Arc::new(Environment {
            zenith: part("zenith"),
            horizon: part("horizon"),
            ground: part("ground"),
            backdrop,
        })))
    },
};

const fn sky(name: &'static str, summary: &'static str) -> Parameter {
    let kind = ParameterKind::Colour { min: -1.0, max: 1e12 };
    Parameter { name, summary, unit: "W/(m² sr)", kind, default: "-1" }
}

struct Environment {
    zenith: Rgb,
    horizon: Rgb,
    ground: Rgb,
    backdrop: bool,
}

impl Environment {
    /// Radiance averaged over all directions: on a sphere, height is uniform.
    fn mean(&self) -> Rgb {
        self.horizon * 0.5 + (self.zenith + self.ground) * 0.25
    }
}

impl Light for Environment {
    fn sample_li(&self, _from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        if self.backdrop {
            return None;
        }
        let wi = warp::sample_sphere(u);
        Some(LightSample {
            wi,
            li: self.le(wi),
            point: None,
            n_light: Vec3::ZERO,
            pdf_solid_angle: warp::sphere_pdf_solid_angle(),
            clearance: 0.0,
            pdf_start: None,
        })
    }

    fn li_pdf_solid_angle(&self, _from: Vec3, _wi: Vec3, hit: Option<&Surface>) -> f32 {
        if self.backdrop || hit.is_some() { 0.0 } else { warp::sphere_pdf_solid_angle() }
    }

    fn le(&self, direction: Vec3) -> Rgb {
        let pole = if direction.y < 0.0 { self.ground } else { self.zenith };
        self.horizon.lerp(pole, direction.y.abs())
    }

    fn is_backdrop(&self) -> bool {
        self.backdrop
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn power(&self, bounds: &Aabb) -> f32 {
        let radius = bounds.radius();
        if self.backdrop { 0.0 } else { self.mean().luminance() * 4.0 * PI * PI * radius * radius }
    }
}

impl LightTracing for Environment {
    fn sample_le(&self, bounds: &Aabb, _: f32, u_point: Vec2, u_direction: Vec2) -> Option<EmissionSample> {
        let towards = warp::sample_sphere(u_direction);
        let pdf_direct = warp::sphere_pdf_solid_angle();
        let pdf_emission = self.emission_pdf(bounds, pdf_direct, -towards, 1.0);
        ray(bounds, Across::Anywhere(u_point), -towards, self.le(towards), pdf_emission, pdf_direct)
    }

    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let towards = warp::sample_sphere(u);
        let pdf_direct = warp::sphere_pdf_solid_angle();
        let pdf = self.unaimed_pdf(bounds, pdf_direct, -towards, 1.0);
        ray(bounds, Across::At(aim), -towards, self.le(towards), pdf, pdf_direct)
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        if self.backdrop { 0.0 } else { pdf_start }
    }

    fn emission_pdf(&self, bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        if self.backdrop { 0.0 } else { pdf_start * disc_pdf_area(bounds) }
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

impl ClassicLighting for Environment {
    fn classic(&self, _from: Vec3, _time: f32, _u: Vec2, _extent: f32) -> Option<ClassicLight> {
        None
    }

    fn classic_colour(&self, _bounds: &Aabb) -> Rgb {
        Rgb::BLACK
    }

    fn classic_ambient(&self) -> Rgb {
        if self.backdrop { Rgb::BLACK } else { self.mean() }
    }
}

//! `sphere`: a visible sphere that emits light outwards, round at every size, and casts soft shadows.
//!
//! It is sampled by solid angle, uniformly over its bounding cone, so that every sample has the same weight near it and
//! far away. [Shirley 1996, 4.2] The density of a point on it therefore depends on the receiver.

use super::{
    BuiltLight, CLASSIC, ClassicLighting, EmissionSample, GROUP, Light, LightEntry, LightSample,
    LightTracing, colour, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::error::SceneError;
use crate::spheres::PlacedSphere;
use crate::surface::Surface;
use bilux_accel::Primitive;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Frame, Rgb, Vec2, Vec3, warp};
use std::f32::consts::PI;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "sphere",
        summary: "spherical area light, visible to the camera",
        source: "Shirley 1996",
        parameters: &[
            vector("position", "centre", "0 5 0"),
            Parameter {
                name: "radius",
                summary: "radius; above 0",
                unit: "m",
                kind: ParameterKind::Number { min: 0.0, max: 1e12 },
                default: "0.5",
            },
            colour("radiance", "emitted radiance; or give 'intensity'", "W/(m² sr)", "0"),
            colour(
                "intensity",
                "radiance times the area of its disc, which stays the same when the sphere shrinks",
                "W/sr",
                "0",
            ),
            CLASSIC,
            GROUP,
        ],
    },
    build: |reader, _| {
        let radius = reader.number("radius");
        // If the square of the radius is out of range, the sphere is too small for any ray.
        if !(radius * radius).is_normal() {
            let message = "the radius of a sphere light must be above 0";
            return Err(SceneError::invalid(message, reader.span("radius")));
        }
        let emission = if reader.is_given("radiance") {
            reader.colour("radiance")
        } else {
            reader.colour("intensity") / (PI * radius * radius)
        };
        if emission == Rgb::BLACK {
            let message = "a sphere light needs 'radiance' or 'intensity'";
            return Err(SceneError::invalid(message, reader.span("radiance")));
        }
        let centre = reader.vector("position");
        Ok(BuiltLight::Sphere { centre, radius, emission, classic: given_classic(reader) })
    },
};

/// A sphere that emits light outwards.
pub struct SphereLight {
    sphere: PlacedSphere,
    /// As in a hit.
    primitive: Primitive,
    radiance: Rgb,
    classic: Option<Rgb>,
}

/// The bounding cone of a sphere, as seen from outside.
struct Cone {
    /// Unit, towards the centre.
    axis: Vec3,
    /// Square of the sine of the angle between the axis and the rim.
    sin2_max: f32,
    /// 1 minus the cosine of that angle.
    height: f32,
}

impl SphereLight {
    /// A sphere of the scene as a light.
    pub fn new(
        sphere: PlacedSphere,
        primitive: Primitive,
        radiance: Rgb,
        classic: Option<Rgb>,
    ) -> SphereLight {
        SphereLight { sphere, primitive, radiance, classic }
    }

    /// The density of a uniform point on the whole surface.
    fn uniform_pdf_area(&self) -> f32 {
        1.0 / (4.0 * PI * self.sphere.radius * self.sphere.radius)
    }

    /// A ray from the point whose normal is `n_light`, emitted with the density `pdf` of its cosine.
    fn ray(&self, n_light: Vec3, direction: Vec3, pdf: impl Fn(f32) -> f32) -> Option<EmissionSample> {
        let (p, p_error) = self.sphere.point(n_light.as_dvec3());
        let cos = n_light.dot(direction);
        let pdf_emission = pdf(cos);
        (cos > 0.0 && pdf_emission.is_finite() && pdf_emission > 0.0).then_some(EmissionSample {
            p,
            p_error,
            n_light,
            direction,
            le: self.radiance,
            pdf_emission,
            pdf_direct: self.uniform_pdf_area(),
            primitive: self.primitive,
        })
    }

    /// The bounding cone; `None` from within, and from where it is too small for an f32.
    fn cone(&self, from: Vec3) -> Option<Cone> {
        // In f64: close to the surface, the result depends on how little the distance to the centre exceeds the radius.
        let to_centre = self.sphere.centre.as_dvec3() - from.as_dvec3();
        let radius2 = f64::from(self.sphere.radius) * f64::from(self.sphere.radius);
        let (axis, distance2) = (to_centre.try_normalize()?, to_centre.length_squared());
        let sin2_max = radius2 / distance2;
        let height = (sin2_max / (1.0 + (1.0 - sin2_max).max(0.0).sqrt())) as f32;
        let is_seen = distance2 > radius2 && height.is_normal();
        is_seen.then(|| Cone { axis: axis.as_vec3(), sin2_max: sin2_max as f32, height })
    }

    /// See [`LightSample::clearance`]: the point is off the sphere by at most `error`, and a ray towards it at this
    /// cosine hits the sphere no earlier than where it leaves that depth. At most half of the distance.
    fn clearance(&self, from: Vec3, point: Vec3, cos: f32) -> f32 {
        let distance = point.distance(from);
        let size = distance + from.abs().max_element().max(point.abs().max_element());
        let (error, radius) = (8.0 * f32::EPSILON * size, self.sphere.radius);
        let before =
            2.0 * error * radius / (radius * cos + (radius * (radius * cos * cos + 2.0 * error)).sqrt());
        ((before + error) / distance).min(0.5)
    }
}

impl Light for SphereLight {
    fn sample_li(&self, from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        let cone = self.cone(from)?;
        let wi = warp::sample_cap(u, cone.height);
        // The angles at the receiver, at the point on the light and, between them, at its centre. [pbrt 2023, 6.2.4]
        let (sin_theta, cos_theta) = ((wi.x * wi.x + wi.y * wi.y).sqrt(), wi.z);
        let sin2_light = (sin_theta * sin_theta / cone.sin2_max).min(1.0);
        let (sin_light, cos_light) = (sin2_light.sqrt(), (1.0 - sin2_light).sqrt());
        let cos_middle = cos_light * cos_theta + sin_light * sin_theta;
        let sin_middle = sin_light * cos_theta - cos_light * sin_theta;
        let aside = Vec2::new(wi.x, wi.y).normalize_or_zero() * sin_middle;
        let frame = Frame::from_normal(cone.axis);
        let (wi, n) = (frame.to_world(wi), frame.to_world(aside.extend(-cos_middle)));
        let (wi, n_light) = (wi.normalize(), n.normalize());
        let (point, _) = self.sphere.point(n_light.as_dvec3());
        (-n_light.dot(wi) > 0.0).then(|| LightSample {
            wi,
            li: self.radiance,
            point: Some(point),
            n_light,
            pdf_solid_angle: warp::cap_pdf_solid_angle(cone.height),
            clearance: self.clearance(from, point, cos_light),
        })
    }

    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        let is_hit = hit.is_some_and(|hit| hit.primitive == self.primitive && hit.n_geom.dot(wi) < 0.0);
        let cone = if is_hit { self.cone(from) } else { None };
        cone.map_or(0.0, |cone| warp::cap_pdf_solid_angle(cone.height))
    }

    fn pdf_area(&self, from: Vec3, hit: &Surface) -> f32 {
        let to_light = hit.p - from;
        let Some(wi) = to_light.try_normalize() else { return 0.0 };
        self.li_pdf_solid_angle(from, wi, Some(hit)) * (-hit.n_geom.dot(wi) / to_light.length_squared())
    }

    fn emits_towards(&self, hit: &Surface, wo: Vec3) -> bool {
        hit.n_geom.dot(wo) > 0.0
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        self.radiance.luminance() * PI / self.uniform_pdf_area()
    }
}

impl LightTracing for SphereLight {
    fn direct_pdf(&self, sample: &EmissionSample, from: Vec3) -> f32 {
        let distance2 = from.distance_squared(sample.p);
        let pdf = |cone: Cone| warp::cap_pdf_solid_angle(cone.height) * (sample.cos() / distance2);
        self.cone(from).map_or(0.0, pdf)
    }

    fn sample_le(
        &self,
        bounds: &Aabb,
        _time: f32,
        u_point: Vec2,
        u_direction: Vec2,
    ) -> Option<EmissionSample> {
        let n_light = warp::sample_sphere(u_point).normalize();
        let local = warp::sample_cosine_hemisphere(u_direction);
        let direction = Frame::from_normal(n_light).to_world(local).normalize();
        let pdf = |cos| self.emission_pdf(bounds, self.uniform_pdf_area(), direction, cos);
        self.ray(n_light, direction, pdf)
    }

    /// Starts at a point of the disc that the sphere presents to the ray's direction.
    fn sample_le_aimed(&self, bounds: &Aabb, _time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let direction = warp::square_to_sphere(aim).normalize();
        let n_light = Frame::from_normal(direction).to_world(warp::sample_cosine_hemisphere(u)).normalize();
        self.ray(n_light, direction, |cos| self.unaimed_pdf(bounds, 0.0, direction, cos))
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_direct: f32, _direction: Vec3, cos: f32) -> f32 {
        warp::cosine_hemisphere_pdf_solid_angle(cos) / (self.sphere.radius * self.sphere.radius)
    }

    /// Rays start uniformly on the whole surface, whatever the receiver.
    fn emission_pdf(&self, _bounds: &Aabb, _pdf_direct: f32, _direction: Vec3, cos: f32) -> f32 {
        self.uniform_pdf_area() * warp::cosine_hemisphere_pdf_solid_angle(cos)
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for SphereLight {
    fn classic(&self, from: Vec3, _time: f32, u: Vec2, extent: f32) -> Option<ClassicLight> {
        let radius = self.sphere.radius;
        let within = warp::sample_sphere(u) * (radius * extent);
        let position = self.sphere.centre + within;
        let wi = (position - from).try_normalize()?;
        // Only up to the surface: the rest of the segment is inside the light, where nothing casts shadows.
        let along = within.dot(wi);
        let inside = along + (along * along + (radius * radius - within.length_squared()).max(0.0)).sqrt();
        let margin = self.clearance(from, position, 1.0);
        let clearance = (inside / position.distance(from) + 2.0 * margin).min(0.5);
        Some(ClassicLight { wi, position: Some(position), strength: 1.0, clearance })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        let disc = PI * self.sphere.radius * self.sphere.radius;
        let intensity = self.radiance * disc;
        self.classic.unwrap_or_else(|| super::classic_colour_of(intensity, self.sphere.centre, bounds))
    }
}

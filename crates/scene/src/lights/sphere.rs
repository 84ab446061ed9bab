//! `sphere`: a visible sphere that emits light outwards, round at every size, and casts soft shadows.
//!
//! It is sampled by solid angle, uniformly over its bounding cone, so that every sample has the same weight near it and
//! far away. [Shirley 1996, 4.2] The density of a point on it therefore depends on the receiver.

use super::{
    BuiltLight, CLASSIC, ClassicLighting, EmissionSample, GROUP, Light, LightEntry, LightExtent, LightSample,
    LightTracing, colour, given_classic, vector,
};
use crate::classic::ClassicLight;
use crate::geometry::spheres::PlacedSphere;
use crate::messages::error::SceneError;
use crate::surface::Surface;
use bilux_accel::{Primitive, Ray};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, DVec3, Frame, Rgb, Vec2, Vec3, warp};
use std::f32::consts::{PI, TAU};

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
    surrounds: false,
    flux_per_intensity: super::ALL_AROUND,
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
    axis: DVec3,
    /// Square of the sine of the angle between the axis and the rim.
    sin2_max: f64,
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
        let (p, p_error) = self.sphere.point(n_light.as_dvec3().normalize());
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
        is_seen.then_some(Cone { axis, sin2_max, height })
    }

    /// See [`LightSample::clearance`]: the point is off the sphere by at most `error`, and a ray towards it at this
    /// cosine hits the sphere no earlier than where it leaves that depth. At most half of the distance.
    ///
    /// The point is rounded to an f32, and so is the ray towards it. Whatever came before is in f64: an error relative to the
    /// radius could be as large as the distance from a point close to the sphere.
    fn clearance(&self, from: Vec3, point: Vec3, cos: f32) -> f32 {
        let distance = point.distance(from);
        let size = distance + from.abs().max_element().max(point.abs().max_element());
        let (error, radius) = (8.0 * f32::EPSILON * size, self.sphere.radius);
        let before =
            2.0 * error * radius / (radius * cos + (radius * (radius * cos * cos + 2.0 * error)).sqrt());
        ((before + error) / distance).min(0.5)
    }
}

impl Cone {
    /// A direction, uniform over the cone, and the normal of the sphere where it is hit first, both unit vectors; and the cosine
    /// between them.
    ///
    /// In f64: close to the sphere, a small angle at its centre is a large one at the receiver.
    fn sample(&self, u: Vec2) -> (DVec3, DVec3, f64) {
        let below = f64::from(u.x) * f64::from(self.height);
        let (sin2_theta, cos_theta) = (below * (2.0 - below), 1.0 - below);
        // The angles at the receiver, at the point on the light and, between them, at its centre. [pbrt 2023, 6.2.4]
        let (sin_theta, sin2_light) = (sin2_theta.max(0.0).sqrt(), (sin2_theta / self.sin2_max).min(1.0));
        let (sin_light, cos_light) = (sin2_light.sqrt(), (1.0 - sin2_light).sqrt());
        let cos_middle = cos_light * cos_theta + sin_light * sin_theta;
        let sin_middle = sin_light * cos_theta - cos_light * sin_theta;
        let (sin, cos) = sin_cos(TAU * u.y);
        let (right, up) = self.axis.any_orthonormal_pair();
        let aside = right * f64::from(cos) + up * f64::from(sin);
        let wi = self.axis * cos_theta + aside * sin_theta;
        let n = aside * sin_middle - self.axis * cos_middle;
        (wi.normalize(), n.normalize(), cos_light)
    }
}

impl Light for SphereLight {
    fn sample_li(&self, from: Vec3, _time: f32, u: Vec2) -> Option<LightSample> {
        let cone = self.cone(from)?;
        let (wi, n, cos_light) = cone.sample(u);
        let (wi, n_light, point) = (wi.as_vec3(), n.as_vec3(), self.sphere.point(n).0);
        (-n_light.dot(wi) > 0.0).then(|| LightSample {
            wi,
            li: self.radiance,
            point: Some(point),
            n_light,
            pdf_solid_angle: warp::cap_pdf_solid_angle(cone.height),
            clearance: self.clearance(from, point, cos_light as f32),
            pdf_start: None,
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

    fn middle_and_reach(&self) -> Option<(Vec3, f32)> {
        Some((self.sphere.centre, self.sphere.radius))
    }

    fn extent(&self, _shutter: [f32; 2]) -> Option<LightExtent> {
        let PlacedSphere { centre, radius, .. } = self.sphere;
        Some(LightExtent::all_around(Aabb::of_points([centre]).expanded(radius)))
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

    fn unaimed_pdf(&self, _bounds: &Aabb, _pdf_start: f32, _direction: Vec3, cos: f32) -> f32 {
        warp::cosine_hemisphere_pdf_solid_angle(cos) / (self.sphere.radius * self.sphere.radius)
    }

    /// Rays start uniformly on the whole surface, whatever the receiver.
    fn emission_pdf(&self, _bounds: &Aabb, _pdf_start: f32, _direction: Vec3, cos: f32) -> f32 {
        self.uniform_pdf_area() * warp::cosine_hemisphere_pdf_solid_angle(cos)
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for SphereLight {
    fn classic(&self, from: Vec3, _time: f32, u: Vec2, extent: f32) -> Option<ClassicLight> {
        let within = warp::sample_sphere(u) * (self.sphere.radius * extent);
        let position = self.sphere.centre + within;
        let wi = (position - from).try_normalize()?;
        // Only up to the surface: the rest of the segment is inside the light, where nothing casts shadows.
        let (origin, along) = (from.as_dvec3(), (position - from).as_dvec3());
        let chord = self.sphere.chord(&Ray::new(from.to_array(), (position - from).to_array()));
        let enter = chord.map_or(1.0, |[enter, _]| enter.clamp(0.0, 1.0));
        let point = origin + along * enter;
        let n = (point - self.sphere.centre.as_dvec3()).normalize_or_zero();
        let cos = -n.dot(along.normalize_or_zero()).min(0.0);
        let before = self.clearance(from, point.as_vec3(), cos as f32);
        let clearance = (1.0 - enter * f64::from(1.0 - before)) as f32;
        Some(ClassicLight { wi, position: Some(position), strength: 1.0, clearance })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        let disc = PI * self.sphere.radius * self.sphere.radius;
        let intensity = self.radiance * disc;
        self.classic.unwrap_or_else(|| super::classic_colour_of(intensity, self.sphere.centre, bounds))
    }
}

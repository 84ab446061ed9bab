//! Light sources. Each kind has its own file; the table is [`LIGHTS`].
//!
//! Every light has two descriptions: radiometric, for the physical integrators, and a [`ClassicLight`] without units or
//! falloff, for Equations 1 and 2. The colour of the latter is the light's irradiance at the centre of the scene, over
//! π, so that a diffuse surface there looks the same in both; the parameter `classic` overrides it.

mod ambient;
mod cumulative;
mod directional;
mod distant;
mod environment;
mod environment_map;
mod light_triangle;
mod mesh_light;
mod point;
mod rect;
mod sky;
mod sphere;
mod spot;
mod sun;

pub use light_triangle::{LightTriangle, TriangleSample, barycentric};
pub use mesh_light::{MeshLight, Picture};
pub use sphere::SphereLight;

use crate::classic::ClassicLight;
use crate::error::SceneError;
pub use crate::light_sample::LightSample;
use crate::light_sample::cos_at;
use crate::mesh::Mesh;
use crate::parameters::{Reader, Spec};
use crate::surface::Surface;
use crate::surface::{leaving, offset_origin};
use crate::texture::Texture;
use bilux_accel::{Primitive, Ray};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Rgb, Vec2, Vec3, warp};
use std::sync::Arc;

/// A sample of emitted light, as a ray into the scene. [Georgiev 2012]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSample {
    /// Origin of the ray: on the light, or, for an infinite light, on a disc perpendicular to `direction`, just outside
    /// of the scene's bounding sphere.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the light there, on the side of the ray; zero if it has none.
    pub n_light: Vec3,
    /// Unit direction of the ray.
    pub direction: Vec3,
    /// Radiance along the ray; for a point light the intensity in that direction, in W/sr; for a directional light the
    /// irradiance perpendicular to it, in W/m².
    pub le: Rgb,
    /// The emission density: that of the origin over area times that of the direction over solid angle, 1/(m² sr). A
    /// fixed origin or direction counts as 1.
    pub pdf_emission: f32,
    /// The direct density, with which [`Light::sample_li`] samples this origin, over area; for an infinite light, this
    /// direction, over solid angle. 1 for delta lights. If it depends on the receiver, this is the mean over the
    /// light's area, and [`Light::direct_pdf`] is exact.
    pub pdf_direct: f32,
    /// The triangle or sphere that it leaves; [`Primitive::NONE`] if there is none.
    pub primitive: Primitive,
}

impl EmissionSample {
    /// Cosine between the ray and the light's normal; 1 if there is no normal.
    pub fn cos(&self) -> f32 {
        cos_at(self.n_light, self.direction)
    }

    /// The ray, at a time in seconds. It cannot hit the triangle, or the point of a sphere, that it leaves.
    pub fn spawn(&self, time: f32) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_light, self.direction);
        leaving(origin, self.direction, self.primitive, time)
    }
}

/// The sides of its triangles from which a surface emits light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both sides.
    #[default]
    Both,
    /// The side from which the corners of a triangle are counter-clockwise.
    Front,
}

impl Sides {
    /// Their names in scene files.
    pub(crate) const NAMES: &'static [&'static str] = &["both", "front"];

    /// The name, one of [`Sides::NAMES`].
    pub(crate) fn name(self) -> &'static str {
        Sides::NAMES[self as usize]
    }

    /// The sides with one of [`Sides::NAMES`].
    pub(crate) fn from_name(name: &str) -> Sides {
        if name == "front" { Sides::Front } else { Sides::Both }
    }

    /// The number of sides.
    pub(crate) fn count(self) -> f32 {
        match self {
            Sides::Both => 2.0,
            Sides::Front => 1.0,
        }
    }
}

/// A light source.
pub trait Light: Send + Sync {
    /// Samples a direction from which light arrives at `from`; `None` if none does.
    fn sample_li(&self, from: Vec3, time: f32, u: Vec2) -> Option<LightSample>;

    /// The mesh light that this one is: integrators that sample many points at once sample its triangles themselves.
    #[doc(hidden)]
    fn as_mesh(&self) -> Option<&MeshLight> {
        None
    }

    /// The density of [`Light::sample_li`] for the direction `wi`; zero for delta lights.
    ///
    /// `hit` is what a ray along `wi` hits; `None` means that it hits nothing, and the light is infinite.
    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32;

    /// False when [`Light::sample_li`] leaves light to BSDF sampling, in directions where its density is zero.
    ///
    /// [`Light::sample_le`] emits that light nevertheless. [Karlík 2019]
    fn samples_all_light(&self) -> bool {
        true
    }

    /// The density over area with which [`Light::sample_li`] at `from` samples a point of this light.
    ///
    /// Zero for a point that is not on it, and for lights without a surface.
    fn pdf_area(&self, _from: Vec3, _hit: &Surface) -> f32 {
        0.0
    }

    /// Samples a ray of light into a scene within `bounds`, at a time in seconds.
    ///
    /// `None` where no light leaves, or where the scene has no size that an infinite light could aim at.
    fn sample_le(&self, bounds: &Aabb, time: f32, u_point: Vec2, u_direction: Vec2)
    -> Option<EmissionSample>;

    /// The direct density of the origin of a ray that arrives at `from`.
    ///
    /// It is [`EmissionSample::pdf_direct`], unless that depends on the receiver, as for a sphere, which is sampled by
    /// the solid angle that it subtends.
    fn direct_pdf(&self, sample: &EmissionSample, _from: Vec3) -> f32 {
        sample.pdf_direct
    }

    /// The density ([`EmissionSample::pdf_emission`]) with which [`Light::sample_le`] emits a ray along `direction`.
    ///
    /// `direction` is a unit vector away from the light. `pdf_direct` is the direct density of the ray's origin
    /// ([`EmissionSample::pdf_direct`], whose mean suffices if it depends on the receiver). `cos` is
    /// [`EmissionSample::cos`].
    fn emission_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32;

    /// Like [`Light::sample_le`], but aimed ([`Light::aim`]): `u` picks the rest, the point on a finite light or the
    /// direction of an infinite one. The sample's `pdf_emission` is the density of the rest alone.
    fn sample_le_aimed(&self, bounds: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample>;

    /// The density of the rest that [`Light::sample_le_aimed`] picks; otherwise like [`Light::emission_pdf`].
    fn unaimed_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32;

    /// The aim of a ray of light through `p` along `direction`, as a point on the unit square.
    ///
    /// For a finite light it is the direction, by [`warp::sphere_to_square`]. For an infinite one it is the point where
    /// the ray crosses a perpendicular square around the scene; a ray that misses the square has an aim outside of
    /// 0..=1.
    fn aim(&self, bounds: &Aabb, p: Vec3, direction: Vec3) -> Vec2 {
        if self.is_infinite() {
            distant::place_across(bounds, p, direction)
        } else {
            warp::sphere_to_square(direction)
        }
    }

    /// The density of an aim that is uniform over the square: over solid angle, or over area for an infinite light.
    fn aim_pdf(&self, bounds: &Aabb) -> f32 {
        if self.is_infinite() { distant::square_pdf_area(bounds) } else { warp::sphere_pdf_solid_angle() }
    }

    /// True for an infinite light, whose direct density is one of directions.
    fn is_infinite(&self) -> bool;

    /// False where a point of its surface emits no light towards `wo`, because the light is one-sided.
    fn emits_towards(&self, _hit: &Surface, _wo: Vec3) -> bool {
        true
    }

    /// Radiance from infinity, along a direction away from the scene.
    fn le(&self, _direction: Vec3) -> Rgb {
        Rgb::BLACK
    }

    /// True when only the camera sees it, and it lights nothing ([`crate::Scene::shows`]).
    fn is_backdrop(&self) -> bool {
        false
    }

    /// True for a delta light, which no ray can hit by chance.
    fn is_delta(&self) -> bool;

    /// Approximately the luminance of the power that it emits into the scene, in W, for choosing among lights.
    fn power(&self, bounds: &Aabb) -> f32;

    /// The light under Equations 1 and 2, from its centre offset by `extent` (0..=1) of its size towards the point that
    /// `u` picks; `None` where it does not shine.
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight>;

    /// Its colour under Equations 1 and 2, for a scene within these bounds.
    fn classic_colour(&self, bounds: &Aabb) -> Rgb;

    /// Its contribution to the ambient light of Equations 1 and 2.
    fn classic_ambient(&self) -> Rgb {
        Rgb::BLACK
    }
}

/// The result of building a row.
pub enum BuiltLight {
    /// A light without a surface.
    Light(Arc<dyn Light>),
    /// Several lights without a surface, which share the name of one row.
    Several(Vec<Arc<dyn Light>>),
    /// An emissive surface; the builder turns it into an object and its [`MeshLight`].
    Surface {
        /// The surface, in world space.
        mesh: Arc<Mesh>,
        /// Radiance.
        emission: Rgb,
        /// The emitting sides.
        sides: Sides,
        /// Colour under Equations 1 and 2, if the user gave one.
        classic: Option<Rgb>,
    },
    /// An emissive sphere; the builder adds it to the scene's spheres and makes its [`SphereLight`].
    Sphere {
        /// Its centre, in world space.
        centre: Vec3,
        /// Positive.
        radius: f32,
        /// Outward radiance.
        emission: Rgb,
        /// Colour under Equations 1 and 2, if the user gave one.
        classic: Option<Rgb>,
    },
}

/// A row of [`LIGHTS`].
#[derive(Clone, Copy, Debug)]
pub struct LightEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from its parameters and the scene's textures.
    pub build: fn(&Reader, &[Arc<Texture>]) -> Result<BuiltLight, SceneError>,
}

/// All lights.
pub const LIGHTS: &[LightEntry] = &[
    point::ENTRY,
    directional::ENTRY,
    spot::ENTRY,
    rect::ENTRY,
    sphere::ENTRY,
    environment::ENTRY,
    sky::ENTRY,
    ambient::ENTRY,
];

/// Makes the light that a spec describes.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn build(spec: &Spec, textures: &[Arc<Texture>]) -> Result<BuiltLight, SceneError> {
    let names = LIGHTS.iter().map(|row| row.entry.name);
    let row = LIGHTS
        .iter()
        .find(|row| row.entry.name == spec.kind)
        .ok_or_else(|| SceneError::unknown("light", &spec.kind, names, &spec.span))?;
    (row.build)(&Reader::new(spec, &row.entry)?, textures)
}

/// The colour for Equations 1 and 2 of a light that emits `intensity` (W/sr) from `position`.
fn classic_colour_of(intensity: Rgb, position: Vec3, bounds: &Aabb) -> Rgb {
    let nearest = bounds.radius().max(f32::MIN_POSITIVE) * 0.25;
    let distance = if bounds.is_empty() { 1.0 } else { (position - bounds.centre()).length().max(nearest) };
    intensity / (distance * distance * std::f32::consts::PI)
}

const CLASSIC: Parameter = Parameter {
    name: "classic",
    summary: "colour in cast, whitted and cook; -1 uses the irradiance at the centre of the scene, divided by π",
    unit: "",
    kind: ParameterKind::Colour { min: -1.0, max: 1e6 },
    default: "-1",
};

/// The parameter [`CLASSIC`], if it is given.
fn given_classic(reader: &Reader) -> Option<Rgb> {
    let colour = reader.colour("classic");
    (colour.r >= 0.0 && colour.g >= 0.0 && colour.b >= 0.0).then_some(colour)
}

const fn colour(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Colour { min: 0.0, max: 1e12 }, default }
}

const fn vector(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "m", kind: ParameterKind::Vector, default }
}

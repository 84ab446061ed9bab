//! Where light comes from. One kind a file; the table is [`LIGHTS`].
//!
//! Every light answers twice: as radiometry, for the physical integrators, and as a [`ClassicLight`] without
//! units or falloff, for Equations 1 and 2. The colour of the latter is the irradiance that the light gives at
//! the middle of the scene, over π, so that a matt surface there looks alike in both worlds; the parameter
//! `classic` overrides it.

mod ambient;
mod directional;
mod distant;
mod environment;
mod environment_map;
mod mesh_light;
mod point;
mod rect;
mod sky;
mod sphere;
mod spot;
mod sun;

pub use mesh_light::{MeshLight, Picture};
pub use sphere::SphereLight;

use crate::classic::ClassicLight;
use crate::error::SceneError;
use crate::mesh::Mesh;
use crate::parameters::{Reader, Spec};
use crate::surface::Surface;
use crate::surface::{leaving, offset_origin};
use crate::texture::Texture;
use bilux_accel::{Primitive, Ray};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Rgb, Vec2, Vec3, warp};
use std::sync::Arc;

/// Light that arrives at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Incident radiance if nothing is between; for a delta light, irradiance on a surface facing it.
    pub li: Rgb,
    /// Where on the light; `None` when infinitely far.
    pub point: Option<Vec3>,
    /// Normal of the light at that point, towards the receiver; zero where it has none.
    pub n_light: Vec3,
    /// Density of the direction in solid angle; 1 for a delta light.
    pub pdf_solid_angle: f32,
    /// How far before `point`, as a fraction of the distance, a ray towards it may already meet the light's
    /// own surface through rounding; 0 for a light without a surface.
    pub clearance: f32,
}

/// Light that leaves a light, as a ray into the scene. [Georgiev 2012]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSample {
    /// Where it starts: on the light; for a light infinitely far, on a disc across `direction`, just outside of the
    /// sphere around the scene.
    pub p: Vec3,
    /// Bound on the rounding error of `p`, per axis.
    pub p_error: Vec3,
    /// Unit normal of the light there, on the side that the ray goes to; zero where it has none.
    pub n_light: Vec3,
    /// Unit direction in which the light goes.
    pub direction: Vec3,
    /// Radiance along the ray; of a light at a point the intensity in that direction, in W/sr; of a directional light
    /// the irradiance across it, in W/m².
    pub le: Rgb,
    /// The emission density: of the start over area times that of the direction over solid angle, 1/(m² sr). What
    /// is fixed counts 1.
    pub pdf_emission: f32,
    /// The direct density: with which [`Light::sample_li`] finds this start, over area; of a light infinitely far,
    /// this direction, over solid angle. 1 for delta lights. Where it depends on who asks, the mean over the light's area;
    /// [`Light::direct_pdf`] knows more.
    pub pdf_direct: f32,
    /// The triangle or sphere that it leaves; [`Primitive::NONE`] where there is none.
    pub primitive: Primitive,
}

impl LightSample {
    /// Cosine between the direction and the light's normal; 1 where there is no normal.
    pub fn cos(&self) -> f32 {
        cos_at(self.n_light, self.wi)
    }
}

fn cos_at(n_light: Vec3, direction: Vec3) -> f32 {
    if n_light == Vec3::ZERO { 1.0 } else { n_light.dot(direction).abs() }
}

impl EmissionSample {
    /// Cosine between the ray and the light's normal; 1 where there is no normal.
    pub fn cos(&self) -> f32 {
        cos_at(self.n_light, self.direction)
    }

    /// The ray, at a time in seconds. It cannot meet the triangle, or the place of a sphere, that it leaves.
    pub fn spawn(&self, time: f32) -> Ray {
        let origin = offset_origin(self.p, self.p_error, self.n_light, self.direction);
        leaving(origin, self.direction, self.primitive, time)
    }
}

/// From which sides of its triangles a surface gives light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both.
    #[default]
    Both,
    /// That from which their corners are seen counter-clockwise.
    Front,
}

impl Sides {
    /// What scene files call them.
    pub(crate) const NAMES: &'static [&'static str] = &["both", "front"];

    /// One of [`Sides::NAMES`].
    pub(crate) fn name(self) -> &'static str {
        Sides::NAMES[self as usize]
    }

    /// By one of [`Sides::NAMES`].
    pub(crate) fn named(name: &str) -> Sides {
        if name == "front" { Sides::Front } else { Sides::Both }
    }

    /// How many there are.
    pub(crate) fn count(self) -> f32 {
        match self {
            Sides::Both => 2.0,
            Sides::Front => 1.0,
        }
    }
}

/// Something that gives light.
pub trait Light: Send + Sync {
    /// A direction from which light arrives at `from`; `None` where none does.
    fn sample_li(&self, from: Vec3, time: f32, u: Vec2) -> Option<LightSample>;

    /// Density of [`Light::sample_li`] for the direction `wi`, in which `hit` was met (`None`: nothing was, and
    /// the light is infinitely far). Zero for delta lights.
    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32;

    /// False when [`Light::sample_li`] leaves out light that scattering has to find: what comes from where its density is
    /// zero. [`Light::sample_le`] sends it all the same. [Karlík 2019]
    fn finds_all(&self) -> bool {
        true
    }

    /// Density over area with which [`Light::sample_li`], asked at `from`, finds a point of this light; zero for a point
    /// that is not on it, and for lights without a surface.
    fn pdf_area(&self, _from: Vec3, _hit: &Surface) -> f32 {
        0.0
    }

    /// A ray of light into a scene within `bounds`, at a time in seconds; `None` where none leaves, or where the
    /// scene has no size that a light infinitely far could aim at.
    fn sample_le(&self, bounds: &Aabb, time: f32, u_point: Vec2, u_direction: Vec2)
    -> Option<EmissionSample>;

    /// The direct density of the start of a ray that arrives at `from`: [`EmissionSample::pdf_direct`], unless it depends
    /// on who asks, as that of a sphere does, which is sampled by the solid angle under which it is seen.
    fn direct_pdf(&self, sample: &EmissionSample, _from: Vec3) -> f32 {
        sample.pdf_direct
    }

    /// The density ([`EmissionSample::pdf_emission`]) with which [`Light::sample_le`] sends a ray along `direction`,
    /// a unit vector away from the light, from where direct sampling finds the light with density `pdf_direct`
    /// ([`EmissionSample::pdf_direct`], whose mean does where that depends on who asks). `cos` is [`EmissionSample::cos`].
    fn emission_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32;

    /// As [`Light::sample_le`], but aimed ([`Light::aim`]): `u` picks what is left, the point on a light nearby and the
    /// direction of one infinitely far. The sample's `pdf_emission` is the density of that alone.
    fn sample_le_aimed(&self, bounds: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample>;

    /// The density of what [`Light::sample_le_aimed`] picks besides; all else as in [`Light::emission_pdf`].
    fn unaimed_pdf(&self, bounds: &Aabb, pdf_direct: f32, direction: Vec3, cos: f32) -> f32;

    /// What a ray of light through `p` along `direction` is aimed at, as a place on the unit square: of a light nearby the
    /// direction, by [`warp::sphere_to_square`]; of one infinitely far the point where it passes a square across it,
    /// around the scene, and without that square what is not within 0..=1.
    fn aim(&self, bounds: &Aabb, p: Vec3, direction: Vec3) -> Vec2 {
        if self.is_infinite() {
            distant::place_across(bounds, p, direction)
        } else {
            warp::sphere_to_square(direction)
        }
    }

    /// The density of an aim that is uniform over the square: over solid angle, or over area for a light infinitely far.
    fn aim_pdf(&self, bounds: &Aabb) -> f32 {
        if self.is_infinite() { distant::square_pdf_area(bounds) } else { warp::sphere_pdf_solid_angle() }
    }

    /// True when it is infinitely far, so that its direct density is one of directions.
    fn is_infinite(&self) -> bool;

    /// False where a point of its surface gives no light towards `wo`, since it does so on one side only.
    fn shines(&self, _hit: &Surface, _wo: Vec3) -> bool {
        true
    }

    /// Radiance from infinity in a direction away from the scene.
    fn le(&self, _direction: Vec3) -> Rgb {
        Rgb::BLACK
    }

    /// True when it is only to be seen by the camera, and lights nothing ([`crate::Scene::shows`]).
    fn is_backdrop(&self) -> bool {
        false
    }

    /// True when it has no extent, so that no ray can hit it by chance.
    fn is_delta(&self) -> bool;

    /// About how much it sends into the scene, for choosing among lights: luminance of the power, in W.
    fn power(&self, bounds: &Aabb) -> f32;

    /// The light under Equations 1 and 2, from its middle moved by `extent` (0..=1) of its size towards the
    /// point that `u` picks; `None` where it does not shine.
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight>;

    /// Its colour under Equations 1 and 2, for a scene in these bounds.
    fn classic_colour(&self, bounds: &Aabb) -> Rgb;

    /// What it adds to the ambient light of Equations 1 and 2.
    fn classic_ambient(&self) -> Rgb {
        Rgb::BLACK
    }
}

/// What a row makes.
pub enum BuiltLight {
    /// A light without a surface.
    Light(Arc<dyn Light>),
    /// Several such, which take their name from one row.
    Several(Vec<Arc<dyn Light>>),
    /// A surface that gives light; the builder makes it an object and its [`MeshLight`].
    Surface {
        /// The surface, in world space.
        mesh: Arc<Mesh>,
        /// Radiance.
        emission: Rgb,
        /// On which sides.
        sides: Sides,
        /// Colour under Equations 1 and 2 where the user gave one.
        classic: Option<Rgb>,
    },
    /// A sphere that gives light; the builder adds it to the scene's spheres and makes its [`SphereLight`].
    Sphere {
        /// Its middle, in world space.
        centre: Vec3,
        /// Positive.
        radius: f32,
        /// Radiance outwards.
        emission: Rgb,
        /// Colour under Equations 1 and 2 where the user gave one.
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

/// Every light that there is.
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

/// The colour for Equations 1 and 2 of something that gives `intensity` (W/sr) from `position`.
fn classic_colour_of(intensity: Rgb, position: Vec3, bounds: &Aabb) -> Rgb {
    let nearest = bounds.radius().max(f32::MIN_POSITIVE) * 0.25;
    let distance = if bounds.is_empty() { 1.0 } else { (position - bounds.centre()).length().max(nearest) };
    intensity / (distance * distance * std::f32::consts::PI)
}

const CLASSIC: Parameter = Parameter {
    name: "classic",
    summary: "colour in cast, whitted and cook; -1 for the irradiance at the middle of the scene over π",
    unit: "",
    kind: ParameterKind::Colour { min: -1.0, max: 1e6 },
    default: "-1",
};

/// The parameter [`CLASSIC`] where it is given.
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

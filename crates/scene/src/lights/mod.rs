//! Light sources. Each kind has its own file; the table is [`LIGHTS`].
//!
//! Every light has two descriptions: radiometric, for the physical integrators, and a [`ClassicLight`](crate::ClassicLight) without units or
//! falloff, for Equations 1 and 2. The colour of the latter is the light's irradiance at the centre of the scene, over
//! π, so that a diffuse surface there looks the same in both; the parameter `classic` overrides it.

mod ambient;
mod beam;
mod cie_sky;
mod cumulative;
mod directional;
mod distant;
mod distribution_2d;
mod emission_sample;
mod environment;
mod environment_map;
mod extent;
mod guide;
mod light;
mod light_triangle;
mod luminaire;
mod mesh_light;
mod near_triangles;
mod perez_sky;
mod picture;
mod pieces;
mod point;
mod rect;
mod sky;
mod sky_dome;
mod sphere;
mod spot;
mod sun;
mod tree;

pub use crate::mesh::sides::Sides;
pub use crate::surface::light_sample::LightSample;
pub use beam::Beam;
pub use cumulative::CumulativePart;
pub use emission_sample::EmissionSample;
pub use extent::{DirectionCone, LightExtent};
pub use light::{ClassicLighting, Light, LightTracing, Receiver};
pub use light_triangle::{LightTriangle, TriangleSample, barycentric};
pub use mesh_light::{ChosenPiece, MeshLight, SurfaceEmission};
pub use perez_sky::{perez_clearness, perez_coefficients};
pub use picture::Picture;
pub use pieces::Piece;
pub use sphere::SphereLight;
pub use tree::LightTree;

use crate::mesh::Mesh;
use crate::messages::error::SceneError;
use crate::parameters::{Measure, Quantity, Reader, Spec, Value};
use crate::texture::Texture;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Aabb, Rgb, Vec3};
use std::sync::Arc;

/// The result of building a row.
#[derive(Clone)]
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
        /// Centre of the sphere, in world space.
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
    /// Whether its light comes from everywhere around the scene, as that of an environment or a sky.
    pub surrounds: bool,
    /// The flux in W of an intensity of 1 W/sr, for lights with an intensity.
    pub flux_per_intensity: fn(&Reader) -> f32,
    /// Makes one from its parameters and the scene's textures.
    pub build: fn(&Reader, &[Arc<Texture>]) -> Result<BuiltLight, SceneError>,
}

/// All lights.
pub static LIGHTS: &[LightEntry] = &[
    point::ENTRY,
    directional::ENTRY,
    spot::ENTRY,
    luminaire::ENTRY,
    rect::ENTRY,
    sphere::ENTRY,
    environment::ENTRY,
    sky::ENTRY,
    cie_sky::ENTRY,
    perez_sky::ENTRY,
    ambient::ENTRY,
];

/// True for the kinds of light that come from everywhere around the scene.
pub fn surrounds(kind: &str) -> bool {
    LIGHTS.iter().any(|row| row.entry.name == kind && row.surrounds)
}

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
    let spec = in_numbers_of(spec, row)?;
    (row.build)(&Reader::new(&spec, &row.entry)?, textures)
}

/// Light with numbers in place of quantities such as `800 lm`, in the units of the table; unchanged where something is wrong with it.
pub fn in_numbers(spec: &Spec) -> Spec {
    let row = LIGHTS.iter().find(|row| row.entry.name == spec.kind);
    row.and_then(|row| in_numbers_of(spec, row).ok()).unwrap_or_else(|| spec.clone())
}

fn in_numbers_of(spec: &Spec, row: &LightEntry) -> Result<Spec, SceneError> {
    let reader = Reader::new(spec, &row.entry)?;
    let mut plain = spec.clone();
    for (key, value, _) in &mut plain.parameters.0 {
        let parameter = row.entry.parameters.iter().find(|parameter| parameter.name == key);
        let (Value::Text(text), Some(parameter)) = (&*value, parameter) else { continue };
        if !matches!(parameter.kind, ParameterKind::Colour { .. } | ParameterKind::ColourTexture { .. }) {
            continue;
        }
        let Ok(Quantity { measure, colour }) = Quantity::read(text) else { continue };
        let is_spread = measure == Some(Measure::Flux) && parameter.unit == INTENSITY;
        *value = Value::from(if is_spread { colour / (row.flux_per_intensity)(&reader) } else { colour });
    }
    Ok(plain)
}

/// The unit of the lights' intensities.
const INTENSITY: &str = "W/sr";

/// For lights that have no intensity.
const NO_INTENSITY: fn(&Reader) -> f32 = |_| 1.0;

/// For lights whose intensity is the same in all directions.
const ALL_AROUND: fn(&Reader) -> f32 = |_| 4.0 * std::f32::consts::PI;

/// The layer of light that a light belongs to.
pub(crate) fn group_of(spec: &Spec) -> String {
    match spec.parameters.find(GROUP.name) {
        Some((Value::Text(group), _)) if group != GROUP.default => group.clone(),
        _ => spec.name.clone(),
    }
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

const GROUP: Parameter = Parameter {
    name: "group",
    summary: "the light group that it belongs to, for --aov groups; name stands for the light's own name",
    unit: "",
    kind: ParameterKind::Text,
    default: "name",
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

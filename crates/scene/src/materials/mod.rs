//! Materials of surfaces. Each material has its own file; the table is [`MATERIALS`].
//!
//! A material has two descriptions at a point: its [`Bsdf`], for the physical integrators, and its [`ClassicMaterial`],
//! for Equations 1 and 2 of the paper. R₀ is the reflectance at normal incidence, and the opaque base is the part that
//! is neither metal nor clear. The two correspond as follows:
//!
//! | material | ka | kd | ks | kt | exponent | reflectivity | Fresnel |
//! | --- | --- | --- | --- | --- | --- | --- | --- |
//! | `phong` | as given | as given | as given | as given | as given | as given | where kt > 0 |
//! | `diffuse` | reflectance | reflectance | 0 | 0 | – | 0 | no |
//! | `mirror` | 0 | 0 | reflectance | 0 | 500 | 1 | no |
//! | `conductor` | 0 | 0 | R₀ | 0 | 2/α² − 2, at most 500 | 1 | no |
//! | `dielectric` | 0 | 0 | 1 | tint | 500 | 1 | yes |
//! | `principled` | opaque base | as ka | R₀; 1 where kt > 0 | transmission | as `conductor` | 1 | where kt > 0 |
//! | `mix` | in between | in between | in between | in between | in between | in between | as the transmitting part |
//!
//! Roughness α spreads the reflected and refracted rays of `cook` by up to the arc tangent of α.

mod conductor;
mod dielectric;
mod diffuse;
mod emission;
mod glasses;
mod metals;
mod mirror;
mod mix;
mod modifiers;
mod normal_map;
mod opacity;
mod phong;
mod principled;
mod roughness;
mod visible;

use crate::bsdf::{Bsdf, MAX_LOBES};
use crate::classic::ClassicMaterial;
use crate::error::SceneError;
use crate::lights::Sides;
use crate::parameters::{Reader, Span, Spec};
use crate::surface::Surface;
use crate::texture::{ColourMap, NumberMap, Texture};
use crate::wavelength::Wavelength;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
pub use conductor::normal_incidence_reflectance;
pub use dielectric::with_indices;
use emission::{EMISSION, EMISSION_SCALE, EMISSION_SIDES};
pub use glasses::glass_indices;
use normal_map::{COAT_NORMAL, COAT_NORMAL_SCALE, NORMAL, NORMAL_SCALE};
use opacity::OPACITY;
use std::sync::Arc;
use visible::VISIBLE_SIDES;

/// The material of a surface.
pub trait Material: Send + Sync {
    /// How light scatters at a point.
    fn bsdf(&self, surface: &Surface) -> Bsdf;
    /// True when its [`Bsdf`] is, everywhere, a single Lambertian lobe about the shading normal.
    fn is_lambertian(&self) -> bool {
        false
    }
    /// The reflectance of that lobe at a point.
    fn lambertian_reflectance(&self, _surface: &Surface) -> Rgb {
        Rgb::BLACK
    }
    /// That reflectance where it is the same everywhere, on meshes without colours at their vertices.
    fn constant_lambertian_reflectance(&self) -> Option<Rgb> {
        None
    }
    /// The same point under Equations 1 and 2.
    fn classic(&self, surface: &Surface) -> ClassicMaterial;
    /// The shading normal at a point, on the same side as `n_geom`: interpolated, or from a normal map.
    ///
    /// Tracers call it where there are tangents; the other functions read the result from the surface.
    fn n_shade(&self, surface: &Surface) -> Vec3 {
        surface.n_shade
    }
    /// True when it is anisotropic, and so needs [`Surface::tangent`].
    fn needs_tangents(&self) -> bool {
        false
    }
    /// The maximum number of lobes of its [`Bsdf`].
    fn max_lobes(&self) -> usize {
        1
    }
    /// Emitted radiance, black for no emission; the maximum, if a texture varies it.
    fn emission(&self) -> Rgb {
        Rgb::BLACK
    }
    /// The emission texture.
    fn emission_map(&self) -> Option<&ColourMap> {
        None
    }
    /// The sides of its triangles from which a surface emits.
    fn emission_sides(&self) -> Sides {
        Sides::Both
    }
    /// The opacity mask, if it has one.
    fn opacity(&self) -> Option<&NumberMap> {
        None
    }
    /// The sides of its triangles that a camera sees.
    fn visible_sides(&self) -> Sides {
        Sides::Both
    }
    /// True when it refracts each wavelength differently.
    fn disperses(&self) -> bool {
        false
    }
    /// Its interior medium for overlapping objects; `None` if it takes no part in nesting.
    fn nested(&self) -> Option<Nested> {
        None
    }
    /// Absorption per metre inside, by Beer's law; black if there is no interior.
    fn sigma_a(&self) -> Rgb {
        Rgb::BLACK
    }
}

/// A nested medium; where several overlap, only the one of the highest priority exists. [Schmidt 2002]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested {
    /// At least 1.
    pub priority: u32,
    /// Refractive index relative to air.
    pub eta: f32,
    /// 1 over the Abbe number.
    pub dispersion: f32,
}

impl Nested {
    /// The index at a wavelength.
    pub fn index(&self, wavelength: &Wavelength) -> f32 {
        if self.dispersion == 0.0 { self.eta } else { wavelength.index(self.eta, self.dispersion) }
    }
}

/// A row of [`MATERIALS`].
#[derive(Clone, Copy, Debug)]
pub struct MaterialEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from its parameters.
    pub build: BuildMaterial,
}

/// Builds a material from its parameters and the rest of the scene.
pub type BuildMaterial = fn(&Reader, &MaterialInputs) -> Result<Arc<dyn Material>, SceneError>;

/// The inputs of a material.
#[derive(Clone, Copy, Debug, Default)]
pub struct MaterialInputs<'a> {
    /// The scene's textures.
    pub textures: &'a [Arc<Texture>],
    /// The scene's materials, for those that refer to others.
    pub materials: &'a [Spec],
    /// The nesting depth of this material in mixes.
    depth: usize,
}

/// Each lobe needs a material, so no allowed mix is deeper.
const DEEPEST: usize = MAX_LOBES - 1;

impl<'a> MaterialInputs<'a> {
    /// The inputs from a whole scene.
    pub fn new(textures: &'a [Arc<Texture>], materials: &'a [Spec]) -> MaterialInputs<'a> {
        MaterialInputs { textures, materials, depth: 0 }
    }

    /// Builds another material of the scene, as a part of this one.
    fn material(&self, index: usize, at: &Span) -> Result<Arc<dyn Material>, SceneError> {
        let Some(spec) = self.materials.get(index) else {
            return Err(SceneError::invalid(format!("no material {index}"), at));
        };
        if self.depth >= DEEPEST {
            let message = format!("mixes are nested more than {DEEPEST} deep, or contain themselves");
            return Err(SceneError::invalid(message, at));
        }
        build(spec, &MaterialInputs { depth: self.depth + 1, ..*self })
    }
}

/// The refractive index of a named metal per channel: real part, then imaginary part.
pub fn metal_indices(name: &str) -> Option<[Rgb; 2]> {
    metals::METALS.iter().find(|metal| metal.name == name).map(|metal| [metal.eta, metal.k])
}

/// All materials.
pub const MATERIALS: &[MaterialEntry] = &[
    phong::ENTRY,
    diffuse::ENTRY,
    mirror::ENTRY,
    conductor::ENTRY,
    dielectric::ENTRY,
    principled::ENTRY,
    mix::ENTRY,
];

/// Makes the material that a spec describes.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn build(spec: &Spec, inputs: &MaterialInputs) -> Result<Arc<dyn Material>, SceneError> {
    let names = MATERIALS.iter().map(|row| row.entry.name);
    let row = MATERIALS
        .iter()
        .find(|row| row.entry.name == spec.kind)
        .ok_or_else(|| SceneError::unknown("material", &spec.kind, names, &spec.span))?;
    let reader = Reader::new(spec, &row.entry)?;
    modifiers::apply((row.build)(&reader, inputs)?, row, &reader, inputs)
}

/// The colour or texture under a key.
fn colour_map(reader: &Reader, key: &str, inputs: &MaterialInputs) -> Result<ColourMap, SceneError> {
    Ok(ColourMap { colour: reader.colour(key), texture: texture(reader, key, inputs)? })
}

/// The number or texture under a key.
fn number_map(reader: &Reader, key: &str, inputs: &MaterialInputs) -> Result<NumberMap, SceneError> {
    let range = reader.range(key).map(|x| x as f32);
    Ok(NumberMap { number: reader.number(key), range, texture: texture(reader, key, inputs)? })
}

fn texture(reader: &Reader, key: &str, inputs: &MaterialInputs) -> Result<Option<Arc<Texture>>, SceneError> {
    let Some(index) = reader.texture(key) else { return Ok(None) };
    let missing = || SceneError::invalid(format!("no texture {index}"), reader.span(key));
    inputs.textures.get(index).cloned().map(Some).ok_or_else(missing)
}

const ABSORPTION: Parameter = Parameter {
    name: "absorption",
    summary: "absorption inside, by Beer's law",
    unit: "1/m",
    kind: ParameterKind::Colour { min: 0.0, max: 1e6 },
    default: "0",
};

const ETA: Parameter = Parameter {
    name: "eta",
    summary: "refractive index of the inside relative to the outside",
    unit: "",
    kind: ParameterKind::Number { min: 0.1, max: 10.0 },
    default: "1.5",
};

const THIN: Parameter = Parameter {
    name: "thin",
    summary: "thin-walled: light passes straight through without refraction",
    unit: "",
    kind: ParameterKind::Bool,
    default: "false",
};

const fn reflectance(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::ColourTexture { min: 0.0, max: 1.0 }, default }
}

const fn spread(name: &'static str, summary: &'static str) -> Parameter {
    Parameter {
        name,
        summary,
        unit: "degrees",
        kind: ParameterKind::Number { min: 0.0, max: 90.0 },
        default: "0",
    }
}

//! What surfaces are made of. One material a file; the table is [`MATERIALS`].
//!
//! A material says two things of a point: its [`Bsdf`], for the physical integrators, and its
//! [`ClassicMaterial`], for Equations 1 and 2 of the paper. The map between the two:
//!
//! | material | ka | kd | ks | kt | exponent | reflectivity | Fresnel |
//! | --- | --- | --- | --- | --- | --- | --- | --- |
//! | `phong` | as given | as given | as given | as given | as given | as given | where kt > 0 |
//! | `diffuse` | reflectance | reflectance | 0 | 0 | – | 0 | no |
//! | `mirror` | 0 | 0 | reflectance | 0 | 500 | 1 | no |
//! | `conductor` | 0 | 0 | reflectance straight on | 0 | 2/α² − 2, at most 500 | 1 | no |
//! | `dielectric` | 0 | 0 | 1 | tint | 500 | 1 | yes |
//! | `principled` | base that is neither metal nor clear | as ka | what is reflected straight on; 1 where kt > 0 | transmission | 2/α² − 2, at most 500 | 1 | where kt > 0 |
//! | `mix` | in between | in between | in between | in between | in between | in between | as what lets light in |
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
pub use conductor::straight_on;
pub use dielectric::with_indices;
use emission::{EMISSION, EMISSION_SCALE, EMISSION_SIDES};
pub use glasses::glass_indices;
use normal_map::{COAT_NORMAL, COAT_NORMAL_SCALE, NORMAL, NORMAL_SCALE};
use opacity::OPACITY;
use std::sync::Arc;
use visible::VISIBLE_SIDES;

/// Something that surfaces are made of.
pub trait Material: Send + Sync {
    /// How light scatters at a point.
    fn bsdf(&self, surface: &Surface) -> Bsdf;
    /// The same point under Equations 1 and 2.
    fn classic(&self, surface: &Surface) -> ClassicMaterial;
    /// The shading normal at a point, on the same side as `n_geom`: the interpolated one, unless there is a normal map.
    /// Tracers ask for it, where there are tangents; the other functions find it in the surface.
    fn n_shade(&self, surface: &Surface) -> Vec3 {
        surface.n_shade
    }
    /// True when it tells directions along the surface apart, and so asks for [`Surface::tangent`].
    fn needs_tangents(&self) -> bool {
        false
    }
    /// In how many ways it scatters light at most: lobes of its [`Bsdf`].
    fn most_lobes(&self) -> usize {
        1
    }
    /// Radiance given out, black for what is no light; the greatest, where a picture tells it.
    fn emission(&self) -> Rgb {
        Rgb::BLACK
    }
    /// The picture that tells it.
    fn emission_map(&self) -> Option<&ColourMap> {
        None
    }
    /// On which sides of its triangles a surface gives that out.
    fn emission_sides(&self) -> Sides {
        Sides::Both
    }
    /// How much of the surface there is, where it has holes.
    fn opacity(&self) -> Option<&NumberMap> {
        None
    }
    /// From which sides of its triangles a camera sees it.
    fn visible_sides(&self) -> Sides {
        Sides::Both
    }
    /// True when it sends light of each wavelength another way.
    fn disperses(&self) -> bool {
        false
    }
    /// How what is inside stands against what it overlaps with; `None` for what takes no part in that.
    fn nested(&self) -> Option<Nested> {
        None
    }
    /// Absorption per metre on the inside, by Beer's law; none where there is no inside.
    fn sigma_a(&self) -> Rgb {
        Rgb::BLACK
    }
}

/// A medium that may overlap with others: where several are, the one of the greatest priority is. [Schmidt 2002]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nested {
    /// At least 1.
    pub priority: u32,
    /// Refractive index over that of air.
    pub eta: f32,
    /// 1 over Abbe's number.
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

/// How a material is made from its parameters and what else is in the scene.
pub type BuildMaterial = fn(&Reader, &MaterialInputs) -> Result<Arc<dyn Material>, SceneError>;

/// What materials are made of.
#[derive(Clone, Copy, Debug, Default)]
pub struct MaterialInputs<'a> {
    /// The scene's textures.
    pub textures: &'a [Arc<Texture>],
    /// The scene's materials, for those that are made of others.
    pub materials: &'a [Spec],
    /// How many materials this one is already a part of.
    depth: usize,
}

/// Each way of scattering needs a material, so that no mix that is allowed is deeper.
const DEEPEST: usize = MAX_LOBES - 1;

impl<'a> MaterialInputs<'a> {
    /// Those of a whole scene.
    pub fn new(textures: &'a [Arc<Texture>], materials: &'a [Spec]) -> MaterialInputs<'a> {
        MaterialInputs { textures, materials, depth: 0 }
    }

    /// Another material of the scene, as a part of the one that is being made.
    fn material(&self, index: usize, at: &Span) -> Result<Arc<dyn Material>, SceneError> {
        let Some(spec) = self.materials.get(index) else {
            return Err(SceneError::invalid(format!("no material {index}"), at));
        };
        if self.depth >= DEEPEST {
            let message = format!("materials are mixed more than {DEEPEST} deep, or one with itself");
            return Err(SceneError::invalid(message, at));
        }
        build(spec, &MaterialInputs { depth: self.depth + 1, ..*self })
    }
}

/// The refractive index of a named metal, channel by channel: its real part, and the imaginary one.
pub fn metal_indices(name: &str) -> Option<[Rgb; 2]> {
    metals::METALS.iter().find(|metal| metal.name == name).map(|metal| [metal.eta, metal.k])
}

/// Every material that there is.
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
pub fn build(spec: &Spec, ingredients: &MaterialInputs) -> Result<Arc<dyn Material>, SceneError> {
    let names = MATERIALS.iter().map(|row| row.entry.name);
    let row = MATERIALS
        .iter()
        .find(|row| row.entry.name == spec.kind)
        .ok_or_else(|| SceneError::unknown("material", &spec.kind, names, &spec.span))?;
    let reader = Reader::new(spec, &row.entry)?;
    modifiers::dress((row.build)(&reader, ingredients)?, row, &reader, ingredients)
}

/// The colour or texture under a key.
fn colour_map(reader: &Reader, key: &str, ingredients: &MaterialInputs) -> Result<ColourMap, SceneError> {
    Ok(ColourMap { colour: reader.colour(key), texture: texture(reader, key, ingredients)? })
}

/// The number or texture under a key.
fn number_map(reader: &Reader, key: &str, ingredients: &MaterialInputs) -> Result<NumberMap, SceneError> {
    let range = reader.range(key).map(|x| x as f32);
    Ok(NumberMap { number: reader.number(key), range, texture: texture(reader, key, ingredients)? })
}

fn texture(
    reader: &Reader,
    key: &str,
    ingredients: &MaterialInputs,
) -> Result<Option<Arc<Texture>>, SceneError> {
    let Some(index) = reader.texture(key) else { return Ok(None) };
    let missing = || SceneError::invalid(format!("no texture {index}"), reader.span(key));
    ingredients.textures.get(index).cloned().map(Some).ok_or_else(missing)
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
    summary: "refractive index of the inside over that of the outside",
    unit: "",
    kind: ParameterKind::Number { min: 0.1, max: 10.0 },
    default: "1.5",
};

const THIN: Parameter = Parameter {
    name: "thin",
    summary: "a wall without thickness: light goes straight through",
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

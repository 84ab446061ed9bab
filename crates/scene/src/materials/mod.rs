//! Materials of surfaces. Each material has its own file; the table is [`MATERIALS`].
//!
//! A material has two descriptions at a point: its [`crate::Bsdf`], for the physical integrators, and its
//! [`crate::ClassicMaterial`], for Equations 1 and 2 of the paper. R₀ is the reflectance at normal incidence, and the opaque base is the part that
//! is neither metal nor clear. The two correspond as follows:
//!
//! | material | ka | kd | ks | kt | exponent | reflectivity | Fresnel |
//! | --- | --- | --- | --- | --- | --- | --- | --- |
//! | `phong` | as given | as given | as given | as given | as given | as given | where kt > 0 |
//! | `diffuse` | reflectance | reflectance | 0 | 0 | – | 0 | no |
//! | `translucent` | reflectance | reflectance | 0 | 0 | – | 0 | no |
//! | `mirror` | 0 | 0 | reflectance | 0 | 500 | 1 | no |
//! | `conductor` | 0 | 0 | R₀ | 0 | 2/α² − 2, at most 500 | 1 | no |
//! | `dielectric` | 0 | 0 | 1 | tint | 500 | 1 | yes |
//! | `interface` | 0 | 0 | 0 | 1 | – | 0 | no |
//! | `principled` | opaque base | as ka | R₀; 1 where kt > 0 | transmission | as `conductor` | 1 | where kt > 0 |
//! | `mix` | in between | in between | in between | in between | in between | in between | as the transmitting part |
//!
//! Roughness α spreads the reflected and refracted rays of `cook` by up to the arc tangent of α.

mod as_principled;
mod conductor;
mod dielectric;
mod diffuse;
mod emission;
mod glasses;
mod inputs;
mod interface;
mod material;
mod metals;
mod mirror;
mod mix;
mod modifiers;
mod normal_map;
mod opacity;
mod phong;
mod principled;
mod roughness;
mod translucent;
mod visible;

use crate::bsdf::MAX_LOBES;
use crate::messages::error::SceneError;
use crate::parameters::{Reader, Span, Spec};
pub use as_principled::{AsPrincipled, SHARED};
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
pub use conductor::normal_incidence_reflectance;
pub use dielectric::with_indices;
use emission::{EMISSION, EMISSION_SCALE, EMISSION_SIDES};
pub use glasses::glass_indices;
pub use inputs::MaterialInputs;
use inputs::{colour_map, number_map, texture};
pub use material::{Material, Nested};
use normal_map::{COAT_NORMAL, COAT_NORMAL_SCALE, NORMAL, NORMAL_SCALE};
use opacity::OPACITY;
use std::sync::Arc;
use visible::VISIBLE_SIDES;

/// A row of [`MATERIALS`].
#[derive(Clone, Copy, Debug)]
pub struct MaterialEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from its parameters.
    pub build: BuildMaterial,
    /// Conversion to `principled`; `None` for `principled` itself, for mixtures, and for whatever looks like nothing that
    /// `principled` can be: files then get a plain material, and the writer warns.
    pub principled: Option<AsPrincipled>,
}

/// Builds a material from its parameters and the rest of the scene.
pub type BuildMaterial = fn(&Reader, &MaterialInputs) -> Result<Arc<dyn Material>, SceneError>;

/// Each lobe needs a material, so no allowed mix is deeper.
const DEEPEST: usize = MAX_LOBES - 1;

impl MaterialInputs<'_> {
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
pub static MATERIALS: &[MaterialEntry] = &[
    phong::ENTRY,
    diffuse::ENTRY,
    translucent::ENTRY,
    mirror::ENTRY,
    conductor::ENTRY,
    dielectric::ENTRY,
    interface::ENTRY,
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
    modifiers::apply((row.build)(&reader, inputs)?, &row.entry, &reader, inputs)
}

/// The material as `principled`; `None` where its row does not say.
pub fn as_principled(spec: &Spec) -> Option<Spec> {
    let row = MATERIALS.iter().find(|row| row.entry.name == spec.kind)?;
    Some(row.principled?.apply(spec))
}

/// Says the same of objects that are `scale` times as large: lengths inside, and what is stated for each of them.
pub fn scale_lengths(spec: &mut Spec, scale: f64) {
    let Some(row) = MATERIALS.iter().find(|row| row.entry.name == spec.kind) else { return };
    for (key, value, _) in &mut spec.parameters.0 {
        if let Some(parameter) = row.entry.parameters.iter().find(|parameter| parameter.name == key) {
            value.scale_lengths(parameter.unit, scale);
        }
    }
}

const ABSORPTION: Parameter = Parameter {
    name: "absorption",
    summary: "absorption coefficient inside (Beer-Lambert law)",
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

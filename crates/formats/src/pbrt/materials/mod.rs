//! Materials; the table is [`MATERIALS`].

mod coated;
mod plain;
mod roughness;
mod version_3;

pub(super) use coated::reflected_inside;
pub(super) use plain::extinction_of;

use super::parameters::{Kind, ParameterList};
use super::reader::{Entity, Pbrt};
use super::spectra::{Named, named};
use super::state::MaterialKey;
use super::texture_or_value::{SpectrumType, TextureOrValue};
use super::unknown;
use crate::FormatError;
use crate::reading::Texels;
use bilux_scene::materials::{self, MaterialInputs};
use bilux_scene::{Span, Spec, Value};
use std::sync::Arc;

/// Builds a material; `None` for an interface, which is invisible.
type Make = fn(&mut Pbrt, &ParameterList) -> Result<Option<Spec>, FormatError>;

/// Every material; those of version 3 come last.
const MATERIALS: &[(&str, Make)] = &[
    ("coatedconductor", coated::conductor),
    ("coateddiffuse", coated::diffuse),
    ("conductor", plain::conductor),
    ("dielectric", plain::dielectric),
    ("diffuse", plain::diffuse),
    ("diffusetransmission", plain::diffuse_transmission),
    ("hair", plain::hair),
    ("interface", plain::interface),
    ("measured", plain::measured),
    ("mix", mix),
    ("subsurface", coated::subsurface),
    ("thindielectric", plain::thin_dielectric),
    ("", plain::interface),
    ("none", plain::interface),
    ("matte", version_3::matte),
    ("plastic", version_3::plastic),
    ("substrate", version_3::plastic),
    ("uber", version_3::plastic),
    ("metal", version_3::metal),
    ("mirror", version_3::mirror),
    ("glass", version_3::glass),
    ("translucent", version_3::translucent),
    ("disney", version_3::disney),
    ("kdsubsurface", version_3::plastic),
    ("fourier", plain::measured),
];

impl Pbrt<'_, '_> {
    /// The material of a key; `None` for an interface, which is invisible.
    pub(super) fn material(&mut self, key: &MaterialKey, user: &Span) -> Result<Option<Spec>, FormatError> {
        let index = match key {
            MaterialKey::Default => {
                return Ok(Some(Spec::new("default", "diffuse").with("reflectance", 0.5f32)));
            }
            MaterialKey::Index(index) => *index,
            MaterialKey::Named(name) => match self.named_materials.get(name) {
                Some((index, _)) => *index,
                None => {
                    let names = self.named_materials.keys().map(|name| &**name);
                    return Err(unknown("material", name, names, user));
                }
            },
        };
        let Some(entity) = self.materials.get(index).cloned() else { return Ok(None) };
        let spec = self.material_of(&entity)?;
        Ok(spec.map(|mut spec| {
            if let MaterialKey::Named(name) = key {
                spec.name = name.to_string();
            }
            spec
        }))
    }

    fn material_of(&mut self, entity: &Entity) -> Result<Option<Spec>, FormatError> {
        let Some((_, make)) = MATERIALS.iter().find(|(name, _)| *name == entity.kind) else {
            let names = MATERIALS.iter().map(|(name, _)| *name).filter(|name| !name.is_empty());
            return Err(unknown("material", &entity.kind, names, &entity.at));
        };
        let list = &entity.parameters;
        let Some(mut spec) = make(self, list)? else { return Ok(None) };
        spec.span = entity.at.clone();
        for name in ["type", "bumpmap"] {
            list.has(name);
        }
        if let Some(name) = ["displacement", "bumpmap"].into_iter().find(|name| list.has(name)) {
            self.oddities.note("displacement of a material is not supported", || list.place(name));
        }
        if let Some(name) = list.text("normalmap")? {
            let at = list.place("normalmap");
            let map = TextureOrValue::Picture(Arc::new(self.file(name, Texels::Numbers(None), &at)?));
            spec.parameters.set_at("normal", self.value(map), at);
        }
        list.report_unused(&mut self.oddities);
        Ok(Some(spec))
    }

    /// An index of refraction, if given.
    fn index(&mut self, list: &ParameterList, name: &'static str) -> Result<Option<f32>, FormatError> {
        let Some((index, dispersion)) = self.refraction(list, name)? else { return Ok(None) };
        if dispersion != Some(0.0) {
            self.refracts_alike(list, name);
        }
        Ok(Some(index))
    }

    fn refracts_alike(&mut self, list: &ParameterList, name: &'static str) {
        let what = "dispersion is not supported: all colours are refracted with the index at 587.6 nm";
        self.oddities.note(what, || list.place(name));
    }

    /// The index of refraction at 587.6 nm and its dispersion.
    ///
    /// The dispersion is `None` if `dielectric` cannot represent it.
    fn refraction(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<(f32, Option<f32>)>, FormatError> {
        let Some(parameter) = list.find(name) else { return Ok(None) };
        if parameter.kind == Kind::Float {
            return Ok(Some((list.finite(name, 1.5)?, Some(0.0))));
        }
        if let Some(spectrum) = self.whole_spectrum(parameter)? {
            return Ok(Some((spectrum.at_yellow(), spectrum.dispersion())));
        }
        if let Some(Named::Glass { index, abbe_number }) = parameter.text().and_then(named) {
            return Ok(Some((index, Some(20.0 / abbe_number))));
        }
        Ok(Some((self.colour_of(parameter, SpectrumType::Number)?.g, Some(0.0))))
    }

    /// Sets a parameter to a colour or a texture.
    fn set(&mut self, spec: &mut Spec, key: &str, source: TextureOrValue, at: Span) {
        let value = self.value(source);
        spec.parameters.set_at(key, value, at);
    }

    /// Mixes two materials; `share` is the weight of `b`. If that is not possible, warns and returns the first
    /// alone.
    pub(super) fn mixed(&mut self, mut a: Spec, mut b: Spec, share: Value, what: &str) -> Spec {
        match share {
            Value::Number(share) if share <= 0.0 => return a,
            Value::Number(share) if share >= 1.0 => return b,
            _ => {}
        }
        let mut mix = Spec { span: b.span.clone(), ..Spec::new(&b.name, "mix") };
        for part in [&mut a, &mut b] {
            for key in ["normal", "normal_scale"] {
                if let Some(value) = take(part, key) {
                    mix.parameters.set(key, value);
                }
            }
        }
        let whole = b.clone();
        let first = self.scene.materials.len();
        self.scene.materials.extend([a, b]);
        let mix =
            mix.with("a", Value::Material(first)).with("b", Value::Material(first + 1)).with("amount", share);
        if materials::build(&mix, &MaterialInputs::new(&self.scene.textures, &self.scene.materials)).is_ok() {
            return mix;
        }
        self.scene.materials.truncate(first);
        let note = format!("{what} of a material is not supported");
        self.oddities.note(&note, || whole.span.clone());
        whole
    }
}

/// Removes a parameter from a spec.
pub(super) fn take(spec: &mut Spec, key: &str) -> Option<Value> {
    let index = spec.parameters.0.iter().position(|(k, ..)| k == key)?;
    Some(spec.parameters.0.remove(index).1)
}

/// Deeper nesting of mixes is refused.
const MAX_DEPTH: usize = 8;

fn mix(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let amount = pbrt
        .float_texture_or_colour(list, "amount")?
        .unwrap_or(TextureOrValue::Colour(bilux_math::Rgb::grey(0.5)));
    let (names, is_old): (Vec<String>, bool) = match list.texts("materials")? {
        [] => {
            let name = |key| Ok::<_, FormatError>(list.text(key)?.map(str::to_owned));
            ([name("namedmaterial1")?, name("namedmaterial2")?].into_iter().flatten().collect(), true)
        }
        names => (names.to_vec(), false),
    };
    let [a, b] = names.as_slice() else {
        let message = format!("a mix takes two materials, not {}", names.len());
        return Err(FormatError::malformed(message, list.at.clone()));
    };
    pbrt.mix_depth += 1;
    if pbrt.mix_depth > MAX_DEPTH {
        let message = format!("mixes are nested more than {MAX_DEPTH} levels deep, or contain themselves");
        return Err(FormatError::malformed(message, list.at.clone()));
    }
    let mut part = |name: &str| pbrt.material(&MaterialKey::Named(name.into()), &list.place("materials"));
    // In version 3 the amount is the weight of the first material.
    let (first, second) = if is_old { (part(b)?, part(a)?) } else { (part(a)?, part(b)?) };
    pbrt.mix_depth -= 1;
    let (Some(first), Some(second)) = (first, second) else {
        let what = "an interface cannot be mixed with a material: only the material is used";
        pbrt.oddities.note(what, || list.at.clone());
        return Ok(None);
    };
    let amount = pbrt.number_value(amount, [0.0, 1.0]);
    Ok(Some(pbrt.mixed(first, second, amount, "a part")))
}

impl Pbrt<'_, '_> {
    /// A number, or a colour in its place, as version 3 allows.
    fn float_texture_or_colour(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<TextureOrValue>, FormatError> {
        if list.find(name).is_some_and(|p| matches!(p.kind, Kind::Rgb | Kind::Spectrum)) {
            return Ok(self
                .spectrum(list, name, SpectrumType::Number)?
                .map(|c| TextureOrValue::Colour(bilux_math::Rgb::grey(c.luminance()))));
        }
        self.float_texture(list, name)
    }
}

//! Parts and functions that the makers of materials share.

use crate::pbrt::document::Document;
use crate::pbrt::loader::{Loader, SpectrumType};
use crate::pbrt::parameters::{Kind, ParameterList};
use crate::pbrt::spectra::{Named, named};
use crate::pbrt::textures::Textures;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_scene::materials::{self, MaterialInputs};
use bilux_scene::{Span, Spec, Value};

/// Makes materials.
pub(in crate::pbrt) struct MaterialMaker<'d, 'o, 'r> {
    /// Document in which materials have their names.
    pub(super) document: &'d Document,
    pub(in crate::pbrt) textures: Textures<'d, 'o, 'r>,
    /// The materials of the scene.
    pub(in crate::pbrt) in_scene: Vec<Spec>,
    /// The number of mixes around the material that is being built.
    pub(super) mix_depth: usize,
}

impl<'d, 'o, 'r> MaterialMaker<'d, 'o, 'r> {
    pub(in crate::pbrt) fn new(document: &'d Document, loader: Loader<'o, 'r>) -> MaterialMaker<'d, 'o, 'r> {
        let textures = Textures::new(&document.textures, loader);
        MaterialMaker { document, textures, in_scene: Vec::new(), mix_depth: 0 }
    }

    pub(in crate::pbrt) fn loader(&mut self) -> &mut Loader<'o, 'r> {
        &mut self.textures.loader
    }

    /// Counts something odd.
    pub(in crate::pbrt) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.loader().note(what, at);
    }

    /// An index of refraction, if given.
    pub(super) fn index(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<f32>, FormatError> {
        let Some((index, dispersion)) = self.refraction(list, name)? else { return Ok(None) };
        if dispersion != Some(0.0) {
            self.refracts_alike(list, name);
        }
        Ok(Some(index))
    }

    pub(super) fn refracts_alike(&mut self, list: &ParameterList, name: &'static str) {
        let what = "dispersion is not supported: all colours are refracted with the index at 587.6 nm";
        self.note(what, || list.place(name));
    }

    /// The index of refraction at 587.6 nm and its dispersion.
    ///
    /// The dispersion is `None` if `dielectric` cannot represent it.
    pub(super) fn refraction(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<(f32, Option<f32>)>, FormatError> {
        let Some(parameter) = list.find(name) else { return Ok(None) };
        if parameter.kind == Kind::Float {
            return Ok(Some((list.finite(name, 1.5)?, Some(0.0))));
        }
        if let Some(spectrum) = self.loader().whole_spectrum(parameter)? {
            return Ok(Some((spectrum.at_yellow(), spectrum.dispersion())));
        }
        if let Some(Named::Glass { index, abbe_number }) = parameter.text().and_then(named) {
            return Ok(Some((index, Some(20.0 / abbe_number))));
        }
        Ok(Some((self.loader().colour_of(parameter, SpectrumType::Number)?.g, Some(0.0))))
    }

    /// Sets a parameter to a colour or a texture.
    pub(super) fn set(&mut self, spec: &mut Spec, key: &str, source: TextureOrValue, at: Span) {
        let value = self.textures.value(source);
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
        let first = self.in_scene.len();
        self.in_scene.extend([a, b]);
        let mix =
            mix.with("a", Value::Material(first)).with("b", Value::Material(first + 1)).with("amount", share);
        if materials::build(&mix, &MaterialInputs::new(&self.textures.in_scene, &self.in_scene)).is_ok() {
            return mix;
        }
        self.in_scene.truncate(first);
        let note = format!("{what} of a material is not supported");
        self.note(&note, || whole.span.clone());
        whole
    }

    /// A number, or a colour in its place, as version 3 allows.
    pub(super) fn float_texture_or_colour(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<TextureOrValue>, FormatError> {
        if list.find(name).is_some_and(|p| matches!(p.kind, Kind::Rgb | Kind::Spectrum)) {
            return Ok(self
                .loader()
                .spectrum(list, name, SpectrumType::Number)?
                .map(|c| TextureOrValue::Colour(Rgb::grey(c.luminance()))));
        }
        self.textures.float_texture(list, name)
    }
}

/// Removes a parameter from a spec.
pub(super) fn take(spec: &mut Spec, key: &str) -> Option<Value> {
    let index = spec.parameters.0.iter().position(|(k, ..)| k == key)?;
    Some(spec.parameters.0.remove(index).1)
}

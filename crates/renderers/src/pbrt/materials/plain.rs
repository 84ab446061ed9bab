//! Materials with one layer.

use super::super::loader::SpectrumType;
use super::super::parameters::ParameterList;
use super::super::spectra::{Named, named};
use super::maker::MaterialMaker;
use super::roughness::{Names, OWN, PLAIN};
use bilux_import::FormatError;
use bilux_import::appearance::fresnel::extinction_of;
use bilux_import::appearance::spectra::metals::{self, Reduced};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_scene::Spec;

pub(super) fn diffuse(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let reflectance = maker
        .textures
        .texture_or_value(list, "reflectance", SpectrumType::Surface)?
        .unwrap_or(TextureOrValue::Colour(Rgb::grey(0.5)));
    let mut spec = Spec::new("", "diffuse");
    maker.set(&mut spec, "reflectance", reflectance, list.place("reflectance"));
    Ok(Some(spec))
}

/// An interface is invisible; only the media on its two sides may differ.
pub(super) fn interface(_: &mut MaterialMaker, _: &ParameterList) -> Result<Option<Spec>, FormatError> {
    Ok(None)
}

/// A thin diffuse sheet without a boundary, which also transmits scattered light.
pub(super) fn diffuse_transmission(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    let scale = Rgb::grey(list.finite("scale", 1.0)?);
    let source = |found: Option<TextureOrValue>| {
        found.unwrap_or(TextureOrValue::Colour(Rgb::grey(0.25))).scaled(scale)
    };
    let reflectance = source(maker.textures.texture_or_value(list, "reflectance", SpectrumType::Surface)?);
    let transmittance =
        source(maker.textures.texture_or_value(list, "transmittance", SpectrumType::Surface)?);
    let share = transmitted_fraction(&reflectance, &transmittance);
    let mut spec = Spec::new("", "principled").with("specular_weight", 0.0f32);
    spec.parameters.set("diffuse_transmission_weight", share);
    let part = |source: TextureOrValue, share: f32| {
        if share > 0.0 { source.scaled(Rgb::grey(1.0 / share)) } else { source }
    };
    let (front, behind) = (part(reflectance, 1.0 - share), part(transmittance, share));
    for (key, source, name) in
        [("base_color", front, "reflectance"), ("diffuse_transmission_color", behind, "transmittance")]
    {
        let held = match source {
            TextureOrValue::Colour(colour) => TextureOrValue::Colour(colour.clamp(0.0, 1.0)),
            picture => picture,
        };
        maker.set(&mut spec, key, held, list.place(name));
    }
    Ok(Some(spec))
}

/// The fraction of light that is transmitted, chosen so that neither colour exceeds 1 unless their sum does.
fn transmitted_fraction(reflectance: &TextureOrValue, transmittance: &TextureOrValue) -> f32 {
    match (reflectance, transmittance) {
        (TextureOrValue::Colour(r), TextureOrValue::Colour(t)) => {
            let (r, t) = (r.max_channel(), t.max_channel());
            if r + t > 0.0 { t / (r + t) } else { 0.0 }
        }
        _ => 0.5,
    }
}

pub(super) fn dielectric(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    let mut spec = glass(maker, list)?;
    maker.set_roughness(&mut spec, list, OWN, 0.0, false, PLAIN)?;
    Ok(Some(spec))
}

pub(super) fn thin_dielectric(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    Ok(Some(glass(maker, list)?.with("thin", true)))
}

fn glass(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Spec, FormatError> {
    let (index, dispersion) = maker.refraction(list, "eta")?.unwrap_or((1.5, Some(0.0)));
    let spec = Spec::new("", "dielectric").with("eta", maker.clamped_index(index, list));
    Ok(match dispersion {
        Some(0.0) => spec,
        Some(dispersion) => spec.with("dispersion", dispersion),
        None => {
            maker.refracts_alike(list, "eta");
            spec
        }
    })
}

impl MaterialMaker<'_, '_, '_> {
    /// The index of refraction, clamped to the supported range.
    pub(super) fn clamped_index(&mut self, index: f32, list: &ParameterList) -> f32 {
        let held = if index.is_finite() { index.clamp(0.1, 10.0) } else { 1.5 };
        if held != index {
            self.note("a refractive index is out of range: it is limited to 0.1 to 10", || list.place("eta"));
        }
        held
    }
}

pub(super) fn conductor(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    let mut spec = Spec::new("", "conductor");
    maker.set_metal(&mut spec, list, ["eta", "k"])?;
    maker.set_roughness(&mut spec, list, OWN, 0.0, false, PLAIN)?;
    Ok(Some(spec))
}

/// Metal, by what describes it.
pub(super) enum Metal {
    /// By its reflectance at normal incidence.
    Reflectance(TextureOrValue),
    /// By its index of refraction and its extinction coefficient.
    Indices([Rgb; 2]),
}

impl MaterialMaker<'_, '_, '_> {
    /// Reads a metal; `names` are the parameters of its index of refraction and of its extinction.
    pub(super) fn metal(
        &mut self,
        list: &ParameterList,
        [eta_name, k_name]: [&'static str; 2],
    ) -> Result<Metal, FormatError> {
        let given = list.has(eta_name) || list.has(k_name);
        if let Some(reflectance) =
            self.textures.texture_or_value(list, "reflectance", SpectrumType::Surface)?
        {
            if given {
                let message =
                    "'reflectance' and a refractive index both define the metal: remove one of them";
                return Err(FormatError::malformed(message, list.place("reflectance")));
            }
            return Ok(Metal::Reflectance(reflectance));
        }
        if !given {
            return Ok(Metal::Indices(metals::indices("copper")));
        }
        let metal_of = |name: &'static str| match named(list.find(name)?.text()?)? {
            Named::Metal { metal, .. } => Some(metal),
            _ => None,
        };
        if let (Some(metal), Some(same)) = (metal_of(eta_name), metal_of(k_name))
            && metal == same
        {
            return Ok(Metal::Indices(metals::indices(metal)));
        }
        let spectra = match (list.find(eta_name), list.find(k_name)) {
            (Some(eta), Some(k)) => (self.loader().whole_spectrum(eta)?, self.loader().whole_spectrum(k)?),
            _ => (None, None),
        };
        if let (Some(eta), Some(k)) = spectra {
            let Reduced { indices, is_cut } = metals::from_spectra(&eta, &k);
            if is_cut {
                let what = "a metal's colour lies outside sRGB: the nearest sRGB colour is used";
                self.note(what, || list.place(eta_name));
            }
            return Ok(Metal::Indices(indices));
        }
        let [eta, k] = metals::indices("copper");
        let mut part = |name, default| {
            let source = self.textures.texture_or_value(list, name, SpectrumType::Number)?;
            if let Some(TextureOrValue::Picture(_)) = &source {
                let what = "a refractive index from a texture is not supported: its mean is used";
                self.note(what, || list.place(name));
            }
            Ok::<_, FormatError>(source.map_or(default, |source| source.mean()))
        };
        let (eta, k) = (part(eta_name, eta)?, part(k_name, k)?);
        Ok(Metal::Indices([eta.map(|x| x.clamp(1e-3, 100.0)), k.map(|x| x.clamp(0.0, 100.0))]))
    }

    fn set_metal(
        &mut self,
        spec: &mut Spec,
        list: &ParameterList,
        names: [&'static str; 2],
    ) -> Result<(), FormatError> {
        let at = list.place(names[0]);
        match self.metal(list, names)? {
            Metal::Reflectance(source) => self.set_reflectance(spec, source, list),
            Metal::Indices([eta, k]) => {
                spec.parameters.set_at("eta", eta.into(), at.clone());
                spec.parameters.set_at("k", k.into(), at);
            }
        }
        Ok(())
    }

    /// Sets a metal of index 1, as pbrt assumes for a given reflectance; a texture uses Schlick's approximation
    /// instead.
    pub(super) fn set_reflectance(&mut self, spec: &mut Spec, source: TextureOrValue, list: &ParameterList) {
        let at = list.place("reflectance");
        match source {
            TextureOrValue::Colour(colour) => {
                spec.parameters.set_at("eta", Rgb::WHITE.into(), at.clone());
                spec.parameters.set_at("k", extinction_of(colour).into(), at);
            }
            picture => self.set(spec, "reflectance", picture, at),
        }
    }
}

pub(super) fn measured(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let what = "measured materials are not supported: a grey one is used instead";
    maker.note(what, || list.at.clone());
    for name in ["filename", "bsdffile"] {
        list.has(name);
    }
    Ok(Some(Spec::new("", "diffuse").with("reflectance", 0.5f32)))
}

pub(super) fn hair(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let what = "hair is shown as opaque glossy fibres";
    maker.note(what, || list.at.clone());
    let mut colour = None;
    for name in ["reflectance", "color"] {
        colour = colour.or(maker.textures.texture_or_value(list, name, SpectrumType::Surface)?);
    }
    for name in ["sigma_a", "eumelanin", "pheomelanin", "eta", "beta_m", "beta_n", "alpha"] {
        list.has(name);
    }
    // Brown, as is pbrt's default.
    let colour = colour.unwrap_or(TextureOrValue::Colour(Rgb::new(0.16, 0.08, 0.04)));
    let mut spec = Spec::new("", "principled").with("specular_roughness", 0.4f32);
    maker.set(&mut spec, "base_color", colour, list.at.clone());
    Ok(Some(spec))
}

pub(super) const INTERFACE: Names = ["interface.roughness", "interface.uroughness", "interface.vroughness"];
pub(super) const CONDUCTOR: Names = ["conductor.roughness", "conductor.uroughness", "conductor.vroughness"];

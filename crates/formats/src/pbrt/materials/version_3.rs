//! Materials that exist only in version 3.

use super::super::parameters::ParameterList;
use super::super::reader::Pbrt;
use super::super::texture_or_value::{SpectrumType, TextureOrValue};
use super::plain::Metal;
use super::roughness::{OWN, PLAIN, PRINCIPLED};
use crate::FormatError;
use bilux_math::Rgb;
use bilux_scene::Spec;

impl Pbrt<'_, '_> {
    fn texture_or(
        &mut self,
        list: &ParameterList,
        name: &'static str,
        default: f32,
    ) -> Result<TextureOrValue, FormatError> {
        Ok(self
            .texture_or_value(list, name, SpectrumType::Surface)?
            .unwrap_or(TextureOrValue::Colour(Rgb::grey(default))))
    }

    /// An index of refraction under one of its two names.
    fn old_index(&mut self, list: &ParameterList) -> Result<f32, FormatError> {
        let name = if list.has("index") { "index" } else { "eta" };
        let index = self.index(list, name)?.unwrap_or(1.5);
        Ok(self.clamped_index(index, list))
    }
}

pub(super) fn matte(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kd = pbrt.texture_or(list, "Kd", 0.5)?;
    if list.number("sigma")?.unwrap_or(0.0) != 0.0 {
        let what = "'sigma' of a matte material is not supported: the surface is Lambertian";
        pbrt.oddities.note(what, || list.place("sigma"));
    }
    let mut spec = Spec::new("", "diffuse");
    pbrt.set(&mut spec, "reflectance", kd, list.place("Kd"));
    Ok(Some(spec))
}

/// A diffuse base below a dielectric boundary; `Ks` scales the reflection of the boundary.
pub(super) fn plastic(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kd = pbrt.texture_or(list, "Kd", 0.25)?;
    let weight = pbrt.texture_or(list, "Ks", 0.25)?.mean().luminance();
    let index = pbrt.old_index(list)?.max(1.0);
    for name in ["Kr", "Kt", "mfp"] {
        if list.has(name) {
            let what = format!("'{name}' of a pbrt-v3 material is not supported");
            pbrt.oddities.note(&what, || list.place(name));
        }
    }
    let mut spec = Spec::new("", "principled").with("specular_ior", index);
    pbrt.set(&mut spec, "base_color", kd, list.place("Kd"));
    spec.parameters.set("specular_weight", weight.clamp(0.0, 1.0));
    if let Some(opacity) = pbrt.texture_or_value(list, "opacity", SpectrumType::Surface)? {
        let grey = pbrt.mapped(opacity, |c| Rgb::grey(c.luminance()))?;
        let value = pbrt.number_value(grey, [0.0, 1.0]);
        spec.parameters.set_at("opacity", value, list.place("opacity"));
    }
    pbrt.set_roughness(&mut spec, list, OWN, 0.1, true, PRINCIPLED)?;
    Ok(Some(spec))
}

pub(super) fn metal(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let mut spec = Spec::new("", "conductor");
    match pbrt.metal(list, ["eta", "k"])? {
        Metal::Reflectance(source) => pbrt.set_reflectance(&mut spec, source, list),
        Metal::Indices([eta, k]) => {
            spec.parameters.set("eta", eta);
            spec.parameters.set("k", k);
        }
    }
    pbrt.set_roughness(&mut spec, list, OWN, 0.01, true, PLAIN)?;
    Ok(Some(spec))
}

pub(super) fn mirror(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kr = pbrt.texture_or(list, "Kr", 0.9)?;
    let mut spec = Spec::new("", "mirror");
    pbrt.set(&mut spec, "reflectance", kr, list.place("Kr"));
    Ok(Some(spec))
}

pub(super) fn glass(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let (kr, kt) = (pbrt.texture_or(list, "Kr", 1.0)?, pbrt.texture_or(list, "Kt", 1.0)?);
    if kr.mean() != kt.mean() {
        let what = "glass with different colours for reflection and transmission uses the transmitted colour for both";
        pbrt.oddities.note(what, || list.place("Kt"));
    }
    let index = pbrt.old_index(list)?;
    let mut spec = Spec::new("", "dielectric").with("eta", index);
    pbrt.set(&mut spec, "tint", kt, list.place("Kt"));
    // Here zero means smooth, despite the polynomial.
    let is_smooth = ["roughness", "uroughness", "vroughness"].iter().all(|name| !list.has(name))
        || (list.texture("uroughness").is_none() && list.number("uroughness")?.unwrap_or(0.0) == 0.0);
    if !is_smooth {
        pbrt.set_roughness(&mut spec, list, OWN, 0.0, true, PLAIN)?;
    }
    list.has("remaproughness");
    Ok(Some(spec))
}

pub(super) fn translucent(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let reflect = pbrt.texture_or(list, "reflect", 0.5)?.mean();
    let what = "diffuse transmission is not supported here";
    pbrt.oddities.note(what, || list.at.clone());
    list.has("transmit");
    let mut spec = match plastic(pbrt, list)? {
        Some(spec) => spec,
        None => return Ok(None),
    };
    let weight = reflect.luminance();
    if let Some((bilux_scene::Value::List(_), _)) = spec.parameters.find("base_color") {
        let kd = pbrt.texture_or(list, "Kd", 0.25)?.scaled(Rgb::grey(weight));
        pbrt.set(&mut spec, "base_color", kd, list.place("Kd"));
    }
    Ok(Some(spec))
}

/// Maps the parameters that the Disney material shares with `principled`.
pub(super) fn disney(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let mut spec = Spec::new("", "principled");
    let colour = pbrt.texture_or(list, "color", 0.5)?;
    pbrt.set(&mut spec, "base_color", colour, list.place("color"));
    for (theirs, ours, default) in [
        ("metallic", "base_metalness", 0.0),
        ("roughness", "specular_roughness", 0.5),
        ("anisotropic", "specular_roughness_anisotropy", 0.0),
        ("spectrans", "transmission_weight", 0.0),
        ("clearcoat", "coat_weight", 0.0),
    ] {
        let source = pbrt.float_texture(list, theirs)?.unwrap_or(TextureOrValue::Colour(Rgb::grey(default)));
        let value = pbrt.number_value(source, [0.0, 1.0]);
        spec.parameters.set_at(ours, value, list.place(theirs));
    }
    let index = pbrt.index(list, "eta")?.unwrap_or(1.5);
    spec.parameters.set("specular_ior", index.clamp(1.0, 10.0));
    let gloss = list.finite("clearcoatgloss", 1.0)?.clamp(0.0, 1.0);
    // The alpha of its clear coat ranges from a tenth to a thousandth.
    spec.parameters.set("coat_roughness", (0.1 + (0.001 - 0.1) * gloss).sqrt());
    spec.parameters.set("coat_ior", 1.5f32);
    for name in ["speculartint", "sheen", "sheentint", "flatness", "difftrans", "scatterdistance", "thin"] {
        if list.has(name) {
            let what = format!("'{name}' of a pbrt-v3 material is not supported");
            pbrt.oddities.note(&what, || list.place(name));
        }
    }
    Ok(Some(spec))
}

//! Materials that exist only in version 3.

use super::super::loader::SpectrumType;
use super::super::parameters::ParameterList;
use super::maker::MaterialMaker;
use super::plain::Metal;
use super::roughness::{OWN, PLAIN, PRINCIPLED};
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::Rgb;
use bilux_scene::Spec;

impl MaterialMaker<'_, '_, '_> {
    fn texture_or(
        &mut self,
        list: &ParameterList,
        name: &'static str,
        default: f32,
    ) -> Result<TextureOrValue, FormatError> {
        Ok(self
            .textures
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

pub(super) fn matte(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kd = maker.texture_or(list, "Kd", 0.5)?;
    if list.number("sigma")?.unwrap_or(0.0) != 0.0 {
        let what = "'sigma' of a matte material is not supported: the surface is Lambertian";
        maker.note(what, || list.place("sigma"));
    }
    let mut spec = Spec::new("", "diffuse");
    maker.set(&mut spec, "reflectance", kd, list.place("Kd"));
    Ok(Some(spec))
}

/// A diffuse base below a dielectric boundary; `Ks` scales the reflection of the boundary.
pub(super) fn plastic(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kd = maker.texture_or(list, "Kd", 0.25)?;
    let weight = maker.texture_or(list, "Ks", 0.25)?.mean().luminance();
    let index = maker.old_index(list)?.max(1.0);
    for name in ["Kr", "Kt", "mfp"] {
        if list.has(name) {
            let what = format!("'{name}' of a pbrt-v3 material is not supported");
            maker.note(&what, || list.place(name));
        }
    }
    let mut spec = Spec::new("", "principled").with("specular_ior", index);
    maker.set(&mut spec, "base_color", kd, list.place("Kd"));
    spec.parameters.set("specular_weight", weight.clamp(0.0, 1.0));
    if let Some(opacity) = maker.textures.texture_or_value(list, "opacity", SpectrumType::Surface)? {
        let grey = opacity.mapped(|c| Rgb::grey(c.luminance()), maker.loader().reading)?;
        let value = maker.textures.number_value(grey, [0.0, 1.0]);
        spec.parameters.set_at("opacity", value, list.place("opacity"));
    }
    maker.set_roughness(&mut spec, list, OWN, 0.1, true, PRINCIPLED)?;
    Ok(Some(spec))
}

pub(super) fn metal(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let mut spec = Spec::new("", "conductor");
    match maker.metal(list, ["eta", "k"])? {
        Metal::Reflectance(source) => maker.set_reflectance(&mut spec, source, list),
        Metal::Indices([eta, k]) => {
            spec.parameters.set("eta", eta);
            spec.parameters.set("k", k);
        }
    }
    maker.set_roughness(&mut spec, list, OWN, 0.01, true, PLAIN)?;
    Ok(Some(spec))
}

pub(super) fn mirror(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let kr = maker.texture_or(list, "Kr", 0.9)?;
    let mut spec = Spec::new("", "mirror");
    maker.set(&mut spec, "reflectance", kr, list.place("Kr"));
    Ok(Some(spec))
}

pub(super) fn glass(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let (kr, kt) = (maker.texture_or(list, "Kr", 1.0)?, maker.texture_or(list, "Kt", 1.0)?);
    if kr.mean() != kt.mean() {
        let what = "glass with different colours for reflection and transmission uses the transmitted colour for both";
        maker.note(what, || list.place("Kt"));
    }
    let index = maker.old_index(list)?;
    let mut spec = Spec::new("", "dielectric").with("eta", index);
    maker.set(&mut spec, "tint", kt, list.place("Kt"));
    // Here zero means smooth, despite the polynomial.
    let is_smooth = ["roughness", "uroughness", "vroughness"].iter().all(|name| !list.has(name))
        || (list.texture("uroughness").is_none() && list.number("uroughness")?.unwrap_or(0.0) == 0.0);
    if !is_smooth {
        maker.set_roughness(&mut spec, list, OWN, 0.0, true, PLAIN)?;
    }
    list.has("remaproughness");
    Ok(Some(spec))
}

pub(super) fn translucent(
    maker: &mut MaterialMaker,
    list: &ParameterList,
) -> Result<Option<Spec>, FormatError> {
    let reflect = maker.texture_or(list, "reflect", 0.5)?.mean();
    let what = "diffuse transmission is not supported here";
    maker.note(what, || list.at.clone());
    list.has("transmit");
    let mut spec = match plastic(maker, list)? {
        Some(spec) => spec,
        None => return Ok(None),
    };
    let weight = reflect.luminance();
    if let Some((bilux_scene::Value::List(_), _)) = spec.parameters.find("base_color") {
        let kd = maker.texture_or(list, "Kd", 0.25)?.scaled(Rgb::grey(weight));
        maker.set(&mut spec, "base_color", kd, list.place("Kd"));
    }
    Ok(Some(spec))
}

/// Maps the parameters that the Disney material shares with `principled`.
pub(super) fn disney(maker: &mut MaterialMaker, list: &ParameterList) -> Result<Option<Spec>, FormatError> {
    let mut spec = Spec::new("", "principled");
    let colour = maker.texture_or(list, "color", 0.5)?;
    maker.set(&mut spec, "base_color", colour, list.place("color"));
    for (theirs, ours, default) in [
        ("metallic", "base_metalness", 0.0),
        ("roughness", "specular_roughness", 0.5),
        ("anisotropic", "specular_roughness_anisotropy", 0.0),
        ("spectrans", "transmission_weight", 0.0),
        ("clearcoat", "coat_weight", 0.0),
    ] {
        let source =
            maker.textures.float_texture(list, theirs)?.unwrap_or(TextureOrValue::Colour(Rgb::grey(default)));
        let value = maker.textures.number_value(source, [0.0, 1.0]);
        spec.parameters.set_at(ours, value, list.place(theirs));
    }
    let index = maker.index(list, "eta")?.unwrap_or(1.5);
    spec.parameters.set("specular_ior", index.clamp(1.0, 10.0));
    let gloss = list.finite("clearcoatgloss", 1.0)?.clamp(0.0, 1.0);
    // The alpha of its clear coat ranges from a tenth to a thousandth.
    spec.parameters.set("coat_roughness", (0.1 + (0.001 - 0.1) * gloss).sqrt());
    spec.parameters.set("coat_ior", 1.5f32);
    for name in ["speculartint", "sheen", "sheentint", "flatness", "difftrans", "scatterdistance", "thin"] {
        if list.has(name) {
            let what = format!("'{name}' of a pbrt-v3 material is not supported");
            maker.note(&what, || list.place(name));
        }
    }
    Ok(Some(spec))
}

//! The material of [Burley 2012], which ours resembles.

use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::Spec;
use bilux_scene::bsdf::{Albedo, FuzzAlbedo, Ggx};

/// Numbers that become textures or numbers of ours as they are.
const SAME: [(&str, &str, f32); 3] = [
    ("roughness", "specular_roughness", 0.5),
    ("metallic", "base_metalness", 0.0),
    ("spec_trans", "transmission_weight", 0.0),
];

/// The cosine-weighted mean reflectance of a white base of [Burley 2012], over directions of light and view: without its retroreflection,
/// which is proportional to the roughness, and with the two terms of that. Its sheen likewise.
const DIFFUSE: [f32; 3] = [0.9529, 0.1087, 0.0035];
const SHEEN: f32 = 0.01158;
/// Mean reflectance of a coat, weighted likewise, for a gloss of 0 and of 1.
const COAT: [f32; 2] = [0.0168, 0.0205];

/// The roughness of our fuzz that stands for sheen.
const FUZZ: f32 = 0.3;

pub(super) fn principled(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let mut spec = common(maker, plugin, &SAME, 1.0)?;
    let index = match (plugin.number("eta")?, plugin.number("specular")?) {
        (Some(eta), _) => eta as f32,
        (None, specular) => {
            // The reflectance at normal incidence is 8% of it. [Burley 2012]
            let root = (0.08 * specular.unwrap_or(0.5).clamp(0.0, 12.0) as f32).sqrt();
            2.0 / (1.0 - root).max(0.1) - 1.0
        }
    };
    let mut index = index.clamp(1.0, 10.0);
    set_base(maker, plugin, &mut spec, index)?;
    if plugin.has("clearcoat") {
        let gloss = maker.even(plugin, "clearcoat_gloss", Meaning::Number)?.map_or(0.0, Rgb::luminance);
        let gloss = gloss.clamp(0.0, 1.0);
        // As bright as there, where a highlight is not divided by the cosines; alpha is from 0.1 to 0.001.
        let share = (COAT[0] + (COAT[1] - COAT[0]) * gloss) / Albedo::new(&Ggx::new(0.05), COAT_INDEX).mean();
        let coat = maker.source_or(plugin, "clearcoat", Meaning::Number, 0.0)?.scaled(Rgb::grey(share));
        // Below a coat the boundary of the base reflects less here, but not there.
        let mean = coat.mean().luminance().clamp(0.0, 1.0);
        index /= 1.0 - mean * (1.0 - 1.0 / COAT_INDEX);
        maker.set_number(&mut spec, "coat_weight", coat, &plugin.place("clearcoat"));
        spec.parameters.set("coat_roughness", (0.1 + (0.001 - 0.1) * gloss).sqrt());
        spec.parameters.set("coat_ior", COAT_INDEX);
    }
    spec.parameters.set("specular_ior", index.clamp(1.0, 10.0));
    not_shown(maker, plugin, &["spec_tint", "flatness"])?;
    Ok(Some(spec))
}

/// The index of a coat.
const COAT_INDEX: f32 = 1.5;

/// Sets the colour of the base, which there loses nothing to the boundary above it, and that of glass, whose square root each boundary
/// has.
fn set_base(maker: &mut Maker, plugin: &Plugin, spec: &mut Spec, index: f32) -> Result<(), FormatError> {
    let at = plugin.place("base_color");
    let colour = maker.source_or(plugin, "base_color", Meaning::Surface, 0.5)?;
    let mut mean = |name, default| {
        let source = maker.source_or(plugin, name, Meaning::Number, default)?;
        Ok::<_, FormatError>(source.mean().luminance().clamp(0.0, 1.0))
    };
    let (metal, roughness) = (mean("metallic", 0.0)?, mean("roughness", 0.5)?);
    let here = 1.0 - Albedo::new(&Ggx::new(roughness * roughness), index).mean();
    let factor = metal + (1.0 - metal) * diffuse(roughness) / here;
    let base = colour.clone().mapped(|c| (c * factor).clamp(0.0, 1.0), maker.reading)?;
    maker.set(spec, "base_color", base, &at);
    if plugin.has("spec_trans") {
        let passed = colour.mapped(|c| c.map(f32::sqrt), maker.reading)?;
        maker.set(spec, "transmission_color", passed, &at);
    }
    Ok(())
}

/// The mean reflectance of a white base.
fn diffuse(roughness: f32) -> f32 {
    DIFFUSE[0] + roughness * (DIFFUSE[1] + roughness * DIFFUSE[2])
}

/// Material of walls without thickness, of which only the clear part has a boundary. [Burley 2012]
pub(super) fn thin(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    // Only what is reflected diffusely has sheen.
    let mut less = |name, share: f32| {
        let source = maker.source_or(plugin, name, Meaning::Number, 0.0)?;
        Ok::<_, FormatError>((1.0 - share * source.mean().luminance()).clamp(0.0, 1.0))
    };
    let reflected = less("spec_trans", 1.0)? * less("diff_trans", 0.5)?;
    let spec = common(maker, plugin, &[SAME[0], SAME[2]], reflected)?;
    let mut spec = spec.with("thin_walled", true).with("specular_weight", 0.0f32);
    let index = (plugin.number_or("eta", 1.5)? as f32).clamp(1.0, 10.0);
    // A pane reflects what one face does, and ours what both do: 2 F / (1 + F).
    let amplitude = (index - 1.0) / (index + 1.0);
    let of_each = amplitude / (2.0 - amplitude * amplitude).sqrt();
    spec.parameters.set("specular_ior", (1.0 + of_each) / (1.0 - of_each));
    let roughness = maker.source_or(plugin, "roughness", Meaning::Number, SAME[0].2)?;
    let factor = diffuse(roughness.mean().luminance().clamp(0.0, 1.0));
    let (colour, at) =
        (maker.source_or(plugin, "base_color", Meaning::Surface, 0.5)?, plugin.place("base_color"));
    let base = colour.clone().mapped(|c| (c * factor).clamp(0.0, 1.0), maker.reading)?;
    maker.set(&mut spec, "base_color", base, &at);
    if plugin.has("spec_trans") {
        maker.set(&mut spec, "transmission_color", colour.clone(), &at);
        let what =
            "thin walls spread what passes as much as what they reflect: in Mitsuba they spread it less";
        maker.diagnostics.remark(what, || plugin.at.clone());
    }
    if plugin.has("diff_trans") {
        // At 2, all diffuse light is transmitted.
        let share = maker.source_or(plugin, "diff_trans", Meaning::Number, 0.0)?.scaled(Rgb::grey(0.5));
        maker.set_number(&mut spec, "diffuse_transmission_weight", share, &plugin.place("diff_trans"));
        maker.set(&mut spec, "diffuse_transmission_color", colour, &at);
    }
    not_shown(maker, plugin, &["spec_tint", "flatness"])?;
    Ok(Some(spec))
}

/// Parameters that both materials have; `with_sheen` is the fraction of the surface that has sheen.
fn common(
    maker: &mut Maker,
    plugin: &Plugin,
    same: &[(&'static str, &str, f32)],
    with_sheen: f32,
) -> Result<Spec, FormatError> {
    plugin.ignore(&[
        "main_specular_sampling_rate",
        "clearcoat_sampling_rate",
        "diffuse_reflectance_sampling_rate",
    ]);
    plugin.ignore(&[
        "spec_reflect_sampling_rate",
        "spec_trans_sampling_rate",
        "diff_reflect_sampling_rate",
        "diff_trans_sampling_rate",
    ]);
    let mut spec = Spec::new("", "principled");
    for (name, key, default) in same {
        let source = maker.source_or(plugin, name, Meaning::Number, *default)?;
        maker.set_number(&mut spec, key, source, &plugin.place(name));
    }
    if plugin.has("anisotropic") {
        // An aspect of sqrt(1 - 0.9 a), by which alpha is divided along u and multiplied across. [Burley 2012]
        let a = maker.even(plugin, "anisotropic", Meaning::Number)?.map_or(0.0, Rgb::luminance);
        let ratio = 1.0 - 0.9 * a.clamp(0.0, 1.0);
        spec.parameters.set("specular_roughness_anisotropy", 1.0 - ratio);
        spec.parameters.set("anisotropy_rotation", 0.25f32);
    }
    if plugin.has("sheen") {
        // ∫ albedo(µ) 2µ dµ of our fuzz.
        let fuzz = FuzzAlbedo::new(FUZZ);
        let mean: f32 =
            (0..64).map(|i| (i as f32 + 0.5) / 64.0).map(|cos| fuzz.at(cos) * 2.0 * cos / 64.0).sum();
        let sheen = maker.source_or(plugin, "sheen", Meaning::Number, 0.0)?;
        let sheen = sheen.scaled(Rgb::grey(SHEEN / mean * with_sheen));
        maker.set_number(&mut spec, "fuzz_weight", sheen, &plugin.place("sheen"));
        spec.parameters.set("fuzz_roughness", FUZZ);
        let tint =
            maker.even(plugin, "sheen_tint", Meaning::Number)?.map_or(0.0, Rgb::luminance).clamp(0.0, 1.0);
        if tint > 0.0 {
            let base = maker.source_or(plugin, "base_color", Meaning::Surface, 0.5)?.mean();
            let hue = base * (1.0 / base.luminance().max(f32::MIN_POSITIVE));
            spec.parameters.set("fuzz_color", Rgb::WHITE.lerp(hue, tint).clamp(0.0, 1.0));
        }
        let what = "sheen is rendered as fuzz that reflects as much";
        maker.diagnostics.remark(what, || plugin.place("sheen"));
    }
    Ok(spec)
}

fn not_shown(maker: &mut Maker, plugin: &Plugin, names: &[&'static str]) -> Result<(), FormatError> {
    for name in names {
        let is_there = maker.source(plugin, name, Meaning::Number)?.is_some_and(|source| !source.is_black());
        if is_there {
            let what = format!("'{name}' of {}", plugin.named());
            maker.diagnostics.not_shown(&what, || plugin.place(name));
        }
    }
    Ok(())
}

//! The material of [Burley 2012], which ours resembles.

use crate::FormatError;
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// Numbers that become textures or numbers of ours as they are.
const SAME: [(&str, &str, f32); 3] = [
    ("roughness", "specular_roughness", 0.5),
    ("metallic", "base_metalness", 0.0),
    ("spec_trans", "transmission_weight", 0.0),
];

pub(super) fn principled(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let mut spec = common(maker, plugin, &SAME)?;
    let index = match (plugin.number("eta")?, plugin.number("specular")?) {
        (Some(eta), _) => eta as f32,
        (None, specular) => {
            // The reflectance at normal incidence is 8% of it. [Burley 2012]
            let root = (0.08 * specular.unwrap_or(0.5).clamp(0.0, 12.0) as f32).sqrt();
            2.0 / (1.0 - root).max(0.1) - 1.0
        }
    };
    spec.parameters.set("specular_ior", index.clamp(1.0, 10.0));
    if plugin.has("clearcoat") {
        // A coat reflects a quarter of what its number says, with an alpha from 0.1 to 0.001.
        let coat = maker.source_or(plugin, "clearcoat", Meaning::Number, 0.0)?.scaled(Rgb::grey(0.25));
        maker.set_number(&mut spec, "coat_weight", coat, &plugin.place("clearcoat"));
        let gloss = maker.even(plugin, "clearcoat_gloss", Meaning::Number)?.map_or(0.0, Rgb::luminance);
        let alpha = 0.1 + (0.001 - 0.1) * gloss.clamp(0.0, 1.0);
        spec.parameters.set("coat_roughness", alpha.sqrt());
        spec.parameters.set("coat_ior", 1.5f32);
    }
    not_shown(maker, plugin, &["spec_tint", "flatness"])?;
    Ok(Some(spec))
}

/// The same for walls without thickness.
pub(super) fn thin(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let mut spec = common(maker, plugin, &[SAME[0], SAME[2]])?.with("thin_walled", true);
    spec.parameters.set("specular_ior", (plugin.number_or("eta", 1.5)? as f32).clamp(1.0, 10.0));
    if plugin.has("diff_trans") {
        // At 2, all diffuse light is transmitted.
        let share = maker.source_or(plugin, "diff_trans", Meaning::Number, 0.0)?.scaled(Rgb::grey(0.5));
        let colour = maker.source_or(plugin, "base_color", Meaning::Surface, 0.5)?;
        maker.set_number(&mut spec, "diffuse_transmission_weight", share, &plugin.place("diff_trans"));
        maker.set(&mut spec, "diffuse_transmission_color", colour, &plugin.place("base_color"));
    }
    not_shown(maker, plugin, &["spec_tint", "flatness"])?;
    Ok(Some(spec))
}

fn common(
    maker: &mut Maker,
    plugin: &Plugin,
    same: &[(&'static str, &str, f32)],
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
    let colour = maker.source_or(plugin, "base_color", Meaning::Surface, 0.5)?;
    maker.set(&mut spec, "base_color", colour, &plugin.place("base_color"));
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
        let sheen = maker.source_or(plugin, "sheen", Meaning::Number, 0.0)?;
        maker.set_number(&mut spec, "fuzz_weight", sheen, &plugin.place("sheen"));
        plugin.ignore(&["sheen_tint"]);
        let what = "sheen is rendered as fuzz";
        maker.oddities.remark(what, || plugin.place("sheen"));
    }
    Ok(spec)
}

fn not_shown(maker: &mut Maker, plugin: &Plugin, names: &[&'static str]) -> Result<(), FormatError> {
    for name in names {
        let is_there = maker.source(plugin, name, Meaning::Number)?.is_some_and(|source| !source.is_black());
        if is_there {
            let what = format!("'{name}' of {}", plugin.named());
            maker.oddities.not_shown(&what, || plugin.place(name));
        }
    }
    Ok(())
}

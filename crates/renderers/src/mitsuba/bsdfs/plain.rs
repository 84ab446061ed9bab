//! Materials with one layer.

use super::measured_indices;
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::{Plugin, Value};
use bilux_import::FormatError;
use bilux_import::appearance::roughness::{Keys, PLAIN, set_alphas};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::names::unknown;
use bilux_math::Rgb;
use bilux_scene::Spec;

/// The default alpha of rough materials.
const ALPHA: f32 = 0.1;

pub(super) fn diffuse(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let reflectance = maker.source_or(plugin, "reflectance", Meaning::Surface, 0.5)?;
    let mut spec = Spec::new("", "diffuse");
    maker.set(&mut spec, "reflectance", reflectance, &plugin.place("reflectance"));
    Ok(Some(spec))
}

/// Oren and Nayar's of version 0.5, whose alpha is a standard deviation in radians.
pub(super) fn rough_diffuse(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let spec = diffuse(maker, plugin)?;
    plugin.ignore(&["use_fast_approx"]);
    let alpha = maker.even(plugin, "alpha", Meaning::Number)?.map_or(0.2, Rgb::luminance);
    Ok(spec.map(|spec| spec.with("roughness", alpha.clamp(0.0, 1.0))))
}

/// Nothing but the boundary of a medium.
pub(super) fn null(_: &mut Maker, _: &Plugin) -> Result<Option<Spec>, FormatError> {
    Ok(None)
}

/// Polarisers and retarders as Mitsuba's unpolarised modes have them: they let light straight through, polarisers the half of it.
pub(super) fn filter(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    plugin.ignore(&["theta", "delta", "polarizing", "left_handed"]);
    let passed = if plugin.kind == "retarder" { 1.0 } else { 0.5 };
    let tint = maker.source_or(plugin, "transmittance", Meaning::Surface, 1.0)?.scaled(Rgb::grey(passed));
    let mut spec = Spec::new("", "dielectric").with("eta", 1.0f32).with("thin", true);
    maker.set(&mut spec, "tint", tint, &plugin.place("transmittance"));
    Ok(Some(spec))
}

/// Grey, for what cannot be described here.
pub(super) fn not_shown(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    maker.not_shown(plugin);
    grey(maker, plugin)
}

/// A grey that uses no property.
pub(super) fn grey(_: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    plugin.properties.iter().for_each(|property| property.used.set(true));
    Ok(Some(Spec::new("", "diffuse").with("reflectance", 0.5f32)))
}

impl Maker<'_, '_> {
    /// An index of refraction: a number or a name.
    pub(super) fn index(
        &mut self,
        plugin: &Plugin,
        name: &'static str,
        default: &str,
    ) -> Result<f64, FormatError> {
        let text = match plugin.find(name).map(|property| &property.value) {
            Some(Value::Text(text)) => text,
            Some(_) => return plugin.number_or(name, 1.5),
            None => default,
        };
        measured_indices::dielectric(text)
            .ok_or_else(|| unknown("dielectric", text, measured_indices::dielectrics(), &plugin.place(name)))
    }

    /// The index of the inside relative to the outside, within the supported range.
    pub(super) fn relative_index(&mut self, plugin: &Plugin, inside: &str) -> Result<f32, FormatError> {
        let (inside, outside) =
            (self.index(plugin, "int_ior", inside)?, self.index(plugin, "ext_ior", "air")?);
        let mut index = inside / outside;
        if let Some(eta) = plugin.number("eta")? {
            index = eta;
        }
        let held = if index.is_finite() { index.clamp(0.1, 10.0) } else { 1.5 };
        if held != index {
            self.note(
                "a refractive index is out of range: it is limited to 0.1 to 10",
                &plugin.place("int_ior"),
            );
        }
        Ok(held as f32)
    }

    /// Sets the roughness of a rough material, and the distribution of its microfacets where ours has a choice.
    pub(super) fn set_roughness(
        &mut self,
        spec: &mut Spec,
        plugin: &Plugin,
        keys: Keys,
    ) -> Result<(), FormatError> {
        plugin.ignore(&["sample_visible"]);
        let has_choice = keys == PLAIN;
        match plugin.text("distribution")?.unwrap_or("beckmann") {
            "ggx" => {}
            "beckmann" if has_choice => spec.parameters.set("distribution", "beckmann"),
            other if has_choice => {
                let what = format!("microfacets of '{other}' are rendered as Beckmann's");
                self.diagnostics.remark(&what, || plugin.place("distribution"));
                spec.parameters.set("distribution", "beckmann");
            }
            _ => {
                let what = "microfacets over a diffuse base are those of GGX here, whatever 'distribution' says: highlights have longer tails";
                self.diagnostics.remark(what, || plugin.at.clone());
            }
        }
        let even = self.source_or(plugin, "alpha", Meaning::Number, ALPHA)?;
        let u = self.source(plugin, "alpha_u", Meaning::Number)?.unwrap_or_else(|| even.clone());
        let v = self.source(plugin, "alpha_v", Meaning::Number)?.unwrap_or(even);
        let at = plugin.place("alpha");
        match (&u, &v) {
            (TextureOrValue::Colour(u), TextureOrValue::Colour(v)) => {
                set_alphas(spec, keys, [u.luminance(), v.luminance()], &at)
            }
            _ => {
                if plugin.has("alpha_u") {
                    let what = "roughness that differs along u and v is supported only for numbers: the one along u is used";
                    self.note(what, &at);
                }
                let root = |c: Rgb| Rgb::grey(c.luminance().clamp(0.0, 1.0).sqrt());
                let source = u.mapped(root, self.reading)?;
                self.set(spec, keys.0[0], source, &at);
            }
        }
        Ok(())
    }

    /// Names factors on reflection or transmission that are not 1.
    fn check_factors(&mut self, plugin: &Plugin, names: &[&'static str]) -> Result<(), FormatError> {
        for name in names {
            let factor = self.source(plugin, name, Meaning::Surface)?;
            if factor.is_some_and(|factor| factor.mean() != Rgb::WHITE) {
                let what = format!("'{name}' of {}", plugin.named());
                self.diagnostics.not_shown(&what, || plugin.place(name));
            }
        }
        Ok(())
    }
}

/// The factors of both reflection and transmission as a tint, if they are the same.
fn glass(maker: &mut Maker, plugin: &Plugin) -> Result<Spec, FormatError> {
    let index = maker.relative_index(plugin, "bk7")?;
    let mut spec = Spec::new("", "dielectric").with("eta", index);
    let mut factor = |name| maker.source_or(plugin, name, Meaning::Surface, 1.0);
    let (reflected, transmitted) = (factor("specular_reflectance")?, factor("specular_transmittance")?);
    if reflected.mean() != Rgb::WHITE || transmitted.mean() != Rgb::WHITE {
        if reflected.mean() != transmitted.mean() {
            let what = "glass tints reflected light as it does transmitted light";
            maker.note(what, &plugin.place("specular_transmittance"));
        }
        maker.set(&mut spec, "tint", transmitted, &plugin.place("specular_transmittance"));
    }
    Ok(spec)
}

pub(super) fn dielectric(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    glass(maker, plugin).map(Some)
}

pub(super) fn thin_dielectric(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    Ok(Some(glass(maker, plugin)?.with("thin", true)))
}

pub(super) fn rough_dielectric(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let mut spec = glass(maker, plugin)?;
    maker.set_roughness(&mut spec, plugin, PLAIN)?;
    Ok(Some(spec))
}

pub(super) fn conductor(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    metal(maker, plugin).map(|spec| Some(spec.with("roughness", 0.0f32)))
}

pub(super) fn rough_conductor(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let mut spec = metal(maker, plugin)?;
    maker.set_roughness(&mut spec, plugin, PLAIN)?;
    Ok(Some(spec))
}

/// A metal by its name or its indices; `none` is a mirror.
fn metal(maker: &mut Maker, plugin: &Plugin) -> Result<Spec, FormatError> {
    let named = plugin.text("material")?;
    let given = plugin.has("eta") || plugin.has("k");
    // Version 3 has no metal without indices: it is a mirror.
    if named.is_none_or(|name| name == "none") && !given {
        let shade = maker.source_or(plugin, "specular_reflectance", Meaning::Surface, 1.0)?;
        let mut spec = Spec::new("", "conductor");
        maker.set(&mut spec, "reflectance", shade, &plugin.at);
        plugin.ignore(&["ext_eta"]);
        return Ok(spec.with("edge", Rgb::WHITE));
    }
    let [eta, k] = match named {
        Some(name) => measured_indices::conductor(name).ok_or_else(|| {
            unknown("conductor", name, measured_indices::conductors(), &plugin.place("material"))
        })?,
        None => {
            let eta = maker.even(plugin, "eta", Meaning::Number)?.unwrap_or(Rgb::BLACK);
            [eta, maker.even(plugin, "k", Meaning::Number)?.unwrap_or(Rgb::WHITE)]
        }
    };
    let outside = if plugin.has("ext_eta") { maker.index(plugin, "ext_eta", "air")? as f32 } else { 1.0 };
    let scaled = |c: Rgb, least: f32| c.map(|c| (c / outside).clamp(least, 100.0));
    maker.check_factors(plugin, &["specular_reflectance"])?;
    Ok(Spec::new("", "conductor").with("eta", scaled(eta, 1e-3)).with("k", scaled(k, 0.0)))
}

/// Diffuse transmission of version 0.5.
pub(super) fn diffuse_transmission(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let transmittance = maker.source_or(plugin, "transmittance", Meaning::Surface, 0.5)?;
    let mut spec = Spec::new("", "translucent").with("reflectance", 0.0f32);
    maker.set(&mut spec, "transmittance", transmittance, &plugin.at);
    Ok(Some(spec))
}

/// Phong's of version 0.5: a diffuse part and a highlight without Fresnel's term.
pub(super) fn phong(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let exponent = maker.even(plugin, "exponent", Meaning::Number)?.map_or(30.0, |c| c.r);
    // The exponent of a microfacet distribution as wide. [Walter 2007]
    let alpha = (2.0 / (exponent.max(0.0) + 2.0)).sqrt();
    glossy(maker, plugin, [alpha; 2]).map(Some)
}

/// Ward's of version 0.5.
pub(super) fn ward(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    plugin.ignore(&["variant"]);
    let mut alpha = |name| {
        let even = maker.even(plugin, "alpha", Meaning::Number)?.map_or(ALPHA, |c| c.r);
        Ok::<_, FormatError>(maker.even(plugin, name, Meaning::Number)?.map_or(even, |c| c.r))
    };
    let alphas = [alpha("alpha_u")?, alpha("alpha_v")?];
    glossy(maker, plugin, alphas).map(Some)
}

fn glossy(maker: &mut Maker, plugin: &Plugin, alphas: [f32; 2]) -> Result<Spec, FormatError> {
    let what = format!("{} is rendered as a rough dielectric layer over a diffuse base", plugin.named());
    maker.note(&what, &plugin.at);
    let base = maker.source_or(plugin, "diffuse_reflectance", Meaning::Surface, 0.5)?;
    let shine = maker.even(plugin, "specular_reflectance", Meaning::Surface)?.unwrap_or(Rgb::grey(0.2));
    let mut spec = Spec::new("", "principled");
    maker.set(&mut spec, "base_color", base, &plugin.at);
    // 4% at normal incidence is a weight of 1.
    spec.parameters.set("specular_weight", (shine.luminance() / 0.04).min(1.0));
    set_alphas(&mut spec, bilux_import::appearance::roughness::PRINCIPLED, alphas, &plugin.at);
    Ok(spec)
}

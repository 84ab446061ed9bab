//! Materials below a dielectric boundary.

use super::rough_boundary::{Facets, RoughBoundary};
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::appearance::fresnel::reflected_inside;
use bilux_import::appearance::roughness::PRINCIPLED;
use bilux_math::Rgb;
use bilux_scene::bsdf::{Albedo, Ggx};
use bilux_scene::{Spec, Value};

/// The default alpha.
const ALPHA: f32 = 0.1;

/// A smooth boundary over a diffuse base.
pub(super) fn plastic(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    if plugin.kind == "pplastic" {
        return rough_plastic(maker, plugin);
    }
    let index = maker.relative_index(plugin, "polypropylene")?.max(1.0);
    let inside = reflected_inside(index);
    Ok(Some(below_boundary(maker, plugin, index, [1.0 - inside, inside])?.with("specular_roughness", 0.0f32)))
}

/// A rough boundary over a diffuse base.
pub(super) fn rough_plastic(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let index = maker.relative_index(plugin, "polypropylene")?.max(1.0);
    let alpha = maker.even(plugin, "alpha", Meaning::Number)?.map_or(ALPHA, Rgb::luminance).clamp(1e-3, 1.0);
    let facets = match plugin.text("distribution")? {
        Some("ggx") => Facets::Ggx,
        _ => Facets::Beckmann,
    };
    let here = 1.0 - Albedo::new(&Ggx::new(alpha), index).mean();
    let [factor, inside] = if plugin.kind == "pplastic" {
        // Its base loses what a smooth boundary reflects, and what that reflects back inside as well.
        let passed = index * index * (1.0 - reflected_inside(index));
        [passed * passed, 0.0]
    } else {
        let there = RoughBoundary::new(facets, alpha, index);
        [there.passed * there.passed / (index * index), there.reflected_inside]
    };
    let mut spec = below_boundary(maker, plugin, index, [factor / here, inside])?;
    maker.set_roughness(&mut spec, plugin, PRINCIPLED)?;
    Ok(Some(spec))
}

/// The factor on the colour of a base below a rough boundary whose microfacets are distributed by GGX, from Mitsuba to here.
pub(in crate::mitsuba) fn rough_base_factor(alpha: f32, index: f32) -> f32 {
    let here = 1.0 - Albedo::new(&Ggx::new(alpha), index).mean();
    let there = RoughBoundary::new(Facets::Ggx, alpha, index);
    there.passed * there.passed / (index * index) / here / (1.0 - there.reflected_inside)
}

/// A diffuse base whose colour accounts for what the boundary reflects back inside: of its own colour each time that
/// happens if it is not linear, otherwise without a change of colour.
fn below_boundary(
    maker: &mut Maker,
    plugin: &Plugin,
    index: f32,
    [factor, inside]: [f32; 2],
) -> Result<Spec, FormatError> {
    let reflectance = maker.source_or(plugin, "diffuse_reflectance", Meaning::Surface, 0.5)?;
    let changes = plugin.flag("nonlinear", false)?;
    let below = |c: f32| (c * factor / (1.0 - inside * if changes { c } else { 1.0 })).min(1.0);
    let base = match reflectance {
        // The same as without a boundary.
        _ if !changes && factor + inside == 1.0 => reflectance,
        _ => reflectance.mapped(|c| c.map(below), maker.reading)?,
    };
    let mut spec = Spec::new("", "principled").with("specular_ior", index);
    maker.set(&mut spec, "base_color", base, &plugin.place("diffuse_reflectance"));
    let shine = maker.source_or(plugin, "specular_reflectance", Meaning::Surface, 1.0)?;
    if shine.mean() != Rgb::WHITE {
        maker.set(&mut spec, "specular_color", shine, &plugin.place("specular_reflectance"));
    }
    Ok(spec)
}

/// A clear coat of version 0.5 over another material.
pub(super) fn coating(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    plugin.ignore(&["thickness", "distribution"]);
    let index = maker.relative_index(plugin, "bk7")?.max(1.0);
    let alpha = maker.even(plugin, "alpha", Meaning::Number)?.map_or(0.0, |c| c.r);
    for name in ["sigma_a", "specular_reflectance"] {
        if plugin.has(name) {
            maker.diagnostics.not_shown(&format!("'{name}' of {}", plugin.named()), || plugin.place(name));
        }
    }
    let Some(base) = maker.document.part_of(plugin, "bsdf")? else {
        return Err(plugin.missing("a bsdf below the coating"));
    };
    let Some(base) = maker.material(&base)? else { return Ok(None) };
    let mut spec = match base.kind.as_str() {
        "principled" => base,
        "diffuse" => {
            let colour = base.parameters.find("reflectance").map(|(value, _)| value.clone());
            let spec = Spec::new("", "principled").with("specular_weight", 0.0f32);
            spec.with("base_color", colour.unwrap_or(Value::from(0.5f32)))
        }
        other => {
            maker.note(&format!("a coating over {other} is not supported: it is left out"), &plugin.at);
            return Ok(Some(base));
        }
    };
    spec.parameters.set("coat_weight", 1.0f32);
    spec.parameters.set("coat_ior", index);
    spec.parameters.set("coat_roughness", alpha.clamp(0.0, 1.0).sqrt());
    Ok(Some(spec))
}

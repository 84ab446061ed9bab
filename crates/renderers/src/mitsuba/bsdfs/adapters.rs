//! Materials that change or mix others.

use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_scene::materials::{self, MaterialInputs};
use bilux_scene::{Spec, Value};
use std::rc::Rc;

/// The materials within a material.
fn inner(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Rc<Plugin>>, FormatError> {
    let found: Vec<_> = maker.document.parts_of(plugin, "bsdf")?.into_iter().map(|(_, part)| part).collect();
    if found.is_empty() {
        return Err(plugin.missing(&format!("a bsdf (within {})", plugin.named())));
    }
    Ok(found)
}

/// Surfaces have two sides here anyway.
pub(super) fn two_sided(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let sides = inner(maker, plugin)?;
    if sides.len() > 1 {
        maker.note(
            "a material of its own on the back of a surface is not supported: both have that of the front",
            &plugin.at,
        );
    }
    maker.material(&sides[0])
}

/// A material with holes.
pub(super) fn mask(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let parts = inner(maker, plugin)?;
    let opacity = maker.source_or(plugin, "opacity", Meaning::Number, 0.5)?;
    let Some(mut spec) = maker.material(&parts[0])? else { return Ok(None) };
    let value = maker.number_value(opacity, [0.0, 1.0]);
    spec.parameters.set_at("opacity", value, plugin.place("opacity"));
    Ok(Some(spec))
}

/// A mixture of two materials by a number or a texture, which is the weight of the second.
pub(super) fn blend(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let parts = inner(maker, plugin)?;
    let [a, b] = parts.as_slice() else {
        let message = format!("a blend takes two materials, not {}", parts.len());
        return Err(FormatError::malformed(message, plugin.at.clone()));
    };
    let weight = maker.source_or(plugin, "weight", Meaning::Number, 0.5)?;
    let share = maker.number_value(weight, [0.0, 1.0]);
    let (a, b) = (maker.material(a)?, maker.material(b)?);
    Ok(mixed(maker, a, b, share, plugin))
}

/// A mixture of any number of materials, of version 0.5.
pub(super) fn mixture(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let parts = inner(maker, plugin)?;
    let at = plugin.place("weights");
    let weights = plugin.text("weights")?.ok_or_else(|| plugin.missing("weights"))?;
    let weights = super::super::values::numbers(weights, "weights", &at)?;
    if weights.len() != parts.len() {
        let message = format!("{} weights for {} materials", weights.len(), parts.len());
        return Err(FormatError::malformed(message, at));
    }
    let (mut so_far, mut mixture) = (0.0, None);
    for (part, weight) in parts.iter().zip(weights) {
        let spec = maker.material(part)?;
        so_far += weight.max(0.0);
        let share = if so_far > 0.0 { (weight.max(0.0) / so_far) as f32 } else { 0.0 };
        mixture = if mixture.is_none() { spec } else { mixed(maker, mixture, spec, share.into(), plugin) };
    }
    Ok(mixture)
}

/// A mixture; with an invisible one, the other with holes.
fn mixed(maker: &mut Maker, a: Option<Spec>, b: Option<Spec>, share: Value, plugin: &Plugin) -> Option<Spec> {
    let (mut a, mut b) = match (a, b) {
        (Some(a), Some(b)) => (a, b),
        (None, Some(mut only)) => {
            only.parameters.set("opacity", share);
            return Some(only);
        }
        (Some(mut only), None) => {
            match share {
                Value::Number(share) => only.parameters.set("opacity", 1.0 - share as f32),
                _ => maker
                    .note("a material that is blended with nothing by a texture is whole here", &plugin.at),
            }
            return Some(only);
        }
        (None, None) => return None,
    };
    match share {
        Value::Number(share) if share <= 0.0 => return Some(a),
        Value::Number(share) if share >= 1.0 => return Some(b),
        _ => {}
    }
    let mut mix = Spec::new("", "mix");
    for part in [&mut a, &mut b] {
        for key in ["normal", "normal_scale"] {
            if let Some(index) = part.parameters.0.iter().position(|(known, ..)| known == key) {
                let (_, value, _) = part.parameters.0.remove(index);
                mix.parameters.set(key, value);
            }
        }
    }
    let (whole, first) = (b.clone(), maker.materials.len());
    maker.materials.extend([a, b]);
    let mix =
        mix.with("a", Value::Material(first)).with("b", Value::Material(first + 1)).with("amount", share);
    if materials::build(&mix, &MaterialInputs::new(&maker.in_scene, &maker.materials)).is_ok() {
        return Some(mix);
    }
    maker.materials.truncate(first);
    maker.note("a part of a blend cannot be mixed with the other, and is left out", &plugin.at);
    Some(whole)
}

/// A black surface, as those are that only emit.
pub(in crate::mitsuba) fn black() -> Spec {
    Spec::new("", "diffuse").with("reflectance", Rgb::BLACK)
}

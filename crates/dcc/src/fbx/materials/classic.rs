//! Phong and Lambert, as all programs write them.

use super::draft::Draft;
use crate::fbx::document::Properties;
use bilux_import::FormatError;
use bilux_import::appearance::phong;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;

/// Sets what a material of the SDK's own kinds says.
pub(super) fn fill(properties: &Properties, draft: &mut Draft) -> Result<(), FormatError> {
    let is_of_blender = draft.posed.document.settings.is_of_blender;
    let factor = |name: &str, default: f64| properties.number(name).unwrap_or(default);
    // The older name of a property holds the product of both.
    let colour = |name: &str, old: &str, factor_name: &str| {
        let product = properties.vector(name).map(|colour| colour * factor(factor_name, 1.0));
        let [r, g, b] = product.or_else(|| properties.vector(old))?.to_array().map(|c| c.max(0.0) as f32);
        Some(Rgb::new(r, g, b))
    };
    let diffuse = draft.linear(colour("DiffuseColor", "Diffuse", "DiffuseFactor").unwrap_or(Rgb::grey(0.8)));
    let map = draft.map("DiffuseColor").or(draft.map("Diffuse")).or(draft.worn.texture);
    // A texture takes the place of the colour, and the factor remains.
    let tint = Rgb::grey(factor("DiffuseFactor", 1.0).clamp(0.0, 1.0) as f32);
    draft.colour("base_color", if map.is_some() { tint } else { diffuse.clamp(0.0, 1.0) }, map)?;
    let emission = draft.linear(colour("EmissiveColor", "Emissive", "EmissiveFactor").unwrap_or(Rgb::BLACK));
    let map = draft.map("EmissiveColor");
    let strength = factor("EmissiveFactor", 1.0).max(0.0) as f32;
    match map {
        Some(_) if strength > 0.0 => draft.colour("emission", Rgb::grey(strength), map)?,
        _ if !emission.is_black() => draft.colour("emission", emission, None)?,
        _ => {}
    }
    highlight(properties, is_of_blender, draft)?;
    transparency(properties, draft)?;
    let map = draft.map("NormalMap").or(draft.map("Bump")).or(draft.map("NormalMap_Texture"));
    draft.normals(map, factor("BumpFactor", 1.0))?;
    for name in ["DisplacementColor", "VectorDisplacementColor", "ReflectionColor"] {
        if draft.map(name).is_some() {
            draft.inner.not_shown(&format!("textures of {name}"));
        }
    }
    Ok(())
}

/// Sets the specular reflection: none of Lambert's.
fn highlight(properties: &Properties, is_of_blender: bool, draft: &mut Draft) -> Result<(), FormatError> {
    let factor = properties.number("SpecularFactor").unwrap_or(1.0);
    let exponent = properties.number("ShininessExponent").or_else(|| properties.number("Shininess"));
    if is_of_blender {
        // Its exporter writes a quarter for a plastic's reflectance, (1 - roughness)² · 100, and how metallic it is.
        let roughness = exponent.map_or(0.5, |exponent| 1.0 - exponent.max(0.0).sqrt() / 10.0);
        let map = draft.map("ShininessExponent");
        let rough = if map.is_some() { 1.0 } else { roughness.clamp(0.0, 1.0) };
        draft.number("specular_roughness", rough, map, Channel::G)?;
        let map = draft.map("ReflectionFactor");
        let metal = properties.number("ReflectionFactor").unwrap_or(0.0);
        draft.number(
            "base_metalness",
            if map.is_some() { 1.0 } else { metal.clamp(0.0, 1.0) },
            map,
            Channel::B,
        )?;
        let map = draft.map("SpecularFactor");
        return draft.number(
            "specular_weight",
            if map.is_some() { 1.0 } else { (4.0 * factor).clamp(0.0, 1.0) },
            map,
            Channel::R,
        );
    }
    let node = draft.worn.material.map(|index| draft.posed.document.object(index).node);
    let model = node.and_then(|node| node.child_value("ShadingModel")).and_then(|value| value.text());
    let is_lambert = model.is_some_and(|model| model.eq_ignore_ascii_case(b"lambert"));
    let specular = properties.vector("SpecularColor").or_else(|| properties.vector("Specular"));
    let weight = specular.map_or(0.0, |specular| specular.max_element() * factor);
    let map = draft.map("SpecularColor").filter(|_| !is_lambert);
    draft.set("specular_roughness", phong::roughness(exponent.unwrap_or(20.0)));
    let weight = if is_lambert { 0.0 } else { weight.clamp(0.0, 1.0) };
    draft.number("specular_weight", if map.is_some() { 1.0 } else { weight }, map, Channel::G)
}

/// Sets the opacity. Of the properties that say it, programs write some and leave others at odd defaults.
fn transparency(properties: &Properties, draft: &mut Draft) -> Result<(), FormatError> {
    let opacity = properties.stated("Opacity").and_then(|_| properties.number("Opacity"));
    let colour = properties.vector("TransparentColor").map(|colour| colour.element_sum() / 3.0);
    let factor = properties.number("TransparencyFactor");
    // A factor that a material states alone is the whole transparency, whatever the template says of the colour.
    let is_alone =
        properties.stated("TransparentColor").is_none() && properties.stated("TransparencyFactor").is_some();
    let product = if is_alone { 1.0 } else { colour.unwrap_or(0.0) } * factor.unwrap_or(1.0);
    let transparent = match opacity {
        Some(opacity) if opacity < 1.0 || product >= 1.0 => 1.0 - opacity,
        // White times one, without an opacity, is what some exporters write for everything.
        None if product >= 1.0 => {
            let at = draft.inner.spec.span.clone();
            let what = "a material that is wholly transparent, without an opacity, is read as opaque";
            draft.inner.sink.diagnostics.note(what, || at);
            0.0
        }
        _ => product,
    };
    let map = draft.map("TransparentColor").or(draft.map("TransparencyFactor")).or(draft.map("Opacity"));
    if let Some(texture) = map.map(|map| draft.texture(map, true)).transpose()?.flatten() {
        let is_of_colours = map == draft.map("DiffuseColor");
        return match phong::opacity(texture, is_of_colours) {
            Some(opacity) => draft.inner.put("opacity", opacity),
            None => Ok(()),
        };
    }
    if transparent > 0.0 {
        draft.set("opacity", (1.0 - transparent).clamp(0.0, 1.0) as f32);
    }
    Ok(())
}

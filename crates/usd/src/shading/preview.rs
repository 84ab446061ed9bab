//! `UsdPreviewSurface`.

use super::draft::Draft;
use super::network::Input;
use super::textures::{Painted, Taken, bake, painted};
use bilux_import::FormatError;
use bilux_import::appearance::as_metal::as_metal;
use bilux_import::geometry::displacement::{Along, Displacement};
use bilux_math::Rgb;
use bilux_scene::texture::Image;
use std::sync::Arc;

/// The diffuse colour of surfaces that state none.
const UNSTATED: f32 = 0.18;

pub(super) fn preview(draft: &mut Draft) -> Result<(), FormatError> {
    if !draft.set_colour("base_color", "diffuseColor", 1.0)? {
        // The vertices have it.
        let is_white = draft.shaded.uses_colours;
        draft.set("base_color", if is_white { 1.0 } else { UNSTATED });
    }
    if !draft.set_number("specular_roughness", "roughness", 1.0)? {
        draft.set("specular_roughness", 0.5f32);
    }
    let ior = draft.number("ior")?.unwrap_or(1.5).clamp(1.0, 10.0) as f32;
    draft.set("specular_ior", ior);
    if draft.number("useSpecularWorkflow")?.unwrap_or(0.0) == 1.0 {
        specular(draft)?;
    } else {
        draft.set_number("base_metalness", "metallic", 1.0)?;
    }
    if draft.is_textured("clearcoat")? || draft.number("clearcoat")?.unwrap_or(0.0) > 0.0 {
        draft.set_number("coat_weight", "clearcoat", 1.0)?;
        if !draft.set_number("coat_roughness", "clearcoatRoughness", 1.0)? {
            draft.set("coat_roughness", 0.01f32);
        }
        // One index is that of all specular parts, the coat among them. [UsdPreviewSurface, ior]
        draft.set("coat_ior", ior);
    }
    let emits =
        draft.is_textured("emissiveColor")? || draft.colour("emissiveColor")?.is_some_and(|c| !c.is_black());
    if emits {
        draft.set_colour("emission", "emissiveColor", 1.0)?;
    }
    opacity(draft)?;
    normal(draft, "normal")?;
    displacement(draft)
}

const CONSTANT: &str = "displacement without a picture";

/// Heights along the normal, in lengths of the mesh.
fn displacement(draft: &mut Draft) -> Result<(), FormatError> {
    if draft.number("displacement")?.unwrap_or(0.0) != 0.0 {
        draft.not_shown(CONSTANT);
    }
    let Input::Node(node, output) = draft.input("displacement")? else { return Ok(()) };
    let taken = Taken { is_data: true, factor: 1.0, threshold: None };
    let at = draft.stage.at(node);
    match painted(draft, node, &output, taken)? {
        Some(Painted::Texture(map)) => {
            let along = Along::Normal;
            draft.shaded.displacement = Some(Displacement { map, along, scale: 1.0, middle: 0.0, at });
        }
        Some(Painted::Constant(height)) if height.r != 0.0 => draft.not_shown(CONSTANT),
        _ => {}
    }
    Ok(())
}

/// The root of the greatest reflectance that an index of refraction gives, which is at most 10.
const MOST: f32 = 9.0 / 11.0;

/// The reflectance at normal incidence, by the index of refraction of its greatest channel.
fn specular(draft: &mut Draft) -> Result<(), FormatError> {
    let colour = match draft.input("specularColor")? {
        Input::Node(node, output) => {
            let taken = Taken { is_data: false, factor: 1.0, threshold: None };
            match painted(draft, node, &output, taken)? {
                Some(Painted::Texture(mut map)) => {
                    // The index is that of the brightest texel, of which the others are fractions.
                    let greatest = map.texels().map(Rgb::max_channel).fold(0.0, f32::max);
                    let root = greatest.clamp(1e-6, MOST * MOST).sqrt();
                    map.factor *= 1.0 / (root * root);
                    draft.set("specular_ior", (1.0 + root) / (1.0 - root));
                    return draft.set_texture("specular_color", map);
                }
                Some(Painted::Constant(colour)) => Some(colour),
                None => None,
            }
        }
        _ => draft.colour("specularColor")?,
    };
    let colour = colour.unwrap_or(Rgb::BLACK).clamp(0.0, 1.0);
    let greatest = colour.max_channel();
    if greatest <= 0.0 {
        draft.set("specular_weight", 0.0f32);
        return Ok(());
    }
    let root = greatest.sqrt();
    if root > MOST && !draft.is_textured("diffuseColor")? {
        // No dielectric reflects so much.
        let diffuse = draft.colour("diffuseColor")?.unwrap_or(Rgb::grey(UNSTATED));
        let (base, metalness) = as_metal(diffuse, colour);
        draft.set("base_color", base);
        draft.set("base_metalness", metalness);
        return Ok(());
    }
    let root = root.min(MOST);
    draft.set("specular_ior", (1.0 + root) / (1.0 - root));
    draft.set("specular_color", colour * (1.0 / greatest));
    Ok(())
}

fn opacity(draft: &mut Draft) -> Result<(), FormatError> {
    let threshold = draft.number("opacityThreshold")?.unwrap_or(0.0) as f32;
    let threshold = (threshold > 0.0).then_some(threshold);
    match draft.input("opacity")? {
        Input::Node(node, output) => {
            let taken = Taken { is_data: true, factor: 1.0, threshold };
            match painted(draft, node, &output, taken)? {
                Some(Painted::Texture(found)) => draft.set_texture("opacity", found)?,
                Some(Painted::Constant(opacity)) => draft.set("opacity", opacity.r.clamp(0.0, 1.0)),
                None => {}
            }
        }
        Input::Value(found) => {
            let opacity = found.value.number().unwrap_or(1.0).clamp(0.0, 1.0) as f32;
            let opacity = threshold.map_or(opacity, |threshold| if opacity < threshold { 0.0 } else { 1.0 });
            if opacity < 1.0 {
                draft.set("opacity", opacity);
            }
        }
        Input::Nothing => {}
    }
    Ok(())
}

/// A normal map: usually the picture's numbers from -1 to 1, by a scale of 2 and a bias of -1.
pub(super) fn normal(draft: &mut Draft, name: &str) -> Result<(), FormatError> {
    let Input::Node(node, output) = draft.input(name)? else { return Ok(()) };
    let taken = Taken { is_data: true, factor: 1.0, threshold: None };
    let plain = plain_scale(draft, node)?;
    let Some(Painted::Texture(mut found)) = painted(draft, node, &output, taken)? else { return Ok(()) };
    // One with a border is another image.
    let is_whole =
        |original: &Arc<Image>| (original.width, original.height) == (found.image.width, found.image.height);
    if let Some(original) = plain.filter(is_whole) {
        found.image = original;
        found.is_data = true;
        found.factor = Rgb::WHITE;
    } else if found.factor != Rgb::WHITE || !found.image.is_bytes() {
        // Ours are from 0 to 1.
        let factor = found.factor;
        bake(draft, &mut found, |texel| (texel * factor).map(|x| 0.5 * x + 0.5))?;
        found.factor = Rgb::WHITE;
    }
    found.channel = None;
    draft.shaded.has_direction = true;
    draft.set_texture("normal", found)
}

/// The image of a normal map whose scale and bias are the usual ones.
fn plain_scale(draft: &mut Draft, node: u32) -> Result<Option<Arc<Image>>, FormatError> {
    use super::network::constant;
    let stage = draft.stage;
    let budget = &mut draft.reading.budget;
    let mut three = |name: &str| -> Result<Option<[f64; 3]>, FormatError> {
        let found = constant(stage, node, name, budget)?.and_then(|found| found.value.tuple::<4>());
        Ok(found.map(|[a, b, c, _]| [a, b, c]))
    };
    let is_usual = three("scale")? == Some([2.0; 3]) && three("bias")? == Some([-1.0; 3]);
    let Some(file) = constant(stage, node, "file", budget)?.filter(|_| is_usual) else { return Ok(None) };
    let folder = stage.layers[file.layer as usize].folder.clone();
    let Some(name) = file.value.text() else { return Ok(None) };
    let meaning = bilux_import::input::reading::Texels::Numbers(None);
    let found = draft.reading.texture(folder.as_deref(), name, meaning, &stage.at(node));
    Ok(found.ok().map(|texture| texture.image.clone()))
}

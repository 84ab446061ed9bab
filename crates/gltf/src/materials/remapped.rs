//! Textures whose texels are converted: directions to angles, and thin-film thicknesses to micrometres.

use crate::document::json::JsonNode;
use crate::materials::draft::Draft;
use crate::materials::textures::{ChannelSelection, Textures};
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_math::transcendental::atan2;
use bilux_scene::texture::{Channel, Filter, Image, Texels};
use bilux_scene::{Texture, Value};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Reads a thin film. glTF states the thickness in nm; a texture interpolates between a minimum and a maximum.
pub(crate) fn film<'d>(node: JsonNode<'d>, draft: &mut Draft<'d, '_>) -> Result<(), FormatError> {
    let Some(extension) = node.extension("KHR_materials_iridescence") else { return Ok(()) };
    let weight = extension.number("iridescenceFactor")?.unwrap_or(0.0);
    if weight <= 0.0 {
        return Ok(());
    }
    let at = extension.at();
    let picture = extension.get("iridescenceTexture");
    draft.scalar("thin_film_weight", weight, picture, Channel::R, &at)?;
    let ior = extension.number("iridescenceIor")?.unwrap_or(1.3);
    draft.set("thin_film_ior", ior as f32, at.clone());
    let least = extension.number("iridescenceThicknessMinimum")?.unwrap_or(100.0);
    let most = extension.number("iridescenceThicknessMaximum")?.unwrap_or(400.0);
    let thickness = match extension.get("iridescenceThicknessTexture") {
        Some(info) => thickness(info, [least, most], draft)?,
        None => ((most / 1000.0) as f32).into(),
    };
    draft.set("thin_film_thickness", thickness, at);
    Ok(())
}

/// Converts directions along the surface, in red and green, to turns from 0 to 1, offset by `turns`.
pub(crate) fn angles<'d>(
    info: JsonNode<'d>,
    turns: f64,
    draft: &mut Draft<'d, '_>,
) -> Result<Value, FormatError> {
    let taken = ChannelSelection::channel(Channel::R, 1.0);
    let angle = |texel: Rgb| {
        let (x, y) = (texel.r * 2.0 - 1.0, texel.g * 2.0 - 1.0);
        (atan2(y, x) / TAU + turns as f32).rem_euclid(1.0)
    };
    // Interpolating between one turn and zero would give half a turn.
    let nearest = |texture| Texture { filter: Filter::Nearest, ..texture };
    let texture = draft.looked_up(info, taken)?;
    let texture = nearest(remapped(texture, angle, &mut draft.textures)?);
    draft.textures.add(texture)
}

/// Thicknesses in µm that run from the first to the second, both in nm, as green goes from 0 to 1.
fn thickness<'d>(
    info: JsonNode<'d>,
    [first, second]: [f64; 2],
    draft: &mut Draft<'d, '_>,
) -> Result<Value, FormatError> {
    let [first, second] = [first, second].map(|nm| (nm.max(0.0) / 1000.0) as f32);
    let greatest = first.max(second);
    if greatest == 0.0 {
        return Ok(0.0f32.into());
    }
    let texture = draft.looked_up(info, ChannelSelection::channel(Channel::R, f64::from(greatest)))?;
    let part = |texel: Rgb| (first + (second - first) * texel.g) / greatest;
    let texture = remapped(texture, part, &mut draft.textures)?;
    draft.textures.add(texture)
}

/// A texture with each texel replaced by a number from 0 to 1; a missing image stays as it is.
fn remapped(
    texture: Texture,
    number: impl Fn(Rgb) -> f32,
    textures: &mut Textures,
) -> Result<Texture, FormatError> {
    let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    let texels = match &texture.image.texels {
        Texels::Bytes(bytes) => {
            textures.take_bytes(size_of_val(&bytes[..]) as u64)?;
            let plain = |[r, g, b, _]: [u8; 4]| Rgb::from_array([r, g, b].map(|c| f32::from(c) / 255.0));
            Texels::Bytes(bytes.iter().map(|&texel| [byte(number(plain(texel))); 4]).collect())
        }
        Texels::Floats { colours, .. } => {
            textures.take_bytes(size_of_val(&colours[..]) as u64)?;
            let colours = colours.iter().map(|&texel| Rgb::grey(number(texel))).collect();
            Texels::Floats { colours, alpha: Vec::new() }
        }
        Texels::Formula(_) => return Ok(texture),
    };
    let image = Image { width: texture.image.width, height: texture.image.height, texels };
    Ok(Texture { image: Arc::new(image), ..texture })
}

//! Nodes that read pictures.

use super::draft::Draft;
use super::folding::{Folded, Linear, folded};
use super::network::{constant, kind};
use super::placing::placing;
use crate::stage::Found;
use crate::value::Value;
use bilux_import::FormatError;
use bilux_import::reading::Texels as Meaning;
use bilux_math::Rgb;
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels, Wrap};
use std::sync::Arc;

/// What a parameter takes of a texture.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    /// Numbers rather than colours.
    pub(super) is_data: bool,
    pub(super) factor: f32,
    pub(super) threshold: Option<f32>,
}

/// What the output of a node gives a parameter.
pub(super) enum Painted {
    Texture(Texture),
    Constant(Rgb),
}

/// The texture or the constant that the output of a node is; `None`, with a note, for nodes that are not read.
pub(super) fn painted(
    draft: &mut Draft,
    node: u32,
    output: &str,
    taken: Taken,
) -> Result<Option<Painted>, FormatError> {
    let linear = match folded(draft, node, output)? {
        Some(Folded::Constant(colour)) => {
            return Ok(Some(Painted::Constant(Rgb::from_array(colour) * taken.factor)));
        }
        Some(Folded::Linear(linear)) => linear,
        None => return Ok(None),
    };
    let id = kind(draft.stage, linear.node, &mut draft.reading.budget)?;
    let name = id.strip_prefix("ND_").unwrap_or(&id);
    if name.starts_with("UsdPrimvarReader") || name.starts_with("geom") {
        return vertex_colours(draft, linear.node, name);
    }
    picture(draft, &linear, taken, name.starts_with("UsdUVTexture"))
}

/// The colours of vertices in place of a texture: the material is then white, and the mesh has the colours.
fn vertex_colours(draft: &mut Draft, node: u32, id: &str) -> Result<Option<Painted>, FormatError> {
    let budget = &mut draft.reading.budget;
    let name = match constant(draft.stage, node, "varname", budget)? {
        Some(found) => Some(found),
        None => constant(draft.stage, node, "geomprop", budget)?,
    };
    match name.as_ref().and_then(|found| found.value.text()).map(|text| &**text) {
        Some("displayColor") => draft.shaded.uses_colours = true,
        Some("displayOpacity") => draft.shaded.uses_opacities = true,
        other => {
            let what =
                format!("primvars read by {id} other than displayColor ({})", other.unwrap_or("unnamed"));
            draft.not_shown(&what);
        }
    }
    Ok(None)
}

fn picture(
    draft: &mut Draft,
    linear: &Linear,
    taken: Taken,
    is_preview: bool,
) -> Result<Option<Painted>, FormatError> {
    let (stage, node) = (draft.stage, linear.node);
    let budget = &mut draft.reading.budget;
    let Some(file) = constant(stage, node, "file", budget)? else { return Ok(None) };
    let space = constant(stage, node, "sourceColorSpace", budget)?;
    let stated = stage.metadata(node, "inputs:file", "colorSpace");
    let stated =
        space.as_ref().and_then(|found| found.value.text()).or(stated.as_ref().and_then(Value::text));
    let is_raw = match stated.map(|text| text.to_ascii_lowercase()) {
        Some(text) if text == "raw" || text.contains("lin") || text.contains("data") => true,
        Some(text) if text.contains("srgb") => false,
        // What is not said follows from what it is for.
        _ => taken.is_data,
    };
    let channel = match &*linear.output {
        "r" | "outr" => Some(Channel::R),
        "g" | "outg" => Some(Channel::G),
        "b" | "outb" => Some(Channel::B),
        "a" | "outa" => Some(Channel::A),
        _ => None,
    };
    let mut texture = match loaded(draft, node, &file, is_raw)? {
        Ok(Some(texture)) => texture,
        Ok(None) => return Ok(None),
        Err(name) => {
            let key = if is_preview { "fallback" } else { "default" };
            match constant(stage, node, key, &mut draft.reading.budget)? {
                Some(stated) => return Ok(instead(&stated, channel, linear, taken)),
                None => Texture::missing(&name),
            }
        }
    };
    let keys = if is_preview { ["wrapS", "wrapT"] } else { ["uaddressmode", "vaddressmode"] };
    for (wrap, key) in texture.wrap.iter_mut().zip(keys) {
        *wrap = wrapping(constant(stage, node, key, &mut draft.reading.budget)?);
    }
    let placing = placing(draft, node, is_preview)?;
    texture.transform = placing.transform;
    let uvs = &mut draft.shaded.uvs;
    let slot = uvs.iter().position(|slot| slot.as_ref().is_none_or(|known| *known == placing.name));
    match slot {
        Some(slot) => uvs[slot] = Some(placing.name),
        None => draft.not_shown("a third set of texture coordinates"),
    }
    texture.second_uv = slot == Some(1);
    texture.channel = channel.or(linear.channel);
    texture.threshold = taken.threshold;
    change(draft, linear, &mut texture, taken)?;
    Ok(Some(Painted::Texture(texture)))
}

/// The colour that a node states for a picture that cannot be read [UsdPreviewSurface, `fallback`; MaterialX, `default`].
fn instead(stated: &Found, channel: Option<Channel>, linear: &Linear, taken: Taken) -> Option<Painted> {
    let value = &stated.value;
    let opaque = |[r, g, b]: [f64; 3]| [r, g, b, 1.0];
    let four = value.tuple::<4>().or_else(|| value.tuple::<3>().map(opaque));
    let four = four.or_else(|| value.number().map(|grey| opaque([grey; 3])))?.map(|x| x as f32);
    let three = channel.map_or([four[0], four[1], four[2]], |channel| [four[channel as usize]; 3]);
    let colour = std::array::from_fn(|i| three[i] * linear.scale[i] + linear.offset[i]);
    Some(Painted::Constant(Rgb::from_array(colour) * taken.factor))
}

/// Applies the scale and the bias of a node, and what further nodes do: as a factor where that is enough, otherwise in a copy of the
/// image.
fn change(
    draft: &mut Draft,
    linear: &Linear,
    texture: &mut Texture,
    taken: Taken,
) -> Result<(), FormatError> {
    let stage = draft.stage;
    let budget = &mut draft.reading.budget;
    let mut four = |name: &str, default: f64| -> Result<[f32; 4], FormatError> {
        let found = constant(stage, linear.node, name, budget)?;
        Ok(found.and_then(|found| found.value.tuple::<4>()).unwrap_or([default; 4]).map(|x| x as f32))
    };
    let (scale, bias) = (four("scale", 1.0)?, four("bias", 0.0)?);
    let picked = texture.channel.map(|channel| channel as usize);
    let three = |four: [f32; 4]| picked.map_or([four[0], four[1], four[2]], |channel| [four[channel]; 3]);
    let (scale, bias) = (three(scale), three(bias));
    let factor: [f32; 3] = std::array::from_fn(|i| scale[i] * linear.scale[i]);
    let offset: [f32; 3] = std::array::from_fn(|i| bias[i] * linear.scale[i] + linear.offset[i]);
    if offset == [0.0; 3] {
        texture.factor = Rgb::from_array(factor) * taken.factor;
        return Ok(());
    }
    texture.factor = Rgb::grey(taken.factor);
    bake(draft, texture, |texel| {
        let all: [f32; 3] = std::array::from_fn(|i| texel.to_array()[i] * factor[i] + offset[i]);
        Rgb::from_array(all)
    })
}

/// Replaces the texels of a texture by others, of the channel that is used.
pub(super) fn bake(
    draft: &mut Draft,
    texture: &mut Texture,
    change: impl Fn(Rgb) -> Rgb,
) -> Result<(), FormatError> {
    let (width, height) = (texture.image.width, texture.image.height);
    let plain = Texture { factor: Rgb::WHITE, ..texture.clone() };
    let image = Image { width, height, texels: Texels::Floats { colours: Vec::new(), alpha: Vec::new() } };
    draft.reading.budget.take_bytes((12 * width * height) as u64, &texture.name)?;
    let mut colours = Vec::with_capacity(width * height);
    for y in 0..height {
        colours.extend((0..width).map(|x| change(plain.texel(x, y))));
    }
    texture.image = Arc::new(Image { texels: Texels::Floats { colours, alpha: Vec::new() }, ..image });
    texture.is_data = true;
    texture.channel = texture.channel.map(|_| Channel::R);
    Ok(())
}

/// The picture in a file; a placeholder, with a warning, if it cannot be read.
/// The picture; `Err` with its name, and a note, if it cannot be read.
fn loaded(
    draft: &mut Draft,
    node: u32,
    file: &Found,
    is_raw: bool,
) -> Result<Result<Option<Texture>, String>, FormatError> {
    let Some(name) = file.value.text().filter(|name| !name.is_empty()) else { return Ok(Ok(None)) };
    let mut name = name.to_string();
    if name.contains("<UDIM>") {
        name = name.replace("<UDIM>", "1001");
        draft.not_shown("tiles of textures other than the first (UDIM)");
    }
    let at = draft.stage.at(node);
    let folder = draft.stage.layers[file.layer as usize].folder.clone();
    let meaning = if is_raw { Meaning::Numbers(None) } else { Meaning::Colours };
    match draft.reading.texture(folder.as_deref(), &name, meaning, &at) {
        Ok(texture) => Ok(Ok(Some(Texture { channel: None, ..Texture::clone(&texture) }))),
        Err(error @ FormatError::TooLarge { .. }) => Err(error),
        Err(error) => {
            draft.sink.oddities.note(&error.without_place(), || at);
            Ok(Err(name))
        }
    }
}

fn wrapping(mode: Option<Found>) -> Wrap {
    match mode.as_ref().and_then(|found| found.value.text()).map(|text| &**text) {
        Some("clamp" | "black" | "constant") => Wrap::Clamp,
        Some("mirror") => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

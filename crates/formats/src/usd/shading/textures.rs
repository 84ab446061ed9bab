//! Nodes that read pictures.

use super::draft::Draft;
use super::network::{Input, constant, input, kind};
use crate::FormatError;
use crate::reading::Texels as Meaning;
use crate::usd::stage::Found;
use crate::usd::value::{Text, Value};
use bilux_math::Rgb;
use bilux_math::transcendental::sin_cos;
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels, UvTransform, Wrap};
use std::sync::Arc;

/// What a parameter takes of a texture.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    /// Numbers rather than colours.
    pub(super) is_data: bool,
    pub(super) factor: f32,
    pub(super) threshold: Option<f32>,
}

/// The primvar of texture coordinates, and what is done to them.
struct Placing {
    name: Text,
    transform: Option<UvTransform>,
}

/// Nodes in a row that only move texture coordinates or pass colours on.
const MAX_CHAIN: usize = 16;

/// The texture that the output of a node is; `None`, with a note, for nodes that are not read.
pub(super) fn texture(
    draft: &mut Draft,
    node: u32,
    output: &str,
    taken: Taken,
) -> Result<Option<Texture>, FormatError> {
    let (mut node, mut output) = (node, output.to_owned());
    for _ in 0..MAX_CHAIN {
        let id = kind(draft.stage, node, &mut draft.reading.budget)?;
        let name = id.strip_prefix("ND_").unwrap_or(&id);
        if name.starts_with("UsdUVTexture") || name.starts_with("image_") || name.starts_with("tiledimage_") {
            return picture(draft, node, &output, taken, name.starts_with("UsdUVTexture"));
        }
        if name.starts_with("UsdPrimvarReader")
            || name.starts_with("geompropvalue")
            || name.starts_with("geomcolor")
        {
            return vertex_colours(draft, node, name);
        }
        // These pass on what they get, or change it in a way that a texture cannot.
        let passes =
            ["normalmap", "convert", "extract", "separate", "swizzle", "colorcorrect", "multiply", "dot"];
        if !passes.iter().any(|start| name.starts_with(start)) {
            break;
        }
        if !name.starts_with("normalmap") && !name.starts_with("convert") && !name.starts_with("dot") {
            draft.not_shown(&format!("what nodes {name} do to textures"));
        }
        let mut next = Input::Nothing;
        for key in ["in", "in1", "in2"] {
            if !matches!(next, Input::Node(..)) {
                next = input(draft.stage, node, key, &mut draft.reading.budget)?;
            }
        }
        let Input::Node(before, of) = next else { break };
        (node, output) = (before, of.to_string());
    }
    let id = kind(draft.stage, node, &mut draft.reading.budget)?;
    draft.not_shown(&format!("shaders {}", if id.is_empty() { "without an identifier" } else { &id }));
    Ok(None)
}

/// The colours of vertices in place of a texture: the material is then white, and the mesh has the colours.
fn vertex_colours(draft: &mut Draft, node: u32, id: &str) -> Result<Option<Texture>, FormatError> {
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
    node: u32,
    output: &str,
    taken: Taken,
    is_preview: bool,
) -> Result<Option<Texture>, FormatError> {
    let stage = draft.stage;
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
    let channel = match output {
        "r" | "outr" => Some(Channel::R),
        "g" | "outg" => Some(Channel::G),
        "b" | "outb" => Some(Channel::B),
        "a" | "outa" => Some(Channel::A),
        _ => None,
    };
    let Some(mut texture) = loaded(draft, node, &file, is_raw)? else { return Ok(None) };
    let keys = if is_preview { ["wrapS", "wrapT"] } else { ["uaddressmode", "vaddressmode"] };
    for (wrap, key) in texture.wrap.iter_mut().zip(keys) {
        *wrap = wrapping(constant(stage, node, key, &mut draft.reading.budget)?);
    }
    let placing = placing(draft, node, if is_preview { "st" } else { "texcoord" })?;
    texture.transform = placing.transform;
    if !is_preview && let Some(tiles) = constant(stage, node, "uvtiling", &mut draft.reading.budget)? {
        let [x, y] = tiles.value.tuple::<2>().unwrap_or([1.0; 2]).map(|x| x as f32);
        texture.transform = Some(UvTransform::from_array([x, 0.0, 0.0, y, 0.0, 1.0 - y]));
    }
    let uvs = &mut draft.shaded.uvs;
    let slot = uvs.iter().position(|slot| slot.as_ref().is_none_or(|known| *known == placing.name));
    match slot {
        Some(slot) => uvs[slot] = Some(placing.name),
        None => draft.not_shown("a third set of texture coordinates"),
    }
    texture.second_uv = slot == Some(1);
    texture.channel = channel;
    texture.threshold = taken.threshold;
    change(draft, node, &mut texture, taken)?;
    Ok(Some(texture))
}

/// Applies the scale and the bias of a node: as a factor where that is enough, otherwise in a copy of the image.
fn change(draft: &mut Draft, node: u32, texture: &mut Texture, taken: Taken) -> Result<(), FormatError> {
    let stage = draft.stage;
    let budget = &mut draft.reading.budget;
    let mut four = |name: &str, default: f64| -> Result<[f32; 4], FormatError> {
        let found = constant(stage, node, name, budget)?;
        Ok(found.and_then(|found| found.value.tuple::<4>()).unwrap_or([default; 4]).map(|x| x as f32))
    };
    let (scale, bias) = (four("scale", 1.0)?, four("bias", 0.0)?);
    let picked = texture.channel.map(|channel| channel as usize);
    texture.factor = match picked {
        Some(channel) => Rgb::grey(scale[channel] * taken.factor),
        None => Rgb::new(scale[0], scale[1], scale[2]) * taken.factor,
    };
    if bias == [0.0; 4] {
        return Ok(());
    }
    let offset = picked.map_or([bias[0], bias[1], bias[2]], |channel| [bias[channel]; 3]);
    texture.factor = Rgb::grey(taken.factor);
    let scale = picked.map_or([scale[0], scale[1], scale[2]], |channel| [scale[channel]; 3]);
    bake(draft, texture, |texel| {
        let all: [f32; 3] = std::array::from_fn(|i| texel.to_array()[i] * scale[i] + offset[i]);
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
fn loaded(draft: &mut Draft, node: u32, file: &Found, is_raw: bool) -> Result<Option<Texture>, FormatError> {
    let Some(name) = file.value.text().filter(|name| !name.is_empty()) else { return Ok(None) };
    let mut name = name.to_string();
    if name.contains("<UDIM>") {
        name = name.replace("<UDIM>", "1001");
        draft.not_shown("tiles of textures other than the first (UDIM)");
    }
    let at = draft.stage.at(node);
    let folder = draft.stage.layers[file.layer as usize].folder.clone();
    let meaning = if is_raw { Meaning::Numbers(None) } else { Meaning::Colours };
    match draft.reading.texture(folder.as_deref(), &name, meaning, &at) {
        Ok(texture) => Ok(Some(Texture { channel: None, ..Texture::clone(&texture) })),
        Err(error @ FormatError::TooLarge { .. }) => Err(error),
        Err(error) => {
            draft.sink.oddities.note(&error.without_place(), || at);
            Ok(Some(Texture::missing(&name)))
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

/// Where the texture coordinates of a node come from.
fn placing(draft: &mut Draft, node: u32, name: &str) -> Result<Placing, FormatError> {
    let stage = draft.stage;
    let budget = &mut draft.reading.budget;
    let mut placing = Placing { name: "st".into(), transform: None };
    let mut next = input(stage, node, name, budget)?;
    for _ in 0..MAX_CHAIN {
        let Input::Node(node, _) = next else { break };
        let id = kind(stage, node, budget)?;
        let id = id.strip_prefix("ND_").unwrap_or(&id);
        if id.starts_with("UsdTransform2d") {
            placing.transform = Some(transform(draft, node)?);
            return Ok(Placing { name: placing_name(draft, node)?, ..placing });
        }
        for key in ["varname", "geomprop"] {
            let found = constant(stage, node, key, budget)?;
            if let Some(found) = found.as_ref().and_then(|found| found.value.text()) {
                placing.name = found.clone();
            }
        }
        next = input(stage, node, "in", budget)?;
    }
    Ok(placing)
}

/// The primvar that a node which moves texture coordinates gets.
fn placing_name(draft: &mut Draft, node: u32) -> Result<Text, FormatError> {
    let budget = &mut draft.reading.budget;
    if let Input::Node(reader, _) = input(draft.stage, node, "in", budget)? {
        let found = constant(draft.stage, reader, "varname", budget)?;
        if let Some(name) = found.as_ref().and_then(|found| found.value.text()) {
            return Ok(name.clone());
        }
    }
    Ok("st".into())
}

/// Scaled, turned counter-clockwise and moved, with v upwards; ours are with v downwards.
fn transform(draft: &mut Draft, node: u32) -> Result<UvTransform, FormatError> {
    let stage = draft.stage;
    let budget = &mut draft.reading.budget;
    let turn = constant(stage, node, "rotation", budget)?.and_then(|found| found.value.number());
    let mut pair = |name: &str, default: f64| -> Result<[f32; 2], FormatError> {
        let found = constant(stage, node, name, budget)?;
        Ok(found.and_then(|found| found.value.tuple::<2>()).unwrap_or([default; 2]).map(|x| x as f32))
    };
    let ([sx, sy], [x, y]) = (pair("scale", 1.0)?, pair("translation", 0.0)?);
    let (sin, cos) = sin_cos((turn.unwrap_or(0.0) as f32).to_radians());
    let [a, b, c, d] = [cos * sx, -sin * sy, sin * sx, cos * sy];
    Ok(UvTransform::from_array([a, -c, -b, d, b + x, 1.0 - d - y]))
}

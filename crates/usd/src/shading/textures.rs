//! Nodes that read pictures.

use super::draft::Draft;
use super::folding::{Folded, Linear, folded};
use super::network::{constant, kind};
use super::placing::placing;
use crate::layers::value::Value;
use crate::stage::Found;
use bilux_import::FormatError;
use bilux_import::input::reading::Texels as Meaning;
use bilux_math::Rgb;
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Image, Texels, UvTransform, Wrap};
use std::sync::Arc;

/// Use that a parameter makes of a texture.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    /// Numbers rather than colours.
    pub(super) is_data: bool,
    pub(super) factor: f32,
    pub(super) threshold: Option<f32>,
}

/// Texture or constant that the output of a node gives a parameter.
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
        let fallback = constant(draft.stage, linear.node, "fallback", &mut draft.reading.budget)?;
        let fallback = fallback.and_then(|stated| instead(&stated, None, &linear, taken));
        return vertex_colours(draft, linear.node, name, fallback);
    }
    picture(draft, &linear, taken, name.starts_with("UsdUVTexture"))
}

/// The colours of vertices in place of a texture: the material is then white, and the mesh has the colours. Meshes that have none,
/// and primvars that are not read, have what the node states for that.
fn vertex_colours(
    draft: &mut Draft,
    node: u32,
    id: &str,
    fallback: Option<Painted>,
) -> Result<Option<Painted>, FormatError> {
    let budget = &mut draft.reading.budget;
    let name = match constant(draft.stage, node, "varname", budget)? {
        Some(found) => Some(found),
        None => constant(draft.stage, node, "geomprop", budget)?,
    };
    match name.as_ref().and_then(|found| found.value.text()).map(|text| &**text) {
        Some("displayColor") => {
            draft.shaded.uses_colours = true;
            if let Some(Painted::Constant(colour)) = fallback {
                draft.shaded.without_colours = Some(colour);
            }
        }
        Some("displayOpacity") => draft.shaded.uses_opacities = true,
        other => {
            let what =
                format!("primvars read by {id} other than displayColor ({})", other.unwrap_or("unnamed"));
            draft.not_shown(&what);
            return Ok(fallback);
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
    let meaning = match stated.map(|text| text.to_ascii_lowercase()) {
        Some(text) if text == "raw" || text.contains("lin") || text.contains("data") => {
            Meaning::Numbers(None)
        }
        Some(text) if text.contains("srgb") => Meaning::Colours,
        // What is not said follows from what it is for, and of colours from the picture.
        _ if taken.is_data => Meaning::Numbers(None),
        _ if is_preview => Meaning::Unsaid,
        _ => Meaning::Colours,
    };
    let channel = match &*linear.output {
        "r" | "outr" => Some(Channel::R),
        "g" | "outg" => Some(Channel::G),
        "b" | "outb" => Some(Channel::B),
        "a" | "outa" => Some(Channel::A),
        _ => None,
    };
    let mut texture = match loaded(draft, node, &file, meaning)? {
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
    let mut has_border = [false; 2];
    for ((wrap, is_black), key) in texture.wrap.iter_mut().zip(&mut has_border).zip(keys) {
        let mode = constant(stage, node, key, &mut draft.reading.budget)?;
        let mode = mode.as_ref().and_then(|found| found.value.text());
        (*wrap, *is_black) =
            (wrapping(mode.map(|text| &**text)), mode.is_some_and(|text| &**text == "black"));
    }
    let placing = placing(draft, node, is_preview)?;
    texture.transform = placing.transform;
    surround(draft, &mut texture, has_border)?;
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
    meaning: Meaning,
) -> Result<Result<Option<Texture>, String>, FormatError> {
    let Some(name) = file.value.text().filter(|name| !name.is_empty()) else { return Ok(Ok(None)) };
    let mut name = name.to_string();
    if name.contains("<UDIM>") {
        name = name.replace("<UDIM>", "1001");
        draft.not_shown("tiles of textures other than the first (UDIM)");
    }
    let at = draft.stage.at(node);
    let folder = draft.stage.layers[file.layer as usize].folder.clone();
    match draft.reading.texture(folder.as_deref(), &name, meaning, &at) {
        Ok(texture) => Ok(Ok(Some(Texture { channel: None, ..Texture::clone(&texture) }))),
        Err(error @ FormatError::TooLarge { .. }) => Err(error),
        Err(error) => {
            draft.sink.diagnostics.note(&error.without_place(), || at);
            Ok(Err(name))
        }
    }
}

/// Surrounds the picture with black texels across these axes, of which those at its edges go on for ever: `black` is no way to
/// wrap here. Between the last texels and the border, texels are blended as everywhere.
fn surround(draft: &mut Draft, texture: &mut Texture, axes: [bool; 2]) -> Result<(), FormatError> {
    if axes == [false; 2] {
        return Ok(());
    }
    let [left, top] = axes.map(usize::from);
    let (width, height) = (texture.image.width, texture.image.height);
    let [across, down] = [width + 2 * left, height + 2 * top];
    draft.reading.budget.take_bytes((16 * across * down) as u64, &texture.name)?;
    let inside = |i: usize| {
        let (x, y) = ((i % across).wrapping_sub(left), (i / across).wrapping_sub(top));
        (x < width && y < height).then(|| y * width + x)
    };
    let places = || (0..across * down).map(inside);
    let texels = match &texture.image.texels {
        Texels::Bytes(bytes) => Texels::Bytes(places().map(|i| i.map_or([0; 4], |i| bytes[i])).collect()),
        Texels::Floats { colours, alpha } => Texels::Floats {
            colours: places().map(|i| i.map_or(Rgb::BLACK, |i| colours[i])).collect(),
            // Without alpha, what is inside is opaque.
            alpha: places().map(|i| i.map_or(0.0, |i| alpha.get(i).copied().unwrap_or(1.0))).collect(),
        },
        Texels::Formula(_) => return Ok(()),
    };
    texture.image = Arc::new(Image { width: across, height: down, texels });
    let plain = UvTransform::from_array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let [a, b, c, d, x, y] = texture.transform.unwrap_or(plain).to_array();
    let [scale_u, scale_v] = [width as f32 / across as f32, height as f32 / down as f32];
    let [shift_u, shift_v] = [left as f32 / across as f32, top as f32 / down as f32];
    texture.transform = Some(UvTransform::from_array([
        a * scale_u,
        b * scale_v,
        c * scale_u,
        d * scale_v,
        x * scale_u + shift_u,
        y * scale_v + shift_v,
    ]));
    Ok(())
}

fn wrapping(mode: Option<&str>) -> Wrap {
    match mode {
        Some("clamp" | "black" | "constant") => Wrap::Clamp,
        Some("mirror") => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

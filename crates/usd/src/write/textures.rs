//! Writes the nodes of textures, and their pictures.

use super::document::Document;
use super::draft::Draft;
use super::text::{asset, tuple};
use bilux_import::FormatError;
use bilux_import::input::images::is_bright;
use bilux_import::output::writing::Writing;
use bilux_math::transcendental::atan2;
use bilux_math::{Rgb, Vec2};
use bilux_pictures::{Alpha, ColourSpace, Picture, write_bytes};
use bilux_scene::Texture;
use bilux_scene::texture::{Channel, Filter, Texels, UvTransform, Wrap};
use std::sync::Arc;

/// Meaning of the texels of a texture to its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    Colours,
    Numbers,
    Normals,
}

/// An input of a surface that a texture gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Input {
    pub(super) name: &'static str,
    pub(super) meaning: Meaning,
    /// A factor on the texture; of normals, their strength.
    pub(super) scale: Rgb,
}

impl Document<'_> {
    /// Connects an input with a texture, and writes the nodes that this takes.
    pub(super) fn texture(
        &mut self,
        draft: &mut Draft,
        input: Input,
        texture: &Arc<Texture>,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        let Input { name, meaning, scale } = input;
        let is_number = meaning == Meaning::Numbers;
        let as_luminance = is_number && texture.channel.is_none();
        let file = self.picture(texture, as_luminance, writing)?;
        let (kind, output) = match (meaning, texture.channel) {
            (Meaning::Colours, _) => ("color3f", "rgb"),
            (Meaning::Normals, _) => ("normal3f", "rgb"),
            (Meaning::Numbers, Some(Channel::G)) => ("float", "g"),
            (Meaning::Numbers, Some(Channel::B)) => ("float", "b"),
            (Meaning::Numbers, Some(Channel::A)) => ("float", "a"),
            (Meaning::Numbers, _) => ("float", "r"),
        };
        if meaning == Meaning::Colours && texture.channel.is_some() {
            writing.warn("USD files cannot store one channel of a picture as a colour: all three are used");
        }
        let path = draft.path;
        draft.text.line(&format!("{kind} inputs:{name}.connect = <{path}/{name}.outputs:{output}>"));
        let placing = placing(draft, name, texture, writing);
        let nodes = &mut *draft.nodes;
        nodes.open(&format!("def Shader \"{name}\""), &[]);
        nodes.line("uniform token info:id = \"UsdUVTexture\"");
        nodes.line(&format!("asset inputs:file = {}", asset(&file)));
        let is_raw = texture.is_data || as_luminance || file.ends_with("exr");
        nodes.line(&format!("token inputs:sourceColorSpace = \"{}\"", if is_raw { "raw" } else { "sRGB" }));
        nodes.line(&format!("float2 inputs:st.connect = <{path}/{placing}.outputs:result>"));
        if texture.filter == Filter::Nearest {
            writing.warn("USD files cannot store that the nearest texel counts: texels are blended");
        }
        for (axis, wrap) in ["wrapS", "wrapT"].into_iter().zip(texture.wrap) {
            let mode = match wrap {
                Wrap::Repeat => "repeat",
                Wrap::Mirror => "mirror",
                Wrap::Clamp => "clamp",
            };
            nodes.line(&format!("token inputs:{axis} = \"{mode}\""));
        }
        let factor = if texture.channel.is_some() { Rgb::grey(texture.factor.r) } else { texture.factor };
        let [r, g, b] = (factor * scale).to_array();
        if meaning == Meaning::Normals {
            let s = scale.r;
            nodes.line(&format!("float4 inputs:scale = {}", tuple(&[2.0 * s, 2.0 * s, 2.0, 1.0])));
            nodes.line(&format!("float4 inputs:bias = {}", tuple(&[-s, -s, -1.0, 0.0])));
        } else if [r, g, b] != [1.0; 3] && !as_luminance {
            let alpha = if is_number { r } else { 1.0 };
            nodes.line(&format!("float4 inputs:scale = {}", tuple(&[r, g, b, alpha])));
        } else if as_luminance && scale != Rgb::WHITE {
            nodes.line(&format!("float4 inputs:scale = {}", tuple(&[scale.r; 4])));
        }
        let kind = if is_number { "float" } else { "float3" };
        nodes.line(&format!("{kind} outputs:{output}"));
        nodes.close();
        Ok(())
    }

    /// The file of a texture's picture, written on first use: bytes as they are, and texels brighter than white as EXR.
    fn picture(
        &mut self,
        texture: &Texture,
        as_luminance: bool,
        writing: &mut Writing,
    ) -> Result<String, FormatError> {
        let (image, is_data) = (&texture.image, texture.is_data);
        // The factor is part of a luminance.
        let luminance = as_luminance.then_some(texture.factor);
        let is_this = |(known, data, of, _): &&(Arc<_>, bool, Option<Rgb>, String)| {
            Arc::ptr_eq(known, image) && *data == is_data && *of == luminance
        };
        if let Some((.., name)) = self.images.iter().find(is_this) {
            return Ok(name.clone());
        }
        let bare = Texture {
            factor: luminance.unwrap_or(Rgb::WHITE),
            channel: None,
            threshold: None,
            ..texture.clone()
        };
        let grey = |texel: Rgb| if as_luminance { Rgb::grey(texel.luminance()) } else { texel };
        let texels: Vec<Rgb> = bare.texels().map(grey).collect();
        let bright = texels.iter().any(|texel| is_bright(*texel));
        let format = if bright { "exr" } else { "png" };
        let mut picture = Picture::from_rgb(image.width, image.height, texels)?;
        if (is_data || as_luminance) && !bright {
            // Texels are written as stored, so that no transfer curve is applied to numbers.
            picture.colour_space = ColourSpace::Srgb;
        }
        let alpha: Vec<f32> = match &image.texels {
            Texels::Bytes(bytes) => bytes.iter().map(|texel| f32::from(texel[3]) / 255.0).collect(),
            Texels::Floats { alpha, .. } => alpha.clone(),
            Texels::Formula(_) => Vec::new(),
        };
        if alpha.iter().any(|a| *a < 1.0) && !as_luminance {
            picture.alpha = Alpha::Straight;
            picture.push_channel("A", alpha)?;
        }
        let bytes = write_bytes(format, &picture, &bilux_pictures::WriteOptions::default())?;
        let name = writing.add_numbered("texture", self.images.len() + 1, format, bytes);
        self.images.push((image.clone(), is_data, luminance, name.clone()));
        Ok(name)
    }
}

/// Writes the node that gives a texture its coordinates; returns its name.
fn placing(draft: &mut Draft, name: &str, texture: &Texture, writing: &mut Writing) -> String {
    let (reader, varname) = match texture.second_uv {
        true => ("Coordinates1", "st1"),
        false => ("Coordinates", "st"),
    };
    let path = draft.path;
    let nodes = &mut *draft.nodes;
    let is_there = |out: &[u8]| {
        let head = format!("def Shader \"{reader}\"\n");
        out.windows(head.len()).any(|window| window == head.as_bytes())
    };
    if !is_there(&nodes.out) {
        nodes.open(&format!("def Shader \"{reader}\""), &[]);
        nodes.line("uniform token info:id = \"UsdPrimvarReader_float2\"");
        nodes.line(&format!("string inputs:varname = \"{varname}\""));
        nodes.line("float2 outputs:result");
        nodes.close();
    }
    let Some(transform) = &texture.transform else { return reader.to_owned() };
    let Place { scale, degrees, shift, is_sheared } = Place::of(transform);
    if is_sheared {
        writing.warn("USD files cannot store sheared textures: written without the shear");
    }
    let node = format!("{name}_placement");
    nodes.open(&format!("def Shader \"{node}\""), &[]);
    nodes.line("uniform token info:id = \"UsdTransform2d\"");
    nodes.line(&format!("float2 inputs:in.connect = <{path}/{reader}.outputs:result>"));
    nodes.line(&format!("float inputs:rotation = {degrees}"));
    nodes.line(&format!("float2 inputs:scale = {}", tuple(&scale)));
    nodes.line(&format!("float2 inputs:translation = {}", tuple(&shift)));
    nodes.line("float2 outputs:result");
    nodes.close();
    node
}

/// Texture coordinates are scaled, turned counter-clockwise and moved, with v upwards.
struct Place {
    scale: [f32; 2],
    degrees: f32,
    shift: [f32; 2],
    is_sheared: bool,
}

impl Place {
    /// Ours are with v downwards.
    fn of(transform: &UvTransform) -> Place {
        let upwards = |u: f32, v: f32| {
            let at = transform.apply(Vec2::new(u, 1.0 - v));
            Vec2::new(at.x, 1.0 - at.y)
        };
        let shift = upwards(0.0, 0.0);
        let (u, v) = (upwards(1.0, 0.0) - shift, upwards(0.0, 1.0) - shift);
        let sign = if u.perp_dot(v) < 0.0 { -1.0 } else { 1.0 };
        Place {
            scale: [u.length(), v.length() * sign],
            degrees: atan2(u.y, u.x).to_degrees(),
            shift: shift.to_array(),
            is_sheared: u.dot(v).abs() > 1e-4 * u.length() * v.length(),
        }
    }
}

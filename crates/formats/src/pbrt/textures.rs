//! Named textures. Images stay images; textures that combine others are evaluated, and baked if necessary.

use super::parameters::{Kind, ParameterList};
use super::reader::{Entity, Pbrt};
use super::texture_or_value::{SpectrumType, TextureOrValue};
use super::unknown;
use crate::FormatError;
use crate::reading::Texels;
use bilux_math::transcendental::powf;
use bilux_math::{DMat4, Rgb};
use bilux_scene::texture::{Filter, UvTransform, Wrap};
use bilux_scene::{SceneError, Span, Texture};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// Textures by name: those of colours, and those of numbers.
#[derive(Default)]
pub(super) struct NamedTextures {
    named: [HashMap<String, Slot>; 2],
    /// The number of textures around the one that is being evaluated.
    depth: usize,
}

#[derive(Clone)]
enum Slot {
    Defined(Rc<Entity>),
    /// Currently being evaluated.
    Open,
    Ready(TextureOrValue),
}

impl NamedTextures {
    pub(super) fn define(&mut self, name: String, is_number: bool, entity: Entity, _matrix: DMat4) {
        self.named[usize::from(is_number)].insert(name, Slot::Defined(Rc::new(entity)));
    }
}

/// Deeper nesting of textures is refused, since each level uses some of the stack.
const MAX_DEPTH: usize = 32;

/// Builds a texture.
type Make = fn(&mut Pbrt, &ParameterList, SpectrumType) -> Result<TextureOrValue, FormatError>;

/// Every supported texture.
const TEXTURES: &[(&str, Make)] = &[
    ("bilerp", bilerp),
    ("checkerboard", checkerboard),
    ("constant", constant),
    ("directionmix", direction_mix),
    ("imagemap", image_map),
    ("mix", mix),
    ("scale", scale),
];

/// Textures that are replaced by a single colour.
const PLAIN: &[(&str, [f32; 3])] = &[
    ("dots", [0.5; 3]),
    ("fbm", [0.0; 3]),
    ("wrinkled", [0.5; 3]),
    ("windy", [0.5; 3]),
    ("marble", [0.55, 0.55, 0.57]),
    ("ptex", [0.5; 3]),
    ("uv", [0.5, 0.5, 0.0]),
];

impl Pbrt<'_, '_> {
    /// The colour or texture of a parameter.
    pub(super) fn texture_or_value(
        &mut self,
        list: &ParameterList,
        name: &'static str,
        meaning: SpectrumType,
    ) -> Result<Option<TextureOrValue>, FormatError> {
        let Some(parameter) = list.find(name) else { return Ok(None) };
        match (parameter.kind, parameter.text()) {
            (Kind::Texture, Some(texture)) => self.texture(texture, meaning, &parameter.at).map(Some),
            _ => Ok(Some(TextureOrValue::Colour(self.colour_of(parameter, meaning)?))),
        }
    }

    /// The number or texture of a parameter, as a grey.
    pub(super) fn float_texture(
        &mut self,
        list: &ParameterList,
        name: &'static str,
    ) -> Result<Option<TextureOrValue>, FormatError> {
        match list.texture(name).map(|(texture, at)| (texture.to_owned(), at.clone())) {
            Some((texture, at)) => self.texture(&texture, SpectrumType::Number, &at).map(Some),
            None if list.has(name) => Ok(Some(TextureOrValue::Colour(Rgb::grey(list.finite(name, 0.0)?)))),
            None => Ok(None),
        }
    }

    /// The texture with this name; numbers and colours have separate namespaces.
    pub(super) fn texture(
        &mut self,
        name: &str,
        meaning: SpectrumType,
        at: &Span,
    ) -> Result<TextureOrValue, FormatError> {
        let wanted = usize::from(meaning == SpectrumType::Number);
        // A colour in place of a number, or the reverse, is better than nothing.
        let slot = [wanted, 1 - wanted].into_iter().find(|i| self.textures.named[*i].contains_key(name));
        let Some(slot) = slot else {
            let names = self.textures.named.iter().flat_map(|all| all.keys()).map(String::as_str);
            return Err(unknown("texture", name, names, at));
        };
        let entity = match self.textures.named[slot].get(name) {
            Some(Slot::Ready(source)) => return Ok(source.clone()),
            Some(Slot::Defined(entity)) => entity.clone(),
            _ => {
                let message = format!("the texture '{name}' contains itself, directly or through others");
                return Err(FormatError::malformed(message, at.clone()));
            }
        };
        self.textures.named[slot].insert(name.to_owned(), Slot::Open);
        let meaning = if slot == 1 { SpectrumType::Number } else { SpectrumType::Surface };
        self.textures.depth += 1;
        if self.textures.depth > MAX_DEPTH {
            let message = format!("textures are nested more than {MAX_DEPTH} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        let source = self.make_texture(&entity, meaning)?;
        self.textures.depth -= 1;
        self.textures.named[slot].insert(name.to_owned(), Slot::Ready(source.clone()));
        Ok(source)
    }

    fn make_texture(
        &mut self,
        entity: &Entity,
        meaning: SpectrumType,
    ) -> Result<TextureOrValue, FormatError> {
        let list = &entity.parameters;
        if let Some((_, make)) = TEXTURES.iter().find(|(name, _)| *name == entity.kind) {
            let source = make(self, list, meaning)?;
            list.report_unused(&mut self.oddities);
            return Ok(source);
        }
        let Some((_, plain)) = PLAIN.iter().find(|(name, _)| *name == entity.kind) else {
            let names = TEXTURES.iter().map(|(name, _)| *name).chain(PLAIN.iter().map(|(name, _)| *name));
            return Err(unknown("texture", &entity.kind, names, &entity.at));
        };
        let what = format!("the texture '{}' is not supported: one colour is used instead", entity.kind);
        self.oddities.note(&what, || entity.at.clone());
        Ok(TextureOrValue::Colour(Rgb::from_array(*plain)))
    }

    /// A part of a texture, or its default.
    fn part(
        &mut self,
        list: &ParameterList,
        name: &'static str,
        meaning: SpectrumType,
        default: f32,
    ) -> Result<TextureOrValue, FormatError> {
        let found = match meaning {
            SpectrumType::Number => self.float_texture(list, name)?,
            _ => self.texture_or_value(list, name, meaning)?,
        };
        Ok(found.unwrap_or(TextureOrValue::Colour(Rgb::grey(default))))
    }

    /// The scale and offset of texture coordinates.
    fn uv_mapping(&mut self, list: &ParameterList) -> Result<[f32; 4], FormatError> {
        let mapping = list.text("mapping")?.unwrap_or("uv");
        if mapping != "uv" {
            let what =
                format!("the mapping '{mapping}' is not supported: the meshes' texture coordinates are used");
            self.oddities.note(&what, || list.place("mapping"));
            for name in ["v1", "v2", "udelta", "vdelta", "uscale", "vscale"] {
                list.has(name);
            }
            return Ok([1.0, 1.0, 0.0, 0.0]);
        }
        Ok([
            list.finite("uscale", 1.0)?,
            list.finite("vscale", 1.0)?,
            list.finite("udelta", 0.0)?,
            list.finite("vdelta", 0.0)?,
        ])
    }

    /// An image from a file; a magenta checker, with a warning, if it cannot be read.
    pub(super) fn file(&mut self, name: &str, holds: Texels, at: &Span) -> Result<Texture, FormatError> {
        self.file_or(name, holds, at, "a magenta checker", Texture::missing)
    }

    /// The image of a light; a uniform grey, with a warning, if it cannot be read: any colour would tint the whole
    /// scene.
    pub(super) fn light_file(&mut self, name: &str, at: &Span) -> Result<Texture, FormatError> {
        self.file_or(name, Texels::Colours, at, "a uniform grey of 0.5", Texture::missing_light)
    }

    fn file_or(
        &mut self,
        name: &str,
        holds: Texels,
        at: &Span,
        stands_in: &str,
        make: fn(&str) -> Texture,
    ) -> Result<Texture, FormatError> {
        match self.reading.texture(self.folder.as_deref(), name, holds, at) {
            Ok(texture) => Ok((*texture).clone()),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                let reason = error.without_place();
                let what = format!("a texture is replaced by {stands_in}: {reason}");
                self.oddities.note(&what, || at.clone());
                Ok(make(name))
            }
        }
    }
}

fn constant(
    pbrt: &mut Pbrt,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    pbrt.part(list, "value", meaning, 1.0)
}

/// The product of two textures; in version 4, of a texture and a number.
fn scale(
    pbrt: &mut Pbrt,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = if list.has("tex1") || list.has("tex2") {
        (pbrt.part(list, "tex1", meaning, 1.0)?, pbrt.part(list, "tex2", meaning, 1.0)?)
    } else {
        (pbrt.part(list, "tex", meaning, 1.0)?, pbrt.part(list, "scale", SpectrumType::Number, 1.0)?)
    };
    match (a, b) {
        (TextureOrValue::Colour(colour), other) | (other, TextureOrValue::Colour(colour)) => {
            Ok(other.scaled(colour))
        }
        (a, b) => pbrt.by_formula("scale", [("a", &a), ("b", &b)], &[], |uv| a.at(uv) * b.at(uv)),
    }
}

fn mix(pbrt: &mut Pbrt, list: &ParameterList, meaning: SpectrumType) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (pbrt.part(list, "tex1", meaning, 0.0)?, pbrt.part(list, "tex2", meaning, 1.0)?);
    let amount = pbrt.part(list, "amount", SpectrumType::Number, 0.5)?;
    let blend = |a: Rgb, b: Rgb, t: Rgb| a + (b + a * -1.0) * t;
    match (a, b, amount) {
        (TextureOrValue::Colour(a), TextureOrValue::Colour(b), TextureOrValue::Colour(t)) => {
            Ok(TextureOrValue::Colour(blend(a, b, t)))
        }
        (a, b, amount) => pbrt.by_formula("mix", [("a", &a), ("b", &b), ("amount", &amount)], &[], |uv| {
            blend(a.at(uv), b.at(uv), Rgb::grey(amount.at(uv).luminance()))
        }),
    }
}

/// A mix by the orientation of the surface, approximated by its mean.
fn direction_mix(
    pbrt: &mut Pbrt,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (pbrt.part(list, "tex1", meaning, 0.0)?, pbrt.part(list, "tex2", meaning, 1.0)?);
    list.has("dir");
    let what = "the texture 'directionmix' is not supported: the mean of its parts is used instead";
    pbrt.oddities.note(what, || list.at.clone());
    Ok(TextureOrValue::Colour((a.mean() + b.mean()) * 0.5))
}

fn checkerboard(
    pbrt: &mut Pbrt,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (pbrt.part(list, "tex1", meaning, 1.0)?, pbrt.part(list, "tex2", meaning, 0.0)?);
    if list.integer("dimension")?.unwrap_or(2) == 3 {
        let what = "a three-dimensional checkerboard is not supported: the mean of its parts is used instead";
        pbrt.oddities.note(what, || list.at.clone());
        return Ok(TextureOrValue::Colour((a.mean() + b.mean()) * 0.5));
    }
    list.has("aamode");
    let [su, sv, du, dv] = pbrt.uv_mapping(list)?;
    let placement = [("u_scale", su), ("v_scale", sv), ("u_offset", du), ("v_offset", dv)];
    pbrt.by_formula("checker", [("a", &a), ("b", &b)], &placement, |uv| {
        let (s, t) = ((su * uv.x + du).floor(), (sv * uv.y + dv).floor());
        if (s + t) % 2.0 == 0.0 { a.at(uv) } else { b.at(uv) }
    })
}

fn bilerp(
    pbrt: &mut Pbrt,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let mut corner = |name, default| Ok::<_, FormatError>(pbrt.part(list, name, meaning, default)?.mean());
    let (v00, v01, v10, v11) =
        (corner("v00", 0.0)?, corner("v01", 1.0)?, corner("v10", 0.0)?, corner("v11", 1.0)?);
    let [su, sv, du, dv] = pbrt.uv_mapping(list)?;
    let ramp = pbrt.picture("bilerp", [2, 2], vec![v01, v11, v00, v10])?;
    // The centres of the four texels are the corners.
    let offset = [0.25 + 0.5 * du, 0.75 - 0.5 * (sv + dv)];
    let transform = Some(UvTransform::new(offset, 0.0, [0.5 * su, 0.5 * sv]));
    Ok(TextureOrValue::Picture(Arc::new(Texture { transform, wrap: [Wrap::Clamp; 2], ..ramp })))
}

fn image_map(pbrt: &mut Pbrt, list: &ParameterList, _: SpectrumType) -> Result<TextureOrValue, FormatError> {
    let Some(name) = list.text("filename")? else {
        let what = "filename (of the picture)".to_owned();
        return Err(SceneError::Missing { what, at: list.at.clone() }.into());
    };
    let at = list.place("filename");
    let encoding = list.text("encoding")?.unwrap_or("sRGB").to_owned();
    let gamma = match encoding.split_once(' ') {
        Some(("gamma", number)) => number.trim().parse::<f32>().ok().filter(|g| g.is_finite() && *g > 0.0),
        _ => None,
    };
    // A parameter of version 3.
    let is_linear = encoding == "linear" || gamma.is_some() || !list.flag("gamma", true)?;
    let holds = if is_linear { Texels::Numbers(None) } else { Texels::Colours };
    let mut texture = pbrt.file(name, holds, &at)?;
    texture.wrap = [wrap(pbrt, list)?; 2];
    for name in ["maxanisotropy", "trilinear"] {
        list.has(name);
    }
    if list.text("filter")? == Some("point") {
        texture.filter = Filter::Nearest;
    }
    let [su, sv, du, dv] = pbrt.uv_mapping(list)?;
    if [su, sv, du, dv] != [1.0, 1.0, 0.0, 0.0] {
        // Rows run downwards, but t points upwards.
        texture.transform = Some(UvTransform::new([du, 1.0 - sv - dv], 0.0, [su, sv]));
    }
    let mut source = TextureOrValue::Picture(Arc::new(texture));
    if let Some(gamma) = gamma {
        source = pbrt.mapped(source, |c| c.map(|c| powf(c.max(0.0), gamma)))?;
    }
    source = source.scaled(Rgb::grey(list.finite("scale", 1.0)?));
    if list.flag("invert", false)? {
        source = pbrt.mapped(source, |c| c.map(|c| (1.0 - c).max(0.0)))?;
    }
    Ok(source)
}

fn wrap(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Wrap, FormatError> {
    Ok(match list.text("wrap")?.unwrap_or("repeat") {
        "repeat" => Wrap::Repeat,
        "clamp" => Wrap::Clamp,
        other @ ("black" | "octahedralsphere") => {
            let what = format!("the wrap mode '{other}' is not supported: the texture's edge is repeated");
            pbrt.oddities.note(&what, || list.place("wrap"));
            Wrap::Clamp
        }
        other => {
            let known = ["repeat", "clamp", "black", "octahedralsphere"];
            return Err(unknown("wrap mode", other, known, &list.place("wrap")));
        }
    })
}

//! Named textures. Images stay images; textures that combine others are evaluated, and baked if necessary.

use super::document::NamedTextures;
use super::entity::Entity;
use super::loader::{Loader, SpectrumType};
use super::parameters::{Kind, ParameterList};
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::{TextureOrValue, by_formula};
use bilux_import::input::names::unknown;
use bilux_import::input::reading::Texels;
use bilux_math::Rgb;
use bilux_math::transcendental::powf;
use bilux_scene::texture::{Filter, UvTransform, Wrap};
use bilux_scene::{SceneError, Span, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Evaluates parameters that may be textures, and puts those that are used into the scene.
pub(super) struct Textures<'d, 'o, 'r> {
    defined: &'d NamedTextures,
    /// Textures evaluated so far.
    made: [HashMap<String, MadeTexture>; 2],
    /// The number of textures around the one that is being evaluated.
    depth: usize,
    /// The textures of the scene.
    pub(super) in_scene: Vec<Arc<Texture>>,
    /// Their indices.
    placed: HashMap<*const Texture, usize>,
    pub(super) loader: Loader<'o, 'r>,
}

enum MadeTexture {
    /// Currently being evaluated.
    Open,
    Ready(TextureOrValue),
}

/// Deeper nesting of textures is refused, since each level uses some of the stack.
const MAX_DEPTH: usize = 32;

/// Makes a texture.
type Make = fn(&mut Textures, &ParameterList, SpectrumType) -> Result<TextureOrValue, FormatError>;

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

impl<'d, 'o, 'r> Textures<'d, 'o, 'r> {
    pub(super) fn new(defined: &'d NamedTextures, loader: Loader<'o, 'r>) -> Textures<'d, 'o, 'r> {
        let (made, placed) = (<[HashMap<String, MadeTexture>; 2]>::default(), HashMap::new());
        Textures { defined, made, depth: 0, placed, in_scene: Vec::new(), loader }
    }

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
            _ => Ok(Some(TextureOrValue::Colour(self.loader.colour_of(parameter, meaning)?))),
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
        let slot = [wanted, 1 - wanted].into_iter().find(|i| self.defined[*i].contains_key(name));
        let defined = slot.and_then(|slot| Some((slot, self.defined[slot].get(name)?)));
        let Some((slot, entity)) = defined else {
            let names = self.defined.iter().flat_map(|all| all.keys()).map(String::as_str);
            return Err(unknown("texture", name, names, at));
        };
        match self.made[slot].get(name) {
            Some(MadeTexture::Ready(source)) => return Ok(source.clone()),
            Some(MadeTexture::Open) => {
                let message = format!("the texture '{name}' contains itself, directly or through others");
                return Err(FormatError::malformed(message, at.clone()));
            }
            None => {}
        }
        self.made[slot].insert(name.to_owned(), MadeTexture::Open);
        let meaning = if slot == 1 { SpectrumType::Number } else { SpectrumType::Surface };
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let message = format!("textures are nested more than {MAX_DEPTH} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        let source = self.make_texture(entity, meaning)?;
        self.depth -= 1;
        self.made[slot].insert(name.to_owned(), MadeTexture::Ready(source.clone()));
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
            list.report_unused(&mut self.loader.diagnostics);
            return Ok(source);
        }
        let Some((_, plain)) = PLAIN.iter().find(|(name, _)| *name == entity.kind) else {
            let names = TEXTURES.iter().map(|(name, _)| *name).chain(PLAIN.iter().map(|(name, _)| *name));
            return Err(unknown("texture", &entity.kind, names, &entity.at));
        };
        let what = format!("the texture '{}' is not supported: one colour is used instead", entity.kind);
        self.loader.note(&what, || entity.at.clone());
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
            self.loader.note(&what, || list.place("mapping"));
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

    /// The value of a Bilux parameter.
    pub(super) fn value(&mut self, source: TextureOrValue) -> Value {
        match source {
            TextureOrValue::Colour(colour) => colour.into(),
            TextureOrValue::Picture(picture) => self.texture_value(picture),
        }
    }

    /// The value of a Bilux parameter that is a single number.
    pub(super) fn number_value(&mut self, source: TextureOrValue, [min, max]: [f32; 2]) -> Value {
        match source {
            TextureOrValue::Colour(colour) => colour.r.clamp(min, max).into(),
            TextureOrValue::Picture(picture) => self.texture_value(picture),
        }
    }

    /// Adds a texture to the scene once.
    fn texture_value(&mut self, picture: Arc<Texture>) -> Value {
        let index = *self.placed.entry(Arc::as_ptr(&picture)).or_insert_with(|| {
            self.in_scene.push(picture);
            self.in_scene.len() - 1
        });
        Value::Texture(index)
    }
}

fn constant(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    textures.part(list, "value", meaning, 1.0)
}

/// The product of two textures; in version 4, of a texture and a number.
fn scale(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = if list.has("tex1") || list.has("tex2") {
        (textures.part(list, "tex1", meaning, 1.0)?, textures.part(list, "tex2", meaning, 1.0)?)
    } else {
        (textures.part(list, "tex", meaning, 1.0)?, textures.part(list, "scale", SpectrumType::Number, 1.0)?)
    };
    match (a, b) {
        (TextureOrValue::Colour(colour), other) | (other, TextureOrValue::Colour(colour)) => {
            Ok(other.scaled(colour))
        }
        (a, b) => by_formula(
            "scale",
            [("a", &a), ("b", &b)],
            &[],
            |uv| a.at(uv) * b.at(uv),
            textures.loader.reading,
        ),
    }
}

fn mix(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (textures.part(list, "tex1", meaning, 0.0)?, textures.part(list, "tex2", meaning, 1.0)?);
    let amount = textures.part(list, "amount", SpectrumType::Number, 0.5)?;
    let blend = |a: Rgb, b: Rgb, t: Rgb| a + (b + a * -1.0) * t;
    match (a, b, amount) {
        (TextureOrValue::Colour(a), TextureOrValue::Colour(b), TextureOrValue::Colour(t)) => {
            Ok(TextureOrValue::Colour(blend(a, b, t)))
        }
        (a, b, amount) => by_formula(
            "mix",
            [("a", &a), ("b", &b), ("amount", &amount)],
            &[],
            |uv| blend(a.at(uv), b.at(uv), Rgb::grey(amount.at(uv).luminance())),
            textures.loader.reading,
        ),
    }
}

/// A mix by the orientation of the surface, approximated by its mean.
fn direction_mix(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (textures.part(list, "tex1", meaning, 0.0)?, textures.part(list, "tex2", meaning, 1.0)?);
    list.has("dir");
    let what = "the texture 'directionmix' is not supported: the mean of its parts is used instead";
    textures.loader.note(what, || list.at.clone());
    Ok(TextureOrValue::Colour((a.mean() + b.mean()) * 0.5))
}

fn checkerboard(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let (a, b) = (textures.part(list, "tex1", meaning, 1.0)?, textures.part(list, "tex2", meaning, 0.0)?);
    if list.integer("dimension")?.unwrap_or(2) == 3 {
        let what = "a three-dimensional checkerboard is not supported: the mean of its parts is used instead";
        textures.loader.note(what, || list.at.clone());
        return Ok(TextureOrValue::Colour((a.mean() + b.mean()) * 0.5));
    }
    list.has("aamode");
    let [su, sv, du, dv] = textures.uv_mapping(list)?;
    let placement = [("u_scale", su), ("v_scale", sv), ("u_offset", du), ("v_offset", dv)];
    by_formula(
        "checker",
        [("a", &a), ("b", &b)],
        &placement,
        |uv| {
            let (s, t) = ((su * uv.x + du).floor(), (sv * uv.y + dv).floor());
            if (s + t) % 2.0 == 0.0 { a.at(uv) } else { b.at(uv) }
        },
        textures.loader.reading,
    )
}

fn bilerp(
    textures: &mut Textures,
    list: &ParameterList,
    meaning: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
    let mut corner =
        |name, default| Ok::<_, FormatError>(textures.part(list, name, meaning, default)?.mean());
    let (v00, v01, v10, v11) =
        (corner("v00", 0.0)?, corner("v01", 1.0)?, corner("v10", 0.0)?, corner("v11", 1.0)?);
    let [su, sv, du, dv] = textures.uv_mapping(list)?;
    let ramp = textures.loader.reading.picture("bilerp", [2, 2], vec![v01, v11, v00, v10])?;
    // The centres of the four texels are the corners.
    let offset = [0.25 + 0.5 * du, 0.75 - 0.5 * (sv + dv)];
    let transform = Some(UvTransform::new(offset, 0.0, [0.5 * su, 0.5 * sv]));
    Ok(TextureOrValue::Picture(Arc::new(Texture { transform, wrap: [Wrap::Clamp; 2], ..ramp })))
}

fn image_map(
    textures: &mut Textures,
    list: &ParameterList,
    _: SpectrumType,
) -> Result<TextureOrValue, FormatError> {
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
    let mut texture = textures.loader.file(name, holds, &at)?;
    texture.wrap = [wrap(textures, list)?; 2];
    for name in ["maxanisotropy", "trilinear"] {
        list.has(name);
    }
    if list.text("filter")? == Some("point") {
        texture.filter = Filter::Nearest;
    }
    let [su, sv, du, dv] = textures.uv_mapping(list)?;
    if [su, sv, du, dv] != [1.0, 1.0, 0.0, 0.0] {
        // Rows run downwards, but t points upwards.
        texture.transform = Some(UvTransform::new([du, 1.0 - sv - dv], 0.0, [su, sv]));
    }
    let mut source = TextureOrValue::Picture(Arc::new(texture));
    if let Some(gamma) = gamma {
        source = source.mapped(|c| c.map(|c| powf(c.max(0.0), gamma)), textures.loader.reading)?;
    }
    source = source.scaled(Rgb::grey(list.finite("scale", 1.0)?));
    if list.flag("invert", false)? {
        source = source.mapped(|c| c.map(|c| (1.0 - c).max(0.0)), textures.loader.reading)?;
    }
    Ok(source)
}

fn wrap(textures: &mut Textures, list: &ParameterList) -> Result<Wrap, FormatError> {
    Ok(match list.text("wrap")?.unwrap_or("repeat") {
        "repeat" => Wrap::Repeat,
        "clamp" => Wrap::Clamp,
        other @ ("black" | "octahedralsphere") => {
            let what = format!("the wrap mode '{other}' is not supported: the texture's edge is repeated");
            textures.loader.note(&what, || list.place("wrap"));
            Wrap::Clamp
        }
        other => {
            let known = ["repeat", "clamp", "black", "octahedralsphere"];
            return Err(unknown("wrap mode", other, known, &list.place("wrap")));
        }
    })
}

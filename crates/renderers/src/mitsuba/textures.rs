//! Textures and spectra that are plugins.

use super::maker::{Maker, Meaning};
use super::parser::black_body;
use super::plugin::{Plugin, row};
use super::transforms::Placement;
use super::values::{GivenColour, numbers, samples};
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::{TextureOrValue, by_formula};
use bilux_import::input::names::unknown;
use bilux_import::input::reading::Texels;
use bilux_math::{DMat4, DVec3, Rgb, Vec2};
use bilux_scene::Texture;
use bilux_scene::texture::{Filter, UvTransform, Wrap};
use std::sync::Arc;

/// Makes a texture.
type Make = fn(&mut Maker, &Plugin, Meaning) -> Result<TextureOrValue, FormatError>;

/// Every supported texture and spectrum.
const TEXTURES: &[(&str, Make)] = &[
    ("bitmap", bitmap),
    ("blackbody", blackbody),
    ("checkerboard", checkerboard),
    ("constvolume", constant),
    ("d65", daylight),
    ("gridvolume", not_shown),
    ("irregular", irregular),
    ("mesh_attribute", mesh_attribute),
    ("rawconstant", constant),
    ("regular", regular),
    ("rgb", constant),
    ("scale", scale),
    ("srgb", constant),
    ("uniform", uniform),
    ("volume", not_shown),
    ("wireframe", not_shown),
    ("curvature", not_shown),
];

pub(super) fn make(
    maker: &mut Maker,
    plugin: &Plugin,
    meaning: Meaning,
) -> Result<TextureOrValue, FormatError> {
    row(plugin, TEXTURES)?(maker, plugin, meaning)
}

/// A texture that is not supported: a grey in its place.
fn not_shown(maker: &mut Maker, plugin: &Plugin, _: Meaning) -> Result<TextureOrValue, FormatError> {
    maker.not_shown(plugin);
    plugin.properties.iter().for_each(|property| property.used.set(true));
    Ok(TextureOrValue::Colour(Rgb::grey(0.5)))
}

/// Colours of vertices or faces: white, which the meshes with this material multiply by theirs.
fn mesh_attribute(
    maker: &mut Maker,
    plugin: &Plugin,
    meaning: Meaning,
) -> Result<TextureOrValue, FormatError> {
    if meaning != Meaning::Surface {
        return not_shown(maker, plugin, meaning);
    }
    plugin.ignore(&["name"]);
    let scale = plugin.number_or("scale", 1.0)? as f32;
    Ok(TextureOrValue::Colour(Rgb::grey(scale.clamp(0.0, 1.0))))
}

fn constant(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    let name = if plugin.has("color") { "color" } else { "value" };
    maker.source_or(plugin, name, meaning, 1.0)
}

/// One number for all channels, also as a light: unlike a spectrum without a type.
fn uniform(_: &mut Maker, plugin: &Plugin, _: Meaning) -> Result<TextureOrValue, FormatError> {
    plugin.ignore(&["wavelength_min", "wavelength_max"]);
    Ok(TextureOrValue::Colour(Rgb::grey(plugin.number_or("value", 1.0)?.max(0.0) as f32)))
}

/// Daylight is white.
fn daylight(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    let scale = plugin.number_or("scale", 1.0)? as f32;
    let name = ["color", "value", "texture"].into_iter().find(|name| plugin.has(name)).unwrap_or("color");
    Ok(maker.source_or(plugin, name, meaning, 1.0)?.scaled(Rgb::grey(scale.max(0.0))))
}

fn blackbody(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    plugin.ignore(&["wavelength_min", "wavelength_max"]);
    let kelvin = plugin.number("temperature")?.ok_or_else(|| plugin.missing("temperature (in kelvin)"))?;
    let spectrum = black_body(kelvin, plugin.number_or("scale", 1.0)?);
    let colour = maker.colour(&GivenColour::Samples(Arc::new(spectrum)), meaning, &plugin.at);
    Ok(TextureOrValue::Colour(colour))
}

/// Values at wavelengths that are listed.
fn irregular(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    let wavelengths = listed(plugin, "wavelengths")?;
    let values = listed(plugin, "values")?;
    if wavelengths.len() != values.len() {
        let message = format!("{} wavelengths for {} values", wavelengths.len(), values.len());
        return Err(FormatError::malformed(message, plugin.place("values")));
    }
    of_pairs(maker, plugin, wavelengths.into_iter().zip(values), meaning)
}

/// Values at wavelengths that are equally far apart.
fn regular(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    let values = listed(plugin, "values")?;
    let (from, to) = (plugin.number_or("wavelength_min", 360.0)?, plugin.number_or("wavelength_max", 830.0)?);
    let last = values.len().saturating_sub(1).max(1) as f64;
    let at = move |i: usize| from + (to - from) * i as f64 / last;
    of_pairs(maker, plugin, values.into_iter().enumerate().map(|(i, value)| (at(i), value)), meaning)
}

fn listed(plugin: &Plugin, name: &'static str) -> Result<Vec<f64>, FormatError> {
    let text = plugin.text(name)?.ok_or_else(|| plugin.missing(name))?;
    numbers(text, name, &plugin.place(name))
}

fn of_pairs(
    maker: &mut Maker,
    plugin: &Plugin,
    pairs: impl Iterator<Item = (f64, f64)>,
    meaning: Meaning,
) -> Result<TextureOrValue, FormatError> {
    let given = samples(pairs.map(|(nm, value)| [nm, value]).collect(), &plugin.kind, &plugin.at)?;
    Ok(TextureOrValue::Colour(maker.colour(&given, meaning, &plugin.at)))
}

/// A texture times a number or a colour: a plugin of version 0.5.
fn scale(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    let factor = maker.even(plugin, if plugin.has("scale") { "scale" } else { "value" }, Meaning::Number)?;
    let part = maker.document.part_of(plugin, "texture")?;
    let part = part.ok_or_else(|| plugin.missing("a texture to scale"))?;
    Ok(maker.texture(&part, meaning)?.scaled(factor.unwrap_or(Rgb::WHITE)))
}

/// The matrix that texture coordinates go through first.
pub(super) fn to_uv(plugin: &Plugin) -> Result<DMat4, FormatError> {
    let placed =
        plugin.placement("to_uv")?.map_or(DMat4::IDENTITY, |placement: Arc<Placement>| placement.start());
    // Those of version 0.5.
    let number = |name, default| plugin.number_or(name, default);
    let scale = DVec3::new(number("uscale", 1.0)?, number("vscale", 1.0)?, 1.0);
    let offset = DVec3::new(number("uoffset", 0.0)?, number("voffset", 0.0)?, 0.0);
    Ok(placed * DMat4::from_translation(offset) * DMat4::from_scale(scale))
}

fn bitmap(maker: &mut Maker, plugin: &Plugin, _: Meaning) -> Result<TextureOrValue, FormatError> {
    let (name, at) = plugin.file()?;
    // The last two are those of version 0.5.
    let is_raw = plugin.flag("raw", false)? || plugin.number("gamma")? == Some(1.0);
    plugin.ignore(&["channel", "max_anisotropy", "cache", "accel", "format"]);
    let holds = if is_raw { Texels::Numbers(None) } else { Texels::Colours };
    let found = maker.files().locate(name, &at, maker.reading);
    let texture =
        found.and_then(|(_, name)| maker.reading.texture(maker.files().folder.as_deref(), &name, holds, &at));
    let mut texture = match texture {
        Ok(texture) => (*texture).clone(),
        Err(error @ FormatError::TooLarge { .. }) => return Err(error),
        Err(error) => {
            let what = format!("a texture is replaced by a magenta checker: {}", error.without_place());
            maker.note(&what, &at);
            Texture::missing(name)
        }
    };
    texture.filter = match plugin.text("filter_type")?.unwrap_or("bilinear") {
        "nearest" => Filter::Nearest,
        _ => Filter::Linear,
    };
    texture.wrap = [wrap(plugin, "wrap_mode_u")?, wrap(plugin, "wrap_mode_v")?];
    let matrix = to_uv(plugin)?;
    if matrix != DMat4::IDENTITY {
        let [x, y, shift] = [matrix.x_axis, matrix.y_axis, matrix.w_axis].map(|column| column.as_vec4());
        // Both have v downwards.
        texture.transform = Some(UvTransform::from_array([x.x, x.y, y.x, y.y, shift.x, shift.y]));
    }
    Ok(TextureOrValue::Picture(Arc::new(texture)))
}

/// Continuation of a texture beyond its edges along one axis, which files of version 0.5 can state alone.
fn wrap(plugin: &Plugin, of_axis: &'static str) -> Result<Wrap, FormatError> {
    let name = if plugin.has(of_axis) { of_axis } else { "wrap_mode" };
    match plugin.text(name)?.unwrap_or("repeat") {
        "repeat" => Ok(Wrap::Repeat),
        "mirror" => Ok(Wrap::Mirror),
        "clamp" | "zero" | "one" => Ok(Wrap::Clamp),
        other => Err(unknown("wrap mode", other, ["repeat", "mirror", "clamp"], &plugin.place(name))),
    }
}

fn checkerboard(maker: &mut Maker, plugin: &Plugin, meaning: Meaning) -> Result<TextureOrValue, FormatError> {
    plugin.ignore(&["line_width"]);
    let a = maker.source_or(plugin, "color0", meaning, 0.4)?;
    let b = maker.source_or(plugin, "color1", meaning, 0.2)?;
    let matrix = to_uv(plugin)?;
    let (su, sv) = (2.0 * matrix.x_axis.x as f32, 2.0 * matrix.y_axis.y as f32);
    let (du, dv) = (2.0 * matrix.w_axis.x as f32, 2.0 * matrix.w_axis.y as f32);
    // There v points downwards.
    let rule = |uv: Vec2| {
        let there = matrix.transform_point3(DVec3::new(f64::from(uv.x), 1.0 - f64::from(uv.y), 0.0)) * 2.0;
        let is_first = (there.x.floor() + there.y.floor()).rem_euclid(2.0) == 0.0;
        if is_first { a.at(uv) } else { b.at(uv) }
    };
    let is_straight = matrix.x_axis.y == 0.0 && matrix.y_axis.x == 0.0;
    // Turned ones have a kind that no formula has, and are baked.
    let kind = if is_straight { "checker" } else { "turned checker" };
    let placement = [("u_scale", su), ("v_scale", -sv), ("u_offset", du), ("v_offset", sv + dv)];
    by_formula(kind, [("a", &a), ("b", &b)], &placement, rule, maker.reading)
}

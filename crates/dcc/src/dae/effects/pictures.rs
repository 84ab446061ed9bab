//! Textures: files that the file names in several steps.

use super::effect::Effect;
use crate::dae::element::Element;
use crate::dae::posed::Posed;
use bilux_import::FormatError;
use bilux_import::bytes::spellings::spellings;
use bilux_import::input::reading::{Reading, Texels};
use bilux_math::transcendental::sin_cos;
use bilux_scene::Texture;
use bilux_scene::texture::{UvTransform, Wrap};

/// The picture of a texture, and how it lies on the surface.
pub(super) fn picture<'d>(
    map: Element<'d>,
    effect: &Effect<'d>,
    is_data: bool,
    posed: &Posed<'_, 'd>,
    reading: &mut Reading,
) -> Result<Texture, FormatError> {
    let name = map.attribute("texture").unwrap_or_default();
    let parameter = effect.parameter(name);
    let sampler = parameter.and_then(|parameter| parameter.child("sampler2D"));
    let image = image_of(name, parameter, sampler, effect, posed);
    let image = image.ok_or_else(|| map.error(format!("'{name}' refers to no image")))?;
    let uri = file_of(image).ok_or_else(|| {
        let what = "is inside the file as hexadecimal numbers, which is not read: put it beside the file";
        image.error(format!("this image has no file name, or {what}"))
    })?;
    let holds = if is_data { Texels::Numbers(None) } else { Texels::Colours };
    let mut first = None;
    for name in candidates(uri) {
        match reading.texture(posed.document.folder, &name, holds, &image.at()) {
            Ok(texture) => {
                let wrap = |names: [&str; 2]| {
                    let stated = names.iter().find_map(|name| sampler?.child(name)).map(Element::text);
                    match stated {
                        Some("CLAMP" | "BORDER") => Wrap::Clamp,
                        Some("MIRROR") => Wrap::Mirror,
                        _ => Wrap::Repeat,
                    }
                };
                let wrap = [wrap(["wrap_s", "wrap_t"]), wrap(["wrap_t", "wrap_s"])];
                return Ok(Texture { is_data, wrap, transform: placement(map), ..(*texture).clone() });
            }
            Err(error @ FormatError::TooLarge { .. }) => return Err(error),
            // A file that is there but cannot be read says more than one that is not there.
            Err(error @ FormatError::MissingFile { .. }) => _ = first.get_or_insert(error),
            Err(error) => return Err(error),
        }
    }
    Err(first.unwrap_or_else(|| image.error("this image has no file")))
}

/// The image of a texture: a sampler's surface's, or since 1.5 a sampler's own; some programs name it directly.
fn image_of<'d>(
    name: &str,
    parameter: Option<Element<'d>>,
    sampler: Option<Element<'d>>,
    effect: &Effect<'d>,
    posed: &Posed<'_, 'd>,
) -> Option<Element<'d>> {
    let document = posed.document;
    let is_image = |element: &Element| element.name() == "image";
    let direct = sampler.and_then(|sampler| sampler.child("instance_image")?.attribute("url"));
    let surface =
        sampler.and_then(|sampler| sampler.child("source")).map(Element::text).or(parameter.map(|_| name));
    let surface = surface.and_then(|name| effect.parameter(name)?.child("surface"));
    let of_surface = surface.and_then(|surface| surface.child("init_from")).map(Element::text);
    let uri = direct.or(of_surface).unwrap_or(name);
    document.target(uri).filter(is_image)
}

/// The name of an image's file.
fn file_of(image: Element<'_>) -> Option<&str> {
    let from = image.child("init_from")?;
    let text = from.child("ref").map_or(from.text(), Element::text);
    Some(text).filter(|text| !text.is_empty())
}

/// Paths at which the file may be: as stated, or in the folders where programs put textures beside their scenes.
fn candidates(uri: &str) -> Vec<String> {
    let mut all = spellings(uri);
    for name in all.clone() {
        let base = name.rsplit(['/', '\\']).next().unwrap_or_default();
        for folder in ["textures", "images", "../textures", "../images", "../materials/textures"] {
            all.push(format!("{folder}/{base}"));
        }
    }
    all
}

/// Placement of the picture, as Maya states it: texture coordinates are repeated, rotated about the middle, and moved.
fn placement(map: Element) -> Option<UvTransform> {
    let techniques = map.children_named("extra").flat_map(|extra| extra.children_named("technique"));
    let technique = techniques.filter(|technique| technique.child("repeatU").is_some()).last()?;
    let number = |name: &str, default: f32| {
        let number = technique.child(name).and_then(|child| child.text().parse::<f32>().ok());
        number.filter(|number| number.is_finite()).unwrap_or(default)
    };
    let [su, sv] = [number("repeatU", 1.0), number("repeatV", 1.0)];
    let [tu, tv] = [number("offsetU", 0.0), number("offsetV", 0.0)];
    let degrees = number("rotateUV", 0.0);
    if ([su, sv], [tu, tv], degrees) == ([1.0; 2], [0.0; 2], 0.0) {
        return None;
    }
    let (sin, cos) = sin_cos(degrees.to_radians());
    let (a, b, c, d) = (cos * su, sin * sv, -sin * su, cos * sv);
    let (x, y) = (tu + 0.5 * (1.0 - cos - sin), tv + 0.5 * (1.0 + sin - cos));
    // Here v runs downwards.
    Some(UvTransform::from_array([a, -c, -b, d, b + x, 1.0 - d - y]))
}

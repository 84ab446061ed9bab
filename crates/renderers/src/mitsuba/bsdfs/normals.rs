//! Materials whose normals vary.

use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::appearance::heights::normals_of_stretched_heights;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::{Rgb, Vec2};
use bilux_scene::{Spec, Texture};
use std::sync::Arc;

/// The texture within a material, by its name or without one.
fn map_of(
    maker: &mut Maker,
    plugin: &Plugin,
    name: &'static str,
) -> Result<Option<Arc<Texture>>, FormatError> {
    let found = match maker.source(plugin, name, Meaning::Number)? {
        Some(found) => Some(found),
        None => match maker.document.part_of(plugin, "texture")? {
            Some(part) => Some(maker.texture(&part, Meaning::Number)?),
            None => None,
        },
    };
    Ok(match found {
        Some(TextureOrValue::Picture(picture)) => Some(picture),
        _ => None,
    })
}

fn base(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    match maker.document.part_of(plugin, "bsdf")? {
        Some(part) => maker.material(&part),
        None => Err(plugin.missing("a bsdf")),
    }
}

pub(super) fn normal_map(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let map = map_of(maker, plugin, "normalmap")?;
    let Some(mut spec) = base(maker, plugin)? else { return Ok(None) };
    if let Some(map) = map {
        maker.set(&mut spec, "normal", TextureOrValue::Picture(map), &plugin.place("normalmap"));
    }
    Ok(Some(spec))
}

/// Heights as normals, on the shape that the material is made for: they are lengths in its space.
pub(super) fn bump_map(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let map = map_of(maker, plugin, "arbitrary")?;
    let scale = plugin.number_or("scale", 1.0)? as f32;
    let Some(mut spec) = base(maker, plugin)? else { return Ok(None) };
    if let Some(map) = map {
        let what = "bumps are rendered by normals of heights, for the mean size of a picture on a shape";
        maker.diagnostics.remark(what, || plugin.at.clone());
        let bytes = (map.width() * map.height() * 4) as u64;
        maker.reading.budget.take_bytes(bytes, &plugin.at.file)?;
        let factor = map.factor.luminance() * scale;
        let heights = Texture { factor: Rgb::WHITE, ..(*map).clone() };
        let times = map.transform.as_ref().map_or([1.0; 2], |t| {
            [t.apply(Vec2::X), t.apply(Vec2::Y)].map(|v| v.distance(t.apply(Vec2::ZERO)))
        });
        let [u, v] = [0, 1].map(|i| factor * times[i] / maker.extent[i].max(1e-9));
        let bumps = [u * map.width() as f32, v * map.height() as f32];
        let normals = normals_of_stretched_heights(&heights, bumps);
        let made = Texture { wrap: map.wrap, filter: map.filter, transform: map.transform, ..normals };
        maker.set(&mut spec, "normal", TextureOrValue::Picture(Arc::new(made)), &plugin.at);
    }
    Ok(Some(spec))
}

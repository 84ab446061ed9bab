//! `infinite` lights: environment maps. pbrt uses an equal-area mapping to a square, Bilux longitude and latitude.

use super::light_maker::{LightMaker, picture_name};
use super::parameters::ParameterList;
use bilux_import::FormatError;
use bilux_import::appearance::environment_maps::{Mapping, by_longitude, looked_up};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat4, DVec3};
use bilux_scene::{Spec, Texture, Value};
use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

pub(super) fn infinite(
    maker: &mut LightMaker,
    list: &ParameterList,
    matrix: &DMat4,
) -> Result<Option<Spec>, FormatError> {
    let file = picture_name(list)?;
    if list.has("portal") {
        let what = "portals are not supported: light comes from all sides";
        maker.textures.loader.note(what, || list.place("portal"));
    }
    for name in ["samples", "nsamples"] {
        list.has(name);
    }
    let illuminance = list.number("illuminance")?.filter(|lux| *lux > 0.0);
    let Some((name, is_old)) = file else {
        let radiance = maker.scaled_spectrum(list, "L")?;
        // The illuminance of a uniform environment is π times its luminance.
        let radiance = illuminance.map_or(radiance, |lux| radiance * (lux * FRAC_1_PI as f32));
        return Ok(Some(Spec::new("", "environment").with("radiance", radiance)));
    };
    let at = list.place(if is_old { "mapname" } else { "filename" });
    if list.has("L") && !is_old {
        let message = "'L' and 'filename' both define this light's radiance: remove one of them";
        return Err(FormatError::malformed(message, list.place("L")));
    }
    let picture = maker.textures.loader.light_file(&name, &at)?;
    let is_square = picture.width() == picture.height();
    if !is_square && !is_old {
        let what = "the picture of an infinite light is not square: it is read as a longitude-latitude map";
        maker.textures.loader.note(what, || at.clone());
    }
    let mapping = if is_old || !is_square { Mapping::Latitudes } else { Mapping::Square };
    let mut scale = if is_old { maker.scaled_spectrum(list, "L")? } else { maker.light_scale(list)? };
    if let Some(lux) = illuminance {
        let ours = illuminance_of(&picture, mapping).max(f32::MIN_POSITIVE);
        scale *= lux / ours;
    }
    let turned = by_longitude(&name, &picture, mapping, matrix, &list.at, maker.textures.loader.reading)?;
    let value = maker.textures.value(TextureOrValue::Picture(Arc::new(turned)));
    let spec = Spec::new("", "environment").with("radiance", value);
    Ok(Some(spec.with("scale", Value::from(scale))))
}

/// The illuminance of a horizontal surface from above.
fn illuminance_of(picture: &Texture, mapping: Mapping) -> f32 {
    const SIDE: u32 = 256;
    let mut sum = 0.0;
    for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
        let z = (f64::from(i) + 0.5) / f64::from(SIDE);
        let (sin, cos) = sin_cos_f64(TAU * (f64::from(j) + 0.5) / f64::from(SIDE));
        let r = (1.0 - z * z).sqrt();
        sum += f64::from(looked_up(picture, mapping, DVec3::new(r * cos, r * sin, z)).luminance()) * z;
    }
    (sum * TAU / f64::from(SIDE * SIDE)) as f32
}

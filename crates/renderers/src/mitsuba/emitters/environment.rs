//! Light from all sides.

use super::common::{shine, to_world};
use crate::mitsuba::maker::Maker;
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::appearance::environment_maps::{Mapping, by_longitude};
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::reading::Texels;
use bilux_math::glam::DVec4;
use bilux_math::transcendental::atan2_f64;
use bilux_math::{DMat4, DVec3, Rgb};
use bilux_scene::{Spec, Texture};
use std::sync::Arc;

pub(super) fn constant(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let radiance = shine(maker, plugin, "radiance")?;
    Ok(vec![Spec::new("", "environment").with("radiance", radiance)])
}

/// A map by longitude and latitude with +y up, whose middle is towards +z; ours has its middle towards -z.
pub(super) fn map(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let (name, at) = plugin.file()?;
    plugin.ignore(&["mis_compensation", "cache", "gamma"]);
    let scale = plugin.number_or("scale", 1.0)?.max(0.0) as f32;
    let found = maker.files().locate(name, &at, maker.reading);
    let picture = found.and_then(|(_, name)| {
        maker.reading.texture(maker.files().folder.as_deref(), &name, Texels::Colours, &at)
    });
    let picture = match picture {
        Ok(picture) => picture,
        Err(error @ FormatError::TooLarge { .. }) => return Err(error),
        Err(error) => {
            let what = format!("a texture is replaced by a uniform grey of 0.5: {}", error.without_place());
            maker.note(&what, &at);
            Arc::new(Texture::missing_light(name))
        }
    };
    let matrix = to_world(plugin)?;
    let mut spec = Spec::new("", "environment").with("scale", Rgb::grey(scale));
    let picture = match turn(&matrix) {
        Some(degrees) => {
            // Half a turn between the middles of the two mappings.
            let rotation = (degrees + 180.0) % 360.0;
            spec.parameters.set("rotation", rotation as f32);
            picture
        }
        None => {
            // From Mitsuba's axes to those of the mapping, whose z is up: (x, y, z) to (-z, x, y).
            let axes = DMat4::from_cols(
                DVec4::new(0.0, 1.0, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 1.0, 0.0),
                DVec4::new(-1.0, 0.0, 0.0, 0.0),
                DVec4::W,
            );
            let placed = matrix * axes.inverse();
            Arc::new(by_longitude(name, &picture, Mapping::Latitudes, &placed, &at, maker.reading)?)
        }
    };
    maker.set(&mut spec, "radiance", TextureOrValue::Picture(picture), &at);
    Ok(vec![spec])
}

/// The angle of a rotation about the y axis to the right, in degrees; `None` for other transforms.
fn turn(matrix: &DMat4) -> Option<f64> {
    let [x, y, z] =
        [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis).normalize_or_zero());
    let is_turn = y.distance(DVec3::Y) < 1e-6 && x.cross(y).distance(z) < 1e-6;
    // What was towards +z is now to the right of it, as seen from within, by this angle.
    is_turn.then(|| atan2_f64(-z.x, z.z).to_degrees())
}

//! Lights that are infinitely far away.

use super::common::{shine, to_world};
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_math::DVec3;
use bilux_math::transcendental::{asin_f64, atan2_f64};
use bilux_scene::Spec;

pub(super) fn directional(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let direction = match plugin.vector("direction")? {
        Some(direction) => direction,
        None => to_world(plugin)?.transform_vector3(DVec3::Z),
    };
    let Some(direction) = direction.try_normalize() else {
        let message = "the direction of a light must not be zero";
        return Err(FormatError::malformed(message, plugin.place("direction")));
    };
    let irradiance = shine(maker, plugin, "irradiance")?;
    let spec = Spec::new("", "directional").with("direction", direction.as_vec3());
    Ok(vec![spec.with("irradiance", irradiance)])
}

/// A sky by daylight, with or without its sun.
pub(super) fn sky(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let what =
        "a sky is rendered by the model of Bilux, whose brightness is of its own: correct it with --exposure";
    maker.note(what, &plugin.at);
    plugin.ignore(&[
        "complex_sun",
        "stretch",
        "resolution",
        "extend",
        "year",
        "month",
        "day",
        "hour",
        "minute",
    ]);
    plugin.ignore(&["second", "latitude", "longitude", "timezone", "scale"]);
    let matrix = to_world(plugin)?;
    // Up is +z there.
    let towards = plugin.vector("sun_direction")?.unwrap_or(DVec3::new(0.5, 0.0, 0.8));
    let towards = matrix.transform_vector3(towards).normalize_or(DVec3::Y);
    let turbidity = plugin.number_or("turbidity", 3.0)?.clamp(1.7, 10.0);
    let ground = maker.even(plugin, "albedo", Meaning::Surface)?.unwrap_or(bilux_math::Rgb::grey(0.3));
    let sun = plugin.number_or("sun_scale", 1.0)?.max(0.0) as f32;
    let sky = plugin.number_or("sky_scale", 1.0)?.max(0.0) as f32;
    let degrees = |radians: f64| radians.to_degrees() as f32;
    let sun_share = match plugin.kind.as_str() {
        "sky" => 0.0,
        _ if sky > 0.0 => sun / sky,
        _ => sun,
    };
    Ok(vec![
        Spec::new("", "sky")
            .with("elevation", degrees(asin_f64(towards.y.clamp(0.0, 1.0))))
            .with("azimuth", degrees(atan2_f64(towards.x, -towards.z)))
            .with("turbidity", turbidity as f32)
            .with("ground", ground)
            .with("scale", sky)
            .with("sun_scale", sun_share)
            .with("sun_diameter", plugin.number_or("sun_aperture", 0.5358)?.clamp(0.01, 90.0) as f32),
    ])
}

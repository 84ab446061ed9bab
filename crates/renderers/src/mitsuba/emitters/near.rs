//! Lights at a point.

use super::common::{shine, to_world};
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::world::placement::half_tangent;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DVec3, Rgb, Vec2};
use bilux_scene::{Goniometer, IntensityDistribution, Spec, Value};
use std::sync::Arc;

pub(super) fn point(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let position = match plugin.vector("position")? {
        Some(position) => position,
        None => to_world(plugin)?.transform_point3(DVec3::ZERO),
    };
    let intensity = shine(maker, plugin, "intensity")?;
    Ok(vec![Spec::new("", "point").with("position", position.as_vec3()).with("intensity", intensity)])
}

/// A cone, which fades in proportion to the angle from three quarters of it on.
pub(super) fn spot(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    let cutoff = plugin.number_or("cutoff_angle", 20.0)?.clamp(0.1, 180.0);
    let beam = plugin.number_or("beam_width", cutoff * 0.75)?.clamp(0.0, cutoff);
    let intensity = shine(maker, plugin, "intensity")?;
    if let Some(picture) = maker.source(plugin, "texture", Meaning::Light)? {
        let fades = |degrees: f64| ((cutoff - degrees) / (cutoff - beam).max(1e-9)).clamp(0.0, 1.0) as f32;
        let half = half_tangent(2.0 * cutoff.min(89.0) as f32) as f32;
        // Turned by half a turn from that of a projector.
        return projection(plugin, &picture, [-half, -half], intensity, cutoff.min(89.0), &|angle, _| {
            fades(angle)
        });
    }
    let (mut polar, mut candela) = (vec![0.0, beam, cutoff], vec![1.0, 1.0, 0.0]);
    if beam == 0.0 {
        polar.remove(0);
        candela.remove(0);
    }
    if beam == cutoff {
        (polar, candela) = (vec![0.0, cutoff], vec![1.0, 1.0]);
    }
    let cone = IntensityDistribution::new("spot", Goniometer::C, vec![0.0], polar, candela);
    let cone = cone.map_err(|message| FormatError::malformed(message, plugin.at.clone()))?;
    Ok(vec![luminaire(plugin, cone, intensity)?])
}

/// A light with a distribution whose peak is 1, and so an intensity along its axis.
fn luminaire(
    plugin: &Plugin,
    distribution: IntensityDistribution,
    intensity: Rgb,
) -> Result<Spec, FormatError> {
    let matrix = to_world(plugin)?;
    let axis = |v: DVec3| matrix.transform_vector3(v).normalize_or(v).as_vec3();
    let flux = distribution.lumens() as f32;
    Ok(Spec::new("", "luminaire")
        .with("position", matrix.transform_point3(DVec3::ZERO).as_vec3())
        .with("direction", axis(DVec3::Z))
        .with("c0", axis(DVec3::X))
        .with("distribution", Value::Distribution(Arc::new(distribution)))
        .with("flux", Rgb::grey(flux))
        .with("scale", intensity))
}

/// The angles of a projection: every half degree from the axis, every degree around it.
const POLAR: usize = 181;
const AROUND: usize = 361;

/// A picture that is projected. What it says is the irradiance of a plane at distance 1, times π.
pub(super) fn projector(maker: &mut Maker, plugin: &Plugin) -> Result<Vec<Spec>, FormatError> {
    plugin.ignore(&["fov_axis", "near_clip", "far_clip"]);
    let picture = maker.source_or(plugin, "irradiance", Meaning::Light, 1.0)?;
    let aspect = match &picture {
        TextureOrValue::Picture(picture) => picture.width() as f32 / picture.height().max(1) as f32,
        TextureOrValue::Colour(_) => 1.0,
    };
    let half = half_tangent(plugin.number_or("fov", 60.0)?.clamp(0.1, 179.0) as f32) as f32;
    let corner = f64::from(half * (1.0 + 1.0 / (aspect * aspect)).sqrt());
    let widest = atan2_f64(corner, 1.0).to_degrees();
    let scale = plugin.number_or("scale", 1.0)?.max(0.0) as f32 * std::f32::consts::PI;
    projection(plugin, &picture, [half, half / aspect], Rgb::grey(scale), widest, &|_, cos| {
        1.0 / (cos * cos * cos)
    })
}

/// A picture around the axis of a light, up to these tangents to its sides, with a factor that depends on the angle from the axis, in
/// degrees, and on its cosine. One light for each colour: the distribution of a light is a number.
fn projection(
    plugin: &Plugin,
    picture: &TextureOrValue,
    half: [f32; 2],
    intensity: Rgb,
    widest: f64,
    fading: &dyn Fn(f64, f32) -> f32,
) -> Result<Vec<Spec>, FormatError> {
    let polar: Vec<f64> = (0..POLAR).map(|i| widest * i as f64 / (POLAR - 1) as f64).collect();
    let azimuths: Vec<f64> = (0..AROUND).map(|i| i as f64).collect();
    let mut colours = Vec::with_capacity(POLAR * AROUND);
    for (azimuth, angle) in azimuths.iter().flat_map(|a| polar.iter().map(move |p| (a, p))) {
        let ((sin, cos), (s, c)) = (sin_cos_f64(azimuth.to_radians()), sin_cos_f64(angle.to_radians()));
        let (x, y) = ((s / c * cos) as f32 / half[0], (-s / c * sin) as f32 / half[1]);
        let is_inside = x.abs() <= 1.0 && y.abs() <= 1.0;
        // x points to the left.
        let uv = Vec2::new(0.5 - 0.5 * x, 0.5 + 0.5 * y);
        let colour = picture.at(uv) * fading(*angle, c as f32);
        colours.push(if is_inside { colour.map(|c| c.clamp(0.0, 1e9)) } else { Rgb::BLACK });
    }
    let is_grey = colours.iter().all(|c| c.r == c.g && c.g == c.b);
    let channels = if is_grey {
        vec![Rgb::WHITE]
    } else {
        [DVec3::X, DVec3::Y, DVec3::Z].map(|c| Rgb::from_array(c.as_vec3().to_array())).to_vec()
    };
    let mut lights = Vec::new();
    for channel in channels {
        let candela: Vec<f32> = colours.iter().map(|c| (*c * channel).max_channel()).collect();
        if candela.iter().all(|c| *c == 0.0) {
            continue;
        }
        let rays =
            IntensityDistribution::new("projector", Goniometer::C, azimuths.clone(), polar.clone(), candela);
        let rays = rays.map_err(|message| FormatError::malformed(message, plugin.at.clone()))?;
        lights.push(luminaire(plugin, rays, intensity * channel)?);
    }
    Ok(lights)
}

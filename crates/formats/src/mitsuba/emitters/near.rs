//! Lights at a point.

use super::common::{shine, to_world};
use crate::FormatError;
use crate::mitsuba::maker::{Maker, Meaning};
use crate::mitsuba::plugin::Plugin;
use crate::placement::half_tangent;
use crate::texture_or_value::TextureOrValue;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64};
use bilux_math::{DVec3, Rgb, Vec2};
use bilux_scene::{Goniometer, IntensityDistribution, Spec, Value};
use std::sync::Arc;

pub(super) fn point(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let position = match plugin.vector("position")? {
        Some(position) => position,
        None => to_world(plugin)?.transform_point3(DVec3::ZERO),
    };
    let intensity = shine(maker, plugin, "intensity")?;
    Ok(Some(Spec::new("", "point").with("position", position.as_vec3()).with("intensity", intensity)))
}

/// A cone, which fades in proportion to the angle from three quarters of it on.
pub(super) fn spot(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    let cutoff = plugin.number_or("cutoff_angle", 20.0)?.clamp(0.1, 180.0);
    let beam = plugin.number_or("beam_width", cutoff * 0.75)?.clamp(0.0, cutoff);
    let mut intensity = shine(maker, plugin, "intensity")?;
    if let Some(texture) = maker.source(plugin, "texture", Meaning::Light)? {
        maker.note("a spot light with a texture shines with its mean", &plugin.place("texture"));
        intensity *= texture.mean();
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
    Ok(luminaire(plugin, cone, intensity)?.into())
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

/// A picture that is projected, in shades of its mean colour. What it says is the irradiance of a plane at distance 1,
/// times π.
pub(super) fn projector(maker: &mut Maker, plugin: &Plugin) -> Result<Option<Spec>, FormatError> {
    plugin.ignore(&["fov_axis", "near_clip", "far_clip"]);
    let picture = maker.source_or(plugin, "irradiance", Meaning::Light, 1.0)?;
    let aspect = match &picture {
        TextureOrValue::Picture(picture) => {
            maker.note("a projector shines in shades of the mean colour of its picture", &plugin.at);
            picture.width() as f32 / picture.height().max(1) as f32
        }
        TextureOrValue::Colour(_) => 1.0,
    };
    let mean = picture.mean();
    let shade = |uv: Vec2| picture.at(uv).luminance() / mean.luminance().max(f32::MIN_POSITIVE);
    let half = half_tangent(plugin.number_or("fov", 60.0)?.clamp(0.1, 179.0) as f32) as f32;
    let corner = f64::from(half * (1.0 + 1.0 / (aspect * aspect)).sqrt());
    let widest = atan2_f64(corner, 1.0).to_degrees();
    let polar: Vec<f64> = (0..POLAR).map(|i| widest * i as f64 / (POLAR - 1) as f64).collect();
    let azimuths: Vec<f64> = (0..AROUND).map(|i| i as f64).collect();
    let mut candela = Vec::with_capacity(POLAR * AROUND);
    for (azimuth, angle) in azimuths.iter().flat_map(|a| polar.iter().map(move |p| (a, p))) {
        let ((sin, cos), (s, c)) = (sin_cos_f64(azimuth.to_radians()), sin_cos_f64(angle.to_radians()));
        let (x, y) = ((s / c * cos) as f32 / half, (-s / c * sin) as f32 / half * aspect);
        let is_inside = x.abs() <= 1.0 && y.abs() <= 1.0;
        // x points to the left.
        let uv = Vec2::new(0.5 - 0.5 * x, 0.5 + 0.5 * y);
        candela.push(if is_inside { (shade(uv) / (c * c * c) as f32).min(1e9) } else { 0.0 });
    }
    let rays = IntensityDistribution::new("projector", Goniometer::C, azimuths, polar, candela);
    let rays = rays.map_err(|message| FormatError::malformed(message, plugin.at.clone()))?;
    let scale = plugin.number_or("scale", 1.0)?.max(0.0) as f32;
    Ok(luminaire(plugin, rays, mean * (scale * std::f32::consts::PI))?.into())
}

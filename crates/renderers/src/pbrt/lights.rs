//! Lights. A colour is the radiance as written; any other spectrum has a luminance of 1, times its scale.
//!
//! pbrt divides a light by the luminance of its spectrum, which for a colour is the luminance of white alone, and
//! its default sensor maps a luminance of 1 to 1. So `rgb L` is the Rec. 709 radiance that the image shows.

use super::entity::Entity;
use super::environment;
use super::light_maker::{LightMaker, picture_name};
use super::parameters::ParameterList;
use bilux_import::FormatError;
use bilux_import::appearance::texture_or_value::TextureOrValue;
use bilux_import::input::names::unknown;
use bilux_import::world::placement::half_tangent;
use bilux_math::transcendental::cos_f64;
use bilux_math::{DMat4, DVec3, Rgb, Vec3};
use bilux_scene::{SceneError, Spec};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Builds a light; `None`, with a warning, if there is nothing to build.
type Make = fn(&mut LightMaker, &ParameterList, &DMat4) -> Result<Option<Spec>, FormatError>;

/// Every supported light.
const LIGHTS: &[(&str, Make)] = &[
    ("distant", distant),
    ("goniometric", goniometric),
    ("infinite", environment::infinite),
    ("point", point),
    ("projection", projection),
    ("spot", spot),
];

/// Names from version 3.
const OLD: &[(&str, Make)] = &[("exinfinite", environment::infinite)];

/// A light that is not a surface; `None`, with a warning, if there is nothing to build.
pub(super) fn light(
    entity: &Entity,
    to_world: &DMat4,
    maker: &mut LightMaker,
) -> Result<Option<Spec>, FormatError> {
    let list = &entity.parameters;
    let Some((_, make)) = LIGHTS.iter().chain(OLD).find(|(name, _)| *name == entity.kind) else {
        let names = LIGHTS.iter().map(|(name, _)| *name);
        return Err(unknown("light", &entity.kind, names, &entity.at));
    };
    let made = make(maker, list, to_world)?;
    list.report_unused(&mut maker.textures.loader.diagnostics);
    Ok(made.map(|spec| Spec { span: entity.at.clone(), ..spec }))
}

/// The position of a light in world space.
fn from(list: &ParameterList, matrix: &DMat4) -> Result<DVec3, FormatError> {
    Ok(matrix.transform_point3(list.triple("from", Vec3::ZERO)?.as_dvec3()))
}

/// The direction of a light in world space.
fn forward(list: &ParameterList, matrix: &DMat4) -> Result<DVec3, FormatError> {
    let towards = list.triple("to", Vec3::Z)?.as_dvec3() - list.triple("from", Vec3::ZERO)?.as_dvec3();
    let direction = matrix.transform_vector3(towards).try_normalize();
    direction
        .ok_or_else(|| FormatError::malformed("a light must not point at its own position", list.place("to")))
}

/// The factor that scales a light to its requested power, if any; `all` is the power at an intensity of 1.
fn power(list: &ParameterList, all: f64) -> Result<f32, FormatError> {
    let power = list.number("power")?.filter(|power| *power > 0.0);
    Ok(power.map_or(1.0, |power| if all > 0.0 { (f64::from(power) / all) as f32 } else { 0.0 }))
}

fn at_point(position: DVec3, intensity: Rgb) -> Spec {
    Spec::new("", "point").with("position", position.as_vec3()).with("intensity", intensity)
}

fn cone(position: DVec3, forward: DVec3, intensity: Rgb, [outer, inner]: [f32; 2]) -> Spec {
    // Far from the origin, 32-bit floats may not resolve one metre.
    let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
    Spec::new("", "spot")
        .with("position", position.as_vec3())
        .with("look_at", ahead.as_vec3())
        .with("intensity", intensity)
        .with("angle", outer.clamp(0.0, 180.0))
        .with("inner_angle", inner.clamp(0.0, 180.0))
}

fn point(maker: &mut LightMaker, list: &ParameterList, matrix: &DMat4) -> Result<Option<Spec>, FormatError> {
    let intensity = maker.scaled_spectrum(list, "I")? * power(list, 4.0 * PI)?;
    Ok(Some(at_point(from(list, matrix)?, intensity)))
}

fn distant(
    maker: &mut LightMaker,
    list: &ParameterList,
    matrix: &DMat4,
) -> Result<Option<Spec>, FormatError> {
    let illuminance = list.number("illuminance")?.filter(|lux| *lux > 0.0).unwrap_or(1.0);
    let irradiance = maker.scaled_spectrum(list, "L")? * illuminance;
    // In pbrt, light travels from `from` towards `to`.
    let to = list.triple("to", Vec3::Z)?.as_dvec3();
    let from = list.triple("from", Vec3::ZERO)?.as_dvec3();
    let direction = matrix.transform_vector3(to - from).try_normalize().ok_or_else(|| {
        FormatError::malformed(
            "a light's direction must not be zero: 'from' and 'to' are the same point",
            list.at.clone(),
        )
    })?;
    let spec = Spec::new("", "directional").with("direction", direction.as_vec3());
    Ok(Some(spec.with("irradiance", irradiance)))
}

fn spot(maker: &mut LightMaker, list: &ParameterList, matrix: &DMat4) -> Result<Option<Spec>, FormatError> {
    let outer = list.finite("coneangle", 30.0)?;
    let inner = outer - list.finite("conedeltaangle", 5.0)?;
    let [cos_outer, cos_inner] = [outer, inner].map(|angle| cos_f64(f64::from(angle).to_radians()));
    // The smooth edge emits half of the light of its range of cosines.
    let all = TAU * (1.0 - 0.5 * (cos_inner + cos_outer));
    let intensity = maker.scaled_spectrum(list, "I")? * power(list, all)?;
    Ok(Some(cone(from(list, matrix)?, forward(list, matrix)?, intensity, [outer, inner])))
}

/// A light of equal intensity in all directions: the mean of its image, which is also its mean over the sphere.
fn goniometric(
    maker: &mut LightMaker,
    list: &ParameterList,
    matrix: &DMat4,
) -> Result<Option<Spec>, FormatError> {
    let mean = match picture_name(list)? {
        None => 1.0,
        Some((name, _)) => {
            let what = "a goniometric light shines uniformly in all directions, with the mean of its picture";
            maker.textures.loader.note(what, || list.at.clone());
            let picture = maker.textures.loader.light_file(&name, &list.place("filename"))?;
            let mean = TextureOrValue::Picture(Arc::new(picture)).mean();
            (mean.r + mean.g + mean.b) / 3.0
        }
    };
    let intensity = maker.scaled_spectrum(list, "I")? * mean * power(list, 4.0 * PI * f64::from(mean))?;
    Ok(Some(at_point(from(list, matrix)?, intensity)))
}

/// A spot light as wide as the image at its middle, with the image's mean intensity.
fn projection(
    maker: &mut LightMaker,
    list: &ParameterList,
    matrix: &DMat4,
) -> Result<Option<Spec>, FormatError> {
    let what = "a projection light shines uniformly into a cone, with the mean of its picture";
    maker.textures.loader.note(what, || list.at.clone());
    let mean = match picture_name(list)? {
        Some((name, _)) => TextureOrValue::Picture(Arc::new(
            maker.textures.loader.light_file(&name, &list.place("filename"))?,
        ))
        .mean(),
        None => {
            let what = "filename (of the projected picture)".to_owned();
            return Err(SceneError::Missing { what, at: list.at.clone() }.into());
        }
    };
    let half_angle = 0.5 * list.finite("fov", 90.0)?.clamp(0.1, 179.0);
    let half = half_tangent(2.0 * half_angle);
    // The power of a square image as seen from the point; see [pbrt 2023, 12.2.2].
    let all = 4.0 * half * half * f64::from(mean.luminance()) / (1.0 + half * half);
    let intensity = mean * maker.light_scale(list)? * power(list, all)?;
    let position = matrix.transform_point3(DVec3::ZERO);
    let Some(forward) = matrix.transform_vector3(DVec3::Z).try_normalize() else { return Ok(None) };
    Ok(Some(cone(position, forward, intensity, [half_angle, half_angle])))
}

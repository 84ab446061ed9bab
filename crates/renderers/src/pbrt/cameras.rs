//! Cameras, which look along +z with +x to the right: left-handed, unless their matrix mirrors.

use super::entity::Entity;
use super::lens_system::ThinLens;
use super::loader::Loader;
use super::options::{Options, Settings};
use super::parameters::ParameterList;
use super::state::Matrices;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::names::unknown;
use bilux_import::world::placement::{half_tangent, view_of};
use bilux_math::glam::DQuat;
use bilux_math::transcendental::{atan, atan2_f64};
use bilux_math::{DMat3, DMat4, DVec2, DVec3, Motion, MotionKey, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Parameters, Span, Spec};
use std::f64::consts::FRAC_PI_2;

/// The known cameras, all shown by one of the renderer's own.
const CAMERAS: [&str; 4] = ["perspective", "orthographic", "realistic", "spherical"];

/// The camera, if there is one.
pub(super) fn camera(
    options: &Options,
    settings: &Settings,
    loader: &mut Loader,
) -> Result<Option<CameraSpec>, FormatError> {
    let Some((entity, matrices)) = &options.camera else { return Ok(None) };
    let list = &entity.parameters;
    let [width, height] = settings.size.map(|n| f64::from(n.max(1)));
    let system = match entity.kind.as_str() {
        "realistic" => ThinLens::read(list, loader, options.diagonal(), width / height)?,
        _ => None,
    };
    let diagnostics = &mut loader.diagnostics;
    let kind = kind(entity, system.as_ref(), diagnostics)?;
    let window = ScreenWindow::read(list, width / height, diagnostics)?;
    let to_world = matrices.map(|m| m.inverse());
    let sound = |m: &DMat4| m.is_finite() && bilux_math::Mat3::from_mat4(m.as_mat4()).is_finite();
    if !to_world.iter().all(sound) {
        return Err(is_flat(entity));
    }
    // Panoramas have the left side of the camera in their middle, and are mirrored.
    let turn = if kind == "panorama" { DMat4::from_rotation_y(-FRAC_PI_2) } else { DMat4::IDENTITY };
    let place = |m: &DMat4| place(&(*m * turn), entity);
    let mut spec = Spec { span: entity.at.clone(), ..Spec::new("", kind) };
    spec.parameters = place(&to_world[0])?;
    // Bilux's cameras are right-handed.
    if (to_world[0].determinant() > 0.0) != (kind == "panorama") {
        spec.parameters.set("mirrored", true);
    }
    let sizes = DVec3::new(
        to_world[0].x_axis.truncate().length(),
        to_world[0].y_axis.truncate().length(),
        to_world[0].z_axis.truncate().length(),
    );
    match system {
        Some(lens) => {
            let half = lens.half_height * sizes.y / sizes.z;
            set_view(&mut spec, half, list.place("lensfile"), diagnostics);
            set_blur(&mut spec, lens.radius, lens.focus, sizes);
        }
        None if kind == "panorama" => {}
        None => set_lens(&mut spec, list, &window, sizes, diagnostics)?,
    }
    let mut keyframes = Vec::new();
    if to_world[0] != to_world[1] {
        for (time, matrix) in between(options.times, &to_world, entity)? {
            keyframes.push((time, place(&matrix)?));
        }
    }
    for name in ["shutteropen", "shutterclose"] {
        list.has(name);
    }
    list.report_unused(diagnostics);
    Ok(Some(CameraSpec { spec, keyframes }))
}

/// Which of Bilux's cameras shows it.
fn kind(
    entity: &Entity,
    system: Option<&ThinLens>,
    diagnostics: &mut Diagnostics,
) -> Result<&'static str, FormatError> {
    let list = &entity.parameters;
    Ok(match entity.kind.as_str() {
        "orthographic" => "orthographic",
        "perspective" => "perspective",
        "realistic" => {
            let what = match system {
                Some(lens) => format!(
                    "the camera 'realistic' is shown as a thin lens of {:.1} mm, without its distortion and vignetting",
                    lens.focal_length * 1e3
                ),
                None => {
                    "the camera 'realistic' has no lensfile: a perspective camera is used instead".to_owned()
                }
            };
            diagnostics.note(&what, || entity.at.clone());
            for name in ["aperture", "simpleweighting", "aperturediameter", "focusdistance"] {
                list.has(name);
            }
            "perspective"
        }
        // `environment` is a name of version 3.
        "spherical" | "environment" => {
            let is_of_area =
                entity.kind == "spherical" && list.text("mapping")?.is_none_or(|name| name == "equalarea");
            if is_of_area {
                let what =
                    "the mapping 'equalarea' is not supported: longitude and latitude are used instead";
                diagnostics.note(what, || entity.at.clone());
            }
            "panorama"
        }
        other => return Err(unknown("camera", other, CAMERAS, &entity.at)),
    })
}

/// Sets how wide a camera sees, and how sharp. `sizes` are the scales of its axes.
fn set_lens(
    spec: &mut Spec,
    list: &ParameterList,
    window: &ScreenWindow,
    sizes: DVec3,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let (radius, focus) = (list.finite("lensradius", 0.0)?, list.finite("focaldistance", 1e6)?);
    let fov = list.finite("fov", 90.0)?;
    if spec.kind == "orthographic" {
        if radius > 0.0 {
            let what = "an orthographic camera has no lens: everything is sharp";
            diagnostics.note(what, || list.place("lensradius"));
        }
        if window.is_moved() {
            let what = "a shifted or stretched screen window of an orthographic camera is not supported: only its height is used";
            diagnostics.note(what, || list.place("screenwindow"));
        }
        let height = (2.0 * window.half.y * sizes.y).clamp(1e-9, 1e9);
        spec.parameters.set_at("height", (height as f32).into(), list.place("screenwindow"));
        return Ok(());
    }
    if list.has("halffov") {
        // A parameter of version 2, no longer in use.
        diagnostics.note("'halffov' is not used: give 'fov'", || list.place("halffov"));
    }
    let half = window.half.y * half_tangent(fov.clamp(0.0, 179.9)) * sizes.y / sizes.z;
    set_view(spec, half, list.place("fov"), diagnostics);
    if window.is_moved() {
        let held = |x: f64| x.clamp(-100.0, 100.0) as f32;
        spec.parameters.set("principal_x", held(0.5 - 0.5 * window.middle.x / window.half.x));
        spec.parameters.set("principal_y", held(0.5 + 0.5 * window.middle.y / window.half.y));
        spec.parameters.set("pixel_aspect", window.stretch.clamp(1e-3, 1e3) as f32);
    }
    if radius > 0.0 {
        set_blur(spec, f64::from(radius), f64::from(focus), sizes);
    }
    Ok(())
}

/// Sets the field of view by half the height of the film at distance 1.
fn set_view(spec: &mut Spec, half: f64, at: Span, diagnostics: &mut Diagnostics) {
    let vertical = 2.0 * atan(half as f32).to_degrees();
    if !(0.01..=179.0).contains(&vertical) {
        diagnostics
            .note("a field of view is out of range: it is limited to 0.01 to 179 degrees", || at.clone());
    }
    spec.parameters.set_at("fov", vertical.clamp(0.01, 179.0).into(), at);
}

/// Sets what is out of focus.
fn set_blur(spec: &mut Spec, radius: f64, focus: f64, sizes: DVec3) {
    let held = |x: f64| x.clamp(0.0, 1e9) as f32;
    spec.parameters.set("aperture", held(radius * sizes.x).min(1e6));
    spec.parameters.set("focus", held(focus * sizes.z));
}

/// The screen window, whose shorter side runs from -1 to 1 by default.
struct ScreenWindow {
    /// From the axis to its middle.
    middle: DVec2,
    half: DVec2,
    /// By how much wider it is than the film.
    stretch: f64,
}

impl ScreenWindow {
    fn is_moved(&self) -> bool {
        self.middle.abs().cmpgt(self.half * 5e-5).any() || (self.stretch - 1.0).abs() > 1e-3
    }

    fn read(
        list: &ParameterList,
        film: f64,
        diagnostics: &mut Diagnostics,
    ) -> Result<ScreenWindow, FormatError> {
        let frame = f64::from(list.finite("frameaspectratio", film as f32)?);
        let frame = if list.has("frameaspectratio") && frame > 0.0 { frame } else { film };
        let mut screen =
            if frame > 1.0 { [-frame, frame, -1.0, 1.0] } else { [-1.0, 1.0, -1.0 / frame, 1.0 / frame] };
        match list.numbers("screenwindow")? {
            [] => {}
            [a, b, c, d] => screen = [*a, *b, *c, *d].map(f64::from),
            other => {
                let message = format!("'screenwindow' takes 4 numbers, not {}", other.len());
                return Err(FormatError::malformed(message, list.place("screenwindow")));
            }
        }
        let [left, right, bottom, top] = screen;
        let (half_width, half_height) = (0.5 * (right - left).abs(), 0.5 * (top - bottom).abs());
        if !(half_width > 0.0 && half_height > 0.0) {
            let message = "the screen has no area: correct 'screenwindow'";
            return Err(FormatError::malformed(message, list.place("screenwindow")));
        }
        let window = ScreenWindow {
            middle: DVec2::new(0.5 * (left + right), 0.5 * (bottom + top)),
            half: DVec2::new(half_width, half_height),
            stretch: half_width / half_height / film,
        };
        if right < left || top < bottom {
            let what = "a screen window whose sides are exchanged is not supported: it is not mirrored";
            diagnostics.note(what, || list.place("screenwindow"));
        }
        Ok(window)
    }
}

/// The largest angle, in degrees, between two keyframes of a camera that turns. Cameras interpolate the point that they look
/// at, which differs from a rotation by less than 10⁻⁶ radians over such an angle.
const MAX_STEP: f64 = 2.0;

/// Placements of a moving camera, at as many times as its rotation needs: its position along a line, its axes at constant angular
/// speed, as pbrt interpolates them.
fn between(times: [f64; 2], to_world: &Matrices, entity: &Entity) -> Result<Vec<(f32, DMat4)>, FormatError> {
    let ends = || Ok([0, 1].map(|i| (times[i] as f32, to_world[i])).to_vec());
    let [from, to] =
        [axes(&to_world[0], entity)?, axes(&to_world[1], entity)?].map(|axes| DQuat::from_mat3(&axes));
    let key = |i: usize, rotation: DQuat| MotionKey {
        time_seconds: times[i] as f32,
        translation: to_world[i].w_axis.truncate().as_vec3(),
        rotation: rotation.as_quat(),
        scale: Vec3::ONE,
    };
    let Some(motion) = Motion::from_keys(vec![key(0, from), key(1, to)]) else { return ends() };
    let cos = from.dot(to).abs().min(1.0);
    let angle = 2.0 * atan2_f64((1.0 - cos * cos).sqrt(), cos).to_degrees();
    let steps = (angle / MAX_STEP).ceil() as u32;
    if steps <= 1 {
        return ends();
    }
    let at = |step: u32| {
        let time = (times[0] + (times[1] - times[0]) * f64::from(step) / f64::from(steps)) as f32;
        (time, motion.at(time).matrix().as_dmat4())
    };
    let mut keys: Vec<_> = (0..=steps).map(at).collect();
    // Far from 0, 32-bit floats may not resolve the times in between.
    keys.dedup_by_key(|(time, _)| *time);
    Ok(keys)
}

/// The directions to the right, up and ahead: a rotation, whatever the transform's scales are.
fn axes(to_world: &DMat4, entity: &Entity) -> Result<DMat3, FormatError> {
    let axis = |v: DVec3| to_world.transform_vector3(v).try_normalize();
    let forward = axis(DVec3::Z);
    let right = forward.and_then(|forward| axis(DVec3::Y)?.cross(forward).try_normalize());
    let Some((right, forward)) = right.zip(forward) else { return Err(is_flat(entity)) };
    Ok(DMat3::from_cols(right, forward.cross(right), forward))
}

fn is_flat(entity: &Entity) -> FormatError {
    let message = "this camera has a scale of zero: correct the transforms before it";
    FormatError::malformed(message, entity.at.clone())
}

/// The placement of a camera.
fn place(to_world: &DMat4, entity: &Entity) -> Result<Parameters, FormatError> {
    view_of(to_world).ok_or_else(|| is_flat(entity))
}

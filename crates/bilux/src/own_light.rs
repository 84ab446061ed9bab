//! Whether a file's own light or the studio lights its picture, decided by how much of what the camera sees the file's
//! light reaches.

use crate::Error;
use crate::camera_choice::choose_camera;
use crate::job::shutter_at;
use crate::presets::{self, Studio};
use crate::settings::Settings;
use bilux_scene::{AccelChoice, Scene, SceneBuilder};
use bilux_transport::{Illumination, illumination};

/// The fraction of the visible surfaces that a file's own light must reach for the studio to stay off.
const ENOUGH: f32 = 0.5;

/// The result of measuring a file's own light.
pub(crate) struct OwnLight {
    /// Whether it lights what is visible.
    pub(crate) is_enough: bool,
    /// What was decided, as text for the user; `None` if nobody would expect anything else.
    pub(crate) decision: Option<String>,
    /// The scene with only its own light, and the trees over it.
    pub(crate) alone: (SceneBuilder, Scene),
}

/// Measures the own light of a scene whose file says nothing about its surroundings; returns `None` if there is nothing
/// to decide.
///
/// # Errors
/// If anything in the scene is wrong.
pub(crate) fn measure(
    scene: &SceneBuilder,
    studio: &Studio,
    settings: &Settings,
    accel: &AccelChoice,
) -> Result<Option<OwnLight>, Error> {
    if !bilux_scene::presets::may_be_lit(scene) {
        return Ok(None);
    }
    let mut framed = scene.clone();
    presets::frame(&mut framed, studio);
    let size = [settings.width, settings.height];
    bilux_scene::presets::set_stroke_widths(&mut framed, &settings.camera, size, settings.time);
    let aspect = settings.width as f32 / settings.height as f32;
    let built = framed.build(accel, shutter_at(settings, settings.time), aspect)?;
    let camera = choose_camera(&built, &settings.camera, &settings.camera_at)?;
    let measured = illumination(&built, &*camera);
    let is_enough = measured.surfaces > 0.0 && measured.lit >= ENOUGH;
    let is_said = is_enough || bilux_scene::presets::seems_lit(scene);
    let decision = is_said.then(|| decision(&measured, is_enough));
    Ok(Some(OwnLight { is_enough, decision, alone: (framed, built) }))
}

/// True if nothing but a camera was added to a scene.
pub(crate) fn is_as_large(alone: &SceneBuilder, completed: &SceneBuilder) -> bool {
    let counts = |scene: &SceneBuilder| (scene.objects.len(), scene.lights.len(), scene.cameras.len());
    counts(alone) == counts(completed)
}

fn decision(measured: &Illumination, is_enough: bool) -> String {
    let percent = (measured.lit * 100.0).round();
    if measured.surfaces == 0.0 {
        return "the studio lights it: everything visible in it is an emitter that lights nothing else (--env none \
                turns the studio off)"
            .to_owned();
    }
    match is_enough {
        true => {
            format!(
                "only its own lights light it: they reach {percent}% of the visible surfaces (--preset studio \
                     adds the studio's)"
            )
        }
        false => format!(
            "the studio lights it: its own lights reach only {percent}% of the visible surfaces (--env none turns the \
             studio off)"
        ),
    }
}

//! Whether a file's own light or the studio lights its picture, decided by how much of what the camera sees the file's
//! light reaches.

use crate::Error;
use crate::camera_choice::choose_camera;
use crate::job::shutter_at;
use crate::presets::{self, Studio};
use crate::settings::Settings;
use bilux_scene::{AccelChoice, BuiltParts, Scene, SceneBuilder};
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

/// Measures the own light of a scene whose file says nothing about its surroundings, in each of these views; returns
/// `None` if there is nothing to decide. The view in which it reaches least decides for all.
///
/// # Errors
/// If anything in the scene is wrong.
pub(crate) fn measure(
    scene: &SceneBuilder,
    views: &[Studio],
    settings: &Settings,
    accel: &AccelChoice,
    known: &mut BuiltParts,
) -> Result<Option<OwnLight>, Error> {
    if !bilux_scene::presets::may_be_lit(scene) {
        return Ok(None);
    }
    let mut framed = scene.clone();
    // Every view inserts its camera before those of the following views.
    views.iter().rev().for_each(|studio| presets::frame(&mut framed, studio));
    let size = [settings.width, settings.height];
    bilux_scene::presets::set_stroke_widths(&mut framed, &settings.camera, size, settings.time);
    let aspect = settings.width as f32 / settings.height as f32;
    let built = framed.build_with(known, accel, shutter_at(settings, settings.time), aspect)?;
    let camera = choose_camera(&built, &settings.camera, &settings.camera_at)?;
    let others = built.cameras().iter().skip(1).take(views.len() - 1).map(|(_, camera)| camera);
    // If a file has lights, and no surfaces that emit, the studio's surroundings are there for metal to reflect.
    let gets_surroundings = scene.lights.iter().any(|light| !light.is_backdrop());
    let others = others.map(|camera| illumination(&built, &**camera, gets_surroundings));
    let least = |a: Illumination, b: Illumination| if reached(&b) < reached(&a) { b } else { a };
    let measured = others.fold(illumination(&built, &*camera, gets_surroundings), least);
    let is_enough = reached(&measured) >= ENOUGH;
    let is_said = is_enough || bilux_scene::presets::seems_lit(scene);
    let decision = is_said.then(|| decision(&measured, is_enough));
    Ok(Some(OwnLight { is_enough, decision, alone: (framed, built) }))
}

/// True if nothing but a camera was added to a scene.
pub(crate) fn is_as_large(alone: &SceneBuilder, completed: &SceneBuilder) -> bool {
    let counts = |scene: &SceneBuilder| (scene.objects.len(), scene.lights.len(), scene.cameras.len());
    counts(alone) == counts(completed)
}

/// The fraction of the visible surfaces that light reaches; 0 if there are none.
fn reached(measured: &Illumination) -> f32 {
    if measured.surfaces > 0.0 { measured.lit } else { 0.0 }
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

//! Consequences of a scene's own light for its picture: whether the studio lights it, and how it is exposed. They depend on how
//! much of what the camera sees is lit by it, and how brightly.

use crate::Error;
use crate::preparation::camera_choice::choose_camera;
use crate::preparation::judged::Judged;
use crate::preparation::presets::{self, Studio};
use crate::settings::{Settings, shutter_of};
use bilux_scene::presets::{added_lights, has_own_light, may_be_lit, seems_lit};
use bilux_scene::{AccelChoice, BuiltParts, Scene, SceneBuilder};
use bilux_transport::{Illumination, illumination};

/// The fraction of the visible surfaces that a file's own light must reach for the studio to stay off.
const ENOUGH: f32 = 0.5;
/// The result of measuring a scene's own light.
pub(crate) struct OwnLight {
    pub(crate) judged: Judged,
    /// The scene with only its own light, and the trees over it.
    pub(crate) alone: (SceneBuilder, Scene),
}

/// Measures the own light of a scene whose file says nothing about its surroundings or about its exposure, in each of these
/// views; returns `None` if there is nothing to decide. The view in which it reaches least decides about the studio for all, and
/// the brightest about the exposure.
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
    let decides = may_be_lit(scene);
    let exposes = scene.exposure_unspecified && has_own_light(scene);
    if !decides && !exposes {
        return Ok(None);
    }
    let mut framed = scene.clone();
    // Every view inserts its camera before those of the following views.
    views.iter().rev().for_each(|studio| presets::frame(&mut framed, studio));
    let size = [settings.width, settings.height];
    bilux_scene::presets::set_stroke_widths(&mut framed, &settings.camera, size, settings.time);
    let aspect = settings.width as f32 / settings.height as f32;
    let built = framed.build_with(known, accel, shutter_of(settings), aspect)?;
    let camera = choose_camera(&built, &settings.camera, &settings.camera_at)?;
    let others = built.cameras().iter().skip(1).take(views.len() - 1).map(|(_, camera)| camera);
    // If a file has lights, and no surfaces that emit, the studio's surroundings are there for metal to reflect.
    let gets_surroundings = scene.lights.iter().any(|light| !light.is_backdrop());
    let others = others.map(|camera| illumination(&built, &**camera, gets_surroundings));
    let measured = others.fold(illumination(&built, &*camera, gets_surroundings), worst);
    let is_enough = decides.then(|| reached(&measured) >= ENOUGH);
    let bounds = built.bounds();
    let power = built.lights().iter().map(|light| light.light.power(&bounds)).sum::<f32>();
    let power = power / (std::f32::consts::PI * bounds.radius() * bounds.radius());
    let mut judged = Judged { is_enough, is_said: false, measured, power };
    // Nobody wonders about the studio where signs and screens glow that hardly light anything.
    judged.is_said = is_enough == Some(true)
        || decides && (seems_lit(scene) || measured.surfaces == 0.0 || judged.exposure() != 0.0);
    Ok(Some(OwnLight { judged, alone: (framed, built) }))
}

/// Of two views, what the one that light reaches less shows, as bright as in the brighter one.
fn worst(a: Illumination, b: Illumination) -> Illumination {
    let least = if reached(&b) < reached(&a) { b } else { a };
    let [level, faint, glow] =
        [(a.level, b.level), (a.faint, b.faint), (a.glow, b.glow)].map(|(a, b)| a.max(b));
    Illumination { level, faint, glow, ..least }
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

/// Lights that the studio has added to a scene, in words, where nothing else is to be told about its light.
pub(crate) fn studio_light(settings: &Settings, completed: &SceneBuilder, count: usize) -> Option<String> {
    let is_said = settings.own_light.is_some_and(|judged| judged.is_said);
    added_lights(completed, count).filter(|_| !is_said)
}

/// Note about the light of a completed scene, in one line: what the studio has added, and how the picture is exposed. `count` is
/// the number of lights that the scene had before.
pub(crate) fn note(settings: &Settings, completed: &SceneBuilder, count: usize) -> Option<String> {
    let judged = settings.own_light.as_ref();
    let exposes = settings.is_exposed_by_own_light();
    let added = added_lights(completed, count);
    let is_dark = completed.describes_all_light && !has_own_light(completed);
    let light = match (judged.and_then(|judged| judged.decision(added.as_deref())), &added) {
        (Some(decision), _) => Some(decision),
        (None, Some(added)) => {
            Some(format!("the studio lights it with {added}, since nothing in the file does"))
        }
        (None, None) if is_dark => {
            Some("the file has no light, so everything is black (--preset studio lights it)".to_owned())
        }
        (None, None) => None,
    };
    let exposure = judged.map(Judged::exposure).filter(|stops| exposes && *stops != 0.0).map(|stops| {
        format!("its own light is too {} for a display, so the picture is exposed by {stops:+} EV (--exposure 0 shows \
                 it as it is)", if stops < 0.0 { "bright" } else { "dim" })
    });
    let parts: Vec<String> = light.into_iter().chain(exposure).collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

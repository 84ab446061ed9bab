//! What a scene's own light means for its picture, decided by how much of what the camera sees it reaches, and how brightly:
//! whether the studio lights it, and how it is exposed.

use crate::Error;
use crate::camera_choice::choose_camera;
use crate::job::shutter_of;
use crate::presets::{self, Studio};
use crate::settings::Settings;
use bilux_math::transcendental::{log2, powf};
use bilux_scene::presets::{added_lights, has_own_light, may_be_lit, seems_lit};
use bilux_scene::{AccelChoice, BuiltParts, Scene, SceneBuilder};
use bilux_transport::{Illumination, illumination};

/// The fraction of the visible surfaces that a file's own light must reach for the studio to stay off.
const ENOUGH: f32 = 0.5;
/// The fraction that it must reach to count for the exposure.
const SOME: f32 = 0.05;
/// The outgoing radiance of a white surface that a display shows well, and by how many stops that may be missed.
const SURFACE: [f32; 2] = [0.5, 1.5];
/// The same for what emits light, where nothing else is visible.
const EMITTER: [f32; 2] = [1.0, 3.0];
/// Exposures are multiples of this many stops.
const STEP: f32 = 0.25;

/// What was found of a scene's own light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Judged {
    /// Whether it lights what is visible; `None` if the file describes its surroundings, so that nothing is to be decided.
    pub(crate) is_enough: Option<bool>,
    /// Whether the user may wonder, and is told.
    is_said: bool,
    measured: Illumination,
}

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
    let mut judged = Judged { is_enough, is_said: false, measured };
    // Nobody wonders about the studio where signs and screens glow that hardly light anything.
    judged.is_said = is_enough == Some(true)
        || decides && (seems_lit(scene) || measured.surfaces == 0.0 || judged.exposure() != 0.0);
    Ok(Some(OwnLight { judged, alone: (framed, built) }))
}

/// Of two views, what the one that light reaches less shows, as bright as in the brighter one.
fn worst(a: Illumination, b: Illumination) -> Illumination {
    let least = if reached(&b) < reached(&a) { b } else { a };
    Illumination { level: a.level.max(b.level), glow: a.glow.max(b.glow), ..least }
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

impl Judged {
    /// The exposure, in stops, with which a display shows what the scene's own light lights; 0 where it is as bright as usual, or
    /// lights next to nothing.
    pub(crate) fn exposure(&self) -> f32 {
        let Illumination { surfaces, lit, level, glow } = self.measured;
        let (level, [wanted, tolerance]) = match surfaces > 0.0 {
            true if lit < SOME => return 0.0,
            true => (level, SURFACE),
            false => (glow, EMITTER),
        };
        let stops = if level > 0.0 { log2(wanted / level) } else { 0.0 };
        // Where its own light is dim, the studio's is not.
        let is_usual = stops.abs() <= tolerance || stops > 0.0 && self.is_enough == Some(false);
        if is_usual { 0.0 } else { (stops / STEP).round() * STEP }
    }

    /// How many times brighter than usual the scene is.
    pub(crate) fn brightness(&self) -> f32 {
        powf(2.0, -self.exposure())
    }

    fn decision(&self, added: Option<&str>) -> Option<String> {
        let percent = (self.measured.lit * 100.0).round();
        let added = added.unwrap_or("nothing");
        Some(match self.is_enough? {
            true if added != "nothing" => format!(
                "its own lights light it: they reach {percent}% of the visible surfaces; the studio adds {added} \
                 (--env none leaves them out)"
            ),
            true => format!(
                "only its own lights light it: they reach {percent}% of the visible surfaces (--preset studio adds \
                 the studio's)"
            ),
            false if self.measured.surfaces == 0.0 => format!(
                "the studio lights it with {added}: everything visible in it is an emitter that lights nothing else \
                 (--env none turns the studio off)"
            ),
            false => format!(
                "the studio lights it with {added}: its own lights reach only {percent}% of the visible surfaces \
                 (--env none turns the studio off)"
            ),
        })
    }
}

/// What the studio has added to light a scene, where nothing else is to be told about its light.
pub(crate) fn studio_light(settings: &Settings, completed: &SceneBuilder, count: usize) -> Option<String> {
    let is_said = settings.own_light.is_some_and(|judged| judged.is_said);
    added_lights(completed, count).filter(|_| !is_said)
}

/// What is worth telling about the light of a completed scene, in one line: what the studio has added, and how the picture is
/// exposed. `count` is the number of lights that the scene had before.
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

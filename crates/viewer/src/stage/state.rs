//! State of the scene and of its settings, for the page.

use super::Stage;
use super::comparison::Comparison;
use super::json::value_json;
use crate::open_scene::animation_word;
use crate::settings::{self, Level};
use bilux::math::registry::Parameter;
use bilux::scene::{Object, Part, SceneBuilder, Spec};
use bilux::settings::RENDER;
use bilux::transport::integrators::INTEGRATORS;
use serde_json::{Map, Value, json};

impl Stage {
    /// Publishes the state.
    pub(super) fn publish_state(&self) {
        self.publisher.state(&state(self));
    }

    /// Says how far the picture is.
    pub(super) fn publish_progress(&mut self) {
        if self.refinement.rests || self.publisher.is_progress_due() {
            self.publisher.progress(&progress(self));
        }
    }
}

/// The state of the stage, for the page.
fn state(stage: &Stage) -> Value {
    let job = stage.session.job();
    let (scene, used) = (job.completed_scene(), job.settings());
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    let version = &*stage.version;
    let cameras = scene.cameras.iter().map(|camera| &camera.spec.name);
    json!({
        "say": "state",
        "title": version.title,
        "objects": scene.objects.len(),
        "triangles": triangles,
        "cameras": cameras.collect::<Vec<_>>(),
        "settings": values(stage),
        "shown": stage.shown.name(),
        "full": stage.viewpoint.size,
        "moved": stage.viewpoint.is_moved,
        // Inside of something, a drag looks around; otherwise it moves around.
        "inside": stage.viewpoint.is_inside(&stage.session),
        "accel": used.accel.name,
        "curve": job.write_options().map(|options| options.tone_map.entry.name).unwrap_or_default(),
        "max_depth": used.max_depth,
        "command": stage.whole().command(&version.words, &stage.asked(), &version.changes),
        "served": stage.publisher.served,
        "problem": stage.publisher.problem,
        "warnings": warnings(stage),
        "notes": job.notes(),
        "may_edit": stage.common.may_edit,
        "may_drop": stage.common.may_drop,
        "parts": if stage.common.may_edit { parts(stage) } else { json!({}) },
        "comparison": stage.comparison.as_ref().map(Comparison::state),
        "variants": scene.inventory.variants,
        "variant": version.opening.variant,
        "animations": animations(scene),
        "animation": version.opening.animation,
        "environments": stage.common.environments,
        "environment": version.opening.environment,
        "seconds": seconds(scene),
        "can_undo": version.can_undo,
        "can_redo": version.can_redo,
    })
}

/// Progress of the picture, and of the one that it is compared with, for the page.
fn progress(stage: &Stage) -> Value {
    let (session, level) = (&stage.session, stage.refinement.level);
    let other = stage
        .comparison
        .as_ref()
        .map(|it| json!({ "samples": it.samples(), "total": it.total(), "goes_on": it.goes_on() }));
    json!({
        "say": "progress",
        "level": match level {
            Level::Preview(_) => "preview",
            Level::Clean(_) => "clean",
            Level::Full => "full",
        },
        "divisor": level.divisor(),
        "samples": session.samples(),
        "total": session.job().samples_per_pixel(),
        "noise": if level == Level::Full { stage.refinement.facts.noise } else { None },
        "denoises": stage.denoisers.are_at_work(),
        "waits": stage.awaits_turn,
        "rests": stage.refinement.rests && !stage.denoisers.are_at_work(),
        "other": other,
    })
}

/// The animations of the scene: the word that chooses each, its name, and whether it plays.
fn animations(scene: &SceneBuilder) -> Vec<Value> {
    let all = &scene.inventory.animations;
    let one = |i: usize| {
        let word = animation_word(all, i);
        let name = if all[i].name.is_empty() { format!("number {i}") } else { all[i].name.clone() };
        json!({ "word": word, "name": name, "seconds": all[i].seconds, "plays": all[i].plays })
    };
    (0..all.len()).map(one).collect()
}

/// The value of every setting: the user's, or else the scene's, or else the default.
fn values(stage: &Stage) -> Value {
    let (asked, scene) = (settings::with_defaults(&stage.asked()), &stage.session.scene().settings);
    let value = |p: &Parameter| {
        let found = asked.find(p.name).or_else(|| scene.find(p.name));
        let used = stage.session.job().settings();
        match found {
            Some((value, _)) => value_json(value),
            // As the scene's own light asks for: who changes it begins there.
            None if p.name == "exposure" => json!(used.display_exposure().to_string()),
            None => json!(p.default),
        }
    };
    let mut all: Map<String, Value> = Map::new();
    for p in RENDER.parameters {
        all.insert(p.name.to_owned(), value(p));
    }
    let chosen = INTEGRATORS.iter().find(|row| all["integrator"] == row.entry.name);
    for p in chosen.map_or(&[][..], |row| row.entry.parameters) {
        all.insert(p.name.to_owned(), value(p));
    }
    Value::Object(all)
}

fn warnings(stage: &Stage) -> Vec<String> {
    let of_file = stage.session.scene().warnings.iter();
    of_file.chain(stage.session.job().warnings()).map(ToString::to_string).collect()
}

/// The materials, lights and cameras of the scene, whose parameters may be changed.
fn parts(stage: &Stage) -> Value {
    let one = |spec: &Spec| {
        let parameters = spec.parameters.0.iter().map(|(key, value, _)| (key.clone(), value_json(value)));
        json!({ "name": spec.name, "kind": spec.kind, "parameters": parameters.collect::<Map<_, _>>() })
    };
    let all = |part: Part| part.all(stage.session.scene()).into_iter().map(one).collect::<Value>();
    Part::ALL.into_iter().map(|part| (part.name().to_owned(), all(part))).collect::<Map<_, _>>().into()
}

/// Seconds for which the scene moves; nothing if it does not.
fn seconds(scene: &SceneBuilder) -> Option<f32> {
    let end = |object: &Object| object.motion.keys().last().map(|key| key.time_seconds);
    let of_objects = scene.objects.iter().filter_map(end);
    let of_cameras = scene.cameras.iter().filter_map(|camera| camera.keyframes.last().map(|(time, _)| *time));
    let last = of_objects.chain(of_cameras).fold(scene.inventory.seconds(), f32::max);
    (last > 0.0).then_some(last)
}

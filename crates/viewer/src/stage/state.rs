//! What the page knows of the scene and of its settings.

use super::command::command;
use super::comparison::Comparison;
use super::json::value_json;
use super::{Stage, settings};
use bilux::math::registry::Parameter;
use bilux::scene::{Object, Part, SceneBuilder, Spec};
use bilux::settings::RENDER;
use bilux::transport::integrators::INTEGRATORS;
use serde_json::{Map, Value, json};

/// The state of the stage, for the page.
pub(super) fn state(stage: &Stage) -> Value {
    let job = stage.session.job();
    let (scene, used) = (job.completed_scene(), job.settings());
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    let changes = stage.edits.changes(stage.session.scene());
    let cameras = scene.cameras.iter().map(|camera| &camera.spec.name);
    json!({
        "say": "state",
        "title": stage.title(),
        "objects": scene.objects.len(),
        "triangles": triangles,
        "cameras": cameras.collect::<Vec<_>>(),
        "settings": values(stage),
        "shown": stage.shown.name(),
        "full": stage.size,
        "moved": stage.is_moved,
        // Inside of something, a drag looks around; otherwise it moves around.
        "inside": stage.is_inside(),
        "accel": used.accel.name,
        "curve": job.write_options().map(|options| options.tone_map.entry.name).unwrap_or_default(),
        "max_depth": used.max_depth,
        "command": command(&stage.words(), &stage.session, &stage.asked(), &changes),
        "served": stage.served,
        "problem": stage.problem,
        "warnings": warnings(stage),
        "notes": job.notes(),
        "may_edit": stage.options.may_edit,
        "may_drop": stage.options.may_edit && stage.options.may_drop,
        "parts": if stage.options.may_edit { parts(stage) } else { json!({}) },
        "comparison": stage.comparison.as_ref().map(Comparison::state),
        "variants": scene.inventory.variants,
        "variant": stage.opening.variant,
        "seconds": seconds(scene),
        "can_undo": stage.edits.can_undo(),
        "can_redo": stage.edits.can_redo(),
    })
}

/// The value of every setting: the user's, or else the scene's, or else the default.
fn values(stage: &Stage) -> Value {
    let (asked, scene) = (settings::with_defaults(&stage.asked()), &stage.session.scene().settings);
    let value = |p: &Parameter| {
        let found = asked.find(p.name).or_else(|| scene.find(p.name));
        found.map_or_else(|| json!(p.default), |(value, _)| value_json(value))
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

/// How long the scene moves; nothing if it does not.
fn seconds(scene: &SceneBuilder) -> Option<f32> {
    let end = |object: &Object| object.motion.keys().last().map(|key| key.time_seconds);
    let of_objects = scene.objects.iter().filter_map(end);
    let of_cameras = scene.cameras.iter().filter_map(|camera| camera.keyframes.last().map(|(time, _)| *time));
    let last = of_objects.chain(of_cameras).fold(scene.inventory.seconds(), f32::max);
    (last > 0.0).then_some(last)
}

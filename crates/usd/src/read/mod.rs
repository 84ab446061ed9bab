//! From bytes to a scene.

pub(crate) mod package;

use crate::composition::{Layers, compose};
use crate::layers::layer::Layer;
use crate::scene::Scene;
use crate::skeletons;
use crate::stage::Stage;
use bilux_import::FormatError;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_scene::error::nearest_name;
use bilux_scene::{Animation, Axis, SceneBuilder, UpHint};

/// The number of intervals into which the animation is divided to find where objects move.
const MOMENTS: u32 = 8;

pub(crate) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut layers = Layers::new(reading, source.bytes, source.name, source.folder)?;
    let (moments, length) = moments(&layers.all[0], layers.reading.options.time);
    let needed = if layers.reading.options.whole_movement { moments.len() } else { 1 };
    layers.moments = moments[..needed].to_vec();
    let (prims, variants) = compose(&mut layers)?;
    let mut sink = Sink::for_bare_files();
    sink.diagnostics = std::mem::take(&mut layers.diagnostics);
    let mut stage = Stage::new(layers.all, prims);
    check_variant(reading, &variants, &stage)?;
    let moves = (0..stage.prims.len() as u32).any(|prim| stage.varies(prim));
    let seconds = if moves { length } else { 0.0 };
    stage.time = moments[0];
    let (animations, chosen) = skeletons::playing(&stage, seconds, reading.options.animation.as_deref())?;
    stage.animation = chosen;
    describe(&stage, &mut sink);
    sink.scene.inventory.variants = variants;
    let mut scene = Scene::new(reading, sink);
    scene.add_all(&stage)?;
    let has_lamps = scene.context.has_lamps;
    let mut sink = scene.context.sink;
    // Where a file has lights, these are all.
    sink.scene.environment_unspecified = !has_lamps && sink.scene.lights.is_empty();
    share_trees(&mut sink.scene);
    if sink.scene.objects.is_empty() && sink.scene.lights.is_empty() {
        sink.diagnostics.note("there is nothing to render in this file", || stage.layers[0].at(0));
    }
    sink.scene.inventory.animations = animations;
    if seconds > 0.0 {
        if !sink.scene.inventory.moves() {
            let animation = Animation { name: String::new(), seconds, plays: true };
            sink.scene.inventory.animations.push(animation);
        }
        if reading.options.whole_movement {
            sink.scene.movement = Some(std::sync::Arc::new(movement(reading, stage, &moments[1..])?));
        }
    }
    Ok(sink.finish())
}

/// All objects at several times.
fn movement(reading: &mut Reading, mut stage: Stage, moments: &[f64]) -> Result<SceneBuilder, FormatError> {
    let mut all = SceneBuilder::default();
    for &time in moments {
        stage.time = time;
        let mut scene = Scene::new(reading, Sink::default());
        scene.add_all(&stage)?;
        all.objects.extend(scene.context.sink.scene.objects);
    }
    Ok(all)
}

/// The time code that is shown, those of the whole animation if there is one, and how long that is, in seconds.
fn moments(root: &Layer, time: f32) -> (Vec<f64>, f32) {
    let rate = if stands_still(root) { 0.0 } else { root.time_codes_per_second() };
    let first = root.root_number("startTimeCode").unwrap_or(0.0);
    let seconds = match root.root_number("endTimeCode") {
        Some(end) if end > first && rate > 0.0 => ((end - first) / rate) as f32,
        _ => 0.0,
    };
    let mut moments = vec![first + f64::from(time) * rate];
    let moment = |i: u32| first + f64::from(seconds) * rate * f64::from(i) / f64::from(MOMENTS);
    moments.extend((0..=MOMENTS).map(moment));
    (moments, seconds)
}

/// True if no time code is ever reached: OpenUSD then shows all times as the first.
fn stands_still(root: &Layer) -> bool {
    root.root_number("timeCodesPerSecond") == Some(0.0)
}

/// Refuses a variant that no prim has.
fn check_variant(reading: &Reading, known: &[String], stage: &Stage) -> Result<(), FormatError> {
    let Some(asked) = reading.options.variant.as_deref() else { return Ok(()) };
    let is_asked =
        |name: &&String| *name == asked || name.split_once('=').is_some_and(|(_, variant)| variant == asked);
    if known.iter().any(|name| is_asked(&name)) {
        return Ok(());
    }
    let nearest =
        nearest_name(asked, known).map_or_else(String::new, |name| format!(" (did you mean {name}?)"));
    let all = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    let message = format!("there is no variant '{asked}' in this file{nearest}; there are: {all}");
    Err(FormatError::malformed(message, stage.layers[0].at(0)))
}

/// Axes and units.
fn describe(stage: &Stage, sink: &mut Sink) {
    let fields = &stage.layers[0].root().fields;
    sink.scene.up = UpHint::Is(if stage.is_z_up() { Axis::Z } else { Axis::Y });
    if stands_still(&stage.layers[0]) {
        sink.diagnostics.note("timeCodesPerSecond is 0: nothing moves", || stage.layers[0].at(0));
    }
    let unit = fields.number("metersPerUnit");
    // Centimetres are what files without a unit are in.
    sink.scene.unit = unit.unwrap_or(0.01);
    if unit.is_some_and(|unit| !(1e-12..=1e12).contains(&unit)) {
        sink.scene.unit = 0.0;
        let what = "metersPerUnit is not the length of a unit that anybody has: it is ignored";
        sink.diagnostics.note(what, || stage.layers[0].at(0));
    }
}

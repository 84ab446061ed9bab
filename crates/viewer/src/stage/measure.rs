//! Speed of each accelerator in the scene: its rays a second, and its work for a ray, beside those of the others.

use super::visits::ray;
use crate::common::Common;
use crate::message::Answers;
use bilux::Job;
use bilux::accel::ACCELERATORS;
use bilux::math::Vec2;
use bilux::scene::{AccelChoice, Ray, Scene, SceneBuilder, Tracer};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, TryLockError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The number of rays across the picture, and down.
const ACROSS: usize = 160;
const DOWN: usize = 90;

/// Time for which each accelerator traces rays.
const TIME: Duration = Duration::from_millis(250);

/// The number of rays whose work is counted.
const COUNTED: usize = 400;

/// Trees that take long to build are left out of larger scenes.
const SLOW_BUILDS: &[(&str, usize)] = &[("bsp", 200_000), ("bsp-sah", 500_000)];

/// A measurement, on a thread of its own; meanwhile nothing is rendered. It ends when it is dropped.
pub(super) struct Measurement {
    stops: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Measurement {
    /// Measures all accelerators with rays of a job's camera. The answers go to whoever has asked.
    pub(super) fn begin(job: &Job, answers: Answers, common: Arc<Common>) -> Measurement {
        let stops = Arc::new(AtomicBool::new(false));
        let (scene, settings) = (job.completed_scene().clone(), job.settings());
        let choice = settings.accel.clone();
        let (time, aspect) = (settings.time, settings.width as f32 / settings.height as f32);
        let place = |i: usize| {
            Vec2::new((i % ACROSS) as f32 + 0.5, (i / ACROSS) as f32 + 0.5)
                / Vec2::new(ACROSS as f32, DOWN as f32)
        };
        let rays: Vec<Ray> = (0..ACROSS * DOWN).map(|i| ray(job, place(i))).collect();
        let is_over = stops.clone();
        let measure = move || {
            // One that was stopped may still build a tree.
            let _alone = match common.measuring.try_lock() {
                Ok(alone) => alone,
                Err(TryLockError::Poisoned(failed)) => failed.into_inner(),
                Err(TryLockError::WouldBlock) => {
                    let why = "another measurement is running: try again in a moment";
                    let answer =
                        json!({ "say": "accelerator", "name": "all", "why_not": why, "is_last": true });
                    // A browser that does not take its answers loses them.
                    return drop(answers.try_send(answer.to_string()));
                }
            };
            for (i, row) in ACCELERATORS.iter().enumerate() {
                let name = row.entry.name.to_owned();
                let choice = AccelChoice { name, ..choice.clone() };
                let mut answer = one(&scene, &choice, &rays, [time, aspect], &is_over);
                answer["say"] = "accelerator".into();
                answer["name"] = row.entry.name.into();
                answer["is_last"] = (i + 1 == ACCELERATORS.len()).into();
                if is_over.load(Ordering::Relaxed) {
                    break;
                }
                // A browser that does not take its answers loses them.
                let _ = answers.try_send(answer.to_string());
            }
        };
        let thread = std::thread::Builder::new().name("measure".to_owned()).spawn(measure).ok();
        Measurement { stops, thread }
    }

    /// True until all are measured.
    pub(super) fn goes_on(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for Measurement {
    fn drop(&mut self) {
        self.stops.store(true, Ordering::Relaxed);
    }
}

/// Measurement of one accelerator, or the reason why it was not measured.
fn one(
    scene: &SceneBuilder,
    choice: &AccelChoice,
    rays: &[Ray],
    [time, aspect]: [f32; 2],
    stops: &AtomicBool,
) -> Value {
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    let is_slow = |&&(name, most): &&(&str, usize)| name == choice.name && triangles > most;
    if let Some((_, most)) = SLOW_BUILDS.iter().find(is_slow) {
        return json!({ "why_not": format!("takes long to build for more than {most} triangles") });
    }
    let begun = Instant::now();
    let built = match scene.build(choice, [time, time], aspect) {
        Ok(built) => built,
        Err(error) => return json!({ "why_not": error.to_string() }),
    };
    let build = begun.elapsed().as_secs_f64();
    let (rate, traced) = rate(&built, rays, stops);
    let mut counting = Tracer::new(&built, true);
    // No more than could be traced in the time, since counting takes longer.
    let counted = COUNTED.min(traced).max(1);
    let every = (rays.len() / counted).max(1);
    rays.iter().step_by(every).take(counted).for_each(|ray| {
        counting.hit(ray);
    });
    let each = |sum: u64| sum as f64 / counted as f64;
    let (nodes, tests) = (each(counting.counters.nodes), each(counting.counters.triangles));
    json!({ "rate": rate, "nodes": nodes, "tests": tests, "build": build })
}

/// Rays a second on one thread, and how many were traced. Rays of all of the picture come early, since it may be that not
/// all can be traced.
fn rate(scene: &Scene, rays: &[Ray], stops: &AtomicBool) -> (f64, usize) {
    const BATCH: usize = 64;
    let mut tracer = Tracer::new(scene, false);
    let mut hits = vec![None; BATCH];
    let batches: Vec<&[Ray]> = rays.chunks(BATCH).collect();
    let (begun, mut traced) = (Instant::now(), 0);
    for i in 0.. {
        let batch = batches[(i * 37) % batches.len()];
        // The first batch of a slow accelerator may take all of the time.
        for part in batch.chunks(if i == 0 { 4 } else { BATCH }) {
            tracer.hits(part, &mut hits[..part.len()]);
            traced += part.len();
            if begun.elapsed() >= TIME || stops.load(Ordering::Relaxed) {
                return (traced as f64 / begun.elapsed().as_secs_f64(), traced);
            }
        }
    }
    (0.0, traced)
}

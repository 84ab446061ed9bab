//! `auto`: runs a pilot to decide which techniques are worth their time in this scene, and then uses these.
//! [Grittmann 2022]
//!
//! The pilot depends on scene, film, seed and depth alone, and so does the choice: not on threads, crop or range of
//! samples. Only where a limit of time leaves too little for all of its samples it takes fewer. None of them is in the picture.

mod aim;
mod columns;
mod contributions;
mod cost;
mod grid;
mod outliers;
mod pilot;
mod sets;

use super::vcm::Vcm;
use super::{Chooser, IntegratorEntry, PixelIntegrator, merging};
use crate::integrators::pixel_integrator::Plan;
use crate::light::choice::LightChoice;
use crate::light::emission::Guide;
use crate::path_tracing::PathTracing;
use crate::photons::{MergeCounts, Merging, PhotonPaths};
use crate::sampling::camera_rays::{CameraRays, CameraSpread};
use crate::sampling::task::Task;
use crate::schedule::plan::{Candidate, Choice};
use crate::schedule::settings::RenderSettings;
use crate::techniques::TechniqueCounts;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{Camera, Counters, Ray, Scene, SceneError};
use pilot::{Block, PilotRound, WIDEST};
use sets::{SETS, Set, TECHNIQUES};
use std::sync::Arc;
use std::time::Instant;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "auto",
        summary: "path tracing, with light subpaths, connections and photons where a pilot render finds that they pay \
                  off",
        source: "Grittmann 2022",
        parameters: &[
            Parameter {
                name: "merge",
                summary: "whether vertex merging may be used, which is slightly biased (it blurs)",
                unit: "",
                kind: ParameterKind::Choice(&["auto", "never"]),
                default: "auto",
            },
            Parameter {
                name: "techniques",
                summary: "always use this set of techniques, whatever the pilot render suggests",
                unit: "",
                kind: ParameterKind::Choice(&TECHNIQUES),
                default: "auto",
            },
            super::ROULETTE_DEPTH,
            Parameter {
                name: "radius",
                summary: "initial merging radius, as in vcm; 0 for the footprint of three pixels",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1.0 },
                default: "0",
            },
            merging::ALPHA,
            merging::LIGHT_PATHS,
            Parameter {
                name: "aim",
                summary: "guide light paths to where the pilot render found them useful",
                unit: "",
                kind: ParameterKind::Bool,
                default: "true",
            },
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        let (may_merge, techniques) = (reader.text("merge") == "auto", reader.text("techniques"));
        let given = SETS.iter().position(|set| set.techniques == techniques);
        if !may_merge && given.is_some_and(|set| SETS[set].merges()) {
            let message =
                format!("'{techniques}' needs vertex merging, but 'merge' is 'never': set it to auto");
            return Err(SceneError::invalid(message, reader.span("techniques")));
        }
        Ok(Box::new(Auto {
            aims: reader.bool("aim"),
            may_merge,
            given,
            merging: merging::read(reader, TechniqueCounts::BOTH_ENDS),
        }))
    },
};

struct Auto {
    aims: bool,
    may_merge: bool,
    /// The prescribed set, if there is one.
    given: Option<usize>,
    merging: Merging,
}

/// A set must be better by this factor than one that comes before it, or that does not blur.
const WORTH_MORE: f64 = 1.1;

/// The pilot takes at most one part in this many of a limit of time, but at least one sample.
const PILOT_PART: u32 = 4;

/// Default merging radius of the first iteration, in radii of a disc as large as a pixel's footprint.
const PIXELS: f32 = 3.0;

/// Approximate number of photons on directly lit surfaces that are merged then, if each pixel has its light subpath: the
/// disc is as large as the footprints of this many pixels.
const NEAR: f64 = (PIXELS * PIXELS) as f64;

/// The iteration whose radius represents all.
const TYPICAL_ITERATION: u32 = 16;

impl PixelIntegrator for Auto {
    /// Without a plan: path tracing.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        PathTracing::new(self.merging.roulette_depth).radiance(ray, task)
    }

    fn chooser(&self) -> Option<&dyn Chooser> {
        Some(self)
    }
}

impl Chooser for Auto {
    fn plan(&self, scene: &Scene, camera: &dyn Camera, film: &RenderSettings) -> Plan {
        if camera.receives() {
            return self.without_pilot();
        }
        let (begun, time) = (Instant::now(), film.stop.time_limit.map(|limit| limit / PILOT_PART));
        let settings = pilot::settings(film);
        let pixels = u64::from(film.width) * u64::from(film.height);
        let light_paths = [aim::light_paths(pixels), pilot::LIGHT_PATHS, pilot::LIGHT_PATHS];
        let sources = [0, 1, 2].map(|round| pilot::photon_settings(&settings[round], light_paths[round]));
        let lights = Arc::new(LightChoice::new(scene));
        let eye = |settings| {
            CameraRays::new(scene, camera, settings, CameraSpread::FULL, Arc::clone(&lights)).merging()
        };
        let round = |i: usize| PilotRound { eye: eye(&settings[i]), light: eye(&sources[i]) };
        let mut merging = self.merging;
        // A point on each of few lights is always sampled; of many, photons find the nearest by themselves, and what beams light in fog light
        // subpaths find best.
        merging.techniques.direct = !lights.is_few() || lights.has_beams();
        if merging.radius == 0.0 {
            let pixel = pilot::pixel_radius(&round(0).eye, film) / scene.bounds().radius();
            merging.radius = if pixel > 0.0 { (PIXELS * pixel).min(WIDEST) } else { merging::RADIUS };
        }
        let light_paths = pixels.min(u64::from(merging.max_light_paths)) as f32;
        let pixels = pixels as f32;
        let counts = |set: &Set| {
            let traced = light_paths * set.photons;
            let paths = PhotonPaths {
                all: traced,
                with_beams: traced / merging.beam_step(scene, TYPICAL_ITERATION, traced),
                with_points: traced / Merging::point_step(traced),
            };
            merging.counts(scene, TYPICAL_ITERATION, paths, pixels)
        };
        let techniques = |set: &Set| {
            let light_paths = set.photons;
            set.merging(merging).techniques(&MergeCounts { light_paths, ..counts(set) })
        };
        let mut counters = Counters::default();
        let wide = pilot::merging(&merging, pixels);
        let (mut guide, mut is_short) = (None, false);
        if self.aims {
            let part = time.map(|time| time / 2);
            let (learned, rays, ended) =
                aim::learn(round(0), &wide, &techniques(&SETS[SETS.len() - 1]), NEAR, part);
            counters += rays;
            guide = learned.map(Arc::new);
            is_short = ended;
        }
        let all_sets = |own: &MergeCounts| {
            let own = MergeCounts { light_paths: 1.0, ..*own };
            let all = std::iter::once(merging.techniques(&own)).chain(SETS.iter().map(techniques));
            TechniqueCounts::pack(all)
        };
        let rounds: Vec<PilotRound> = (1..settings.len()).map(|i| round(i).guided(&guide)).collect();
        let deadline = time.and_then(|time| begun.checked_add(time));
        let mut seen = pilot::look(&rounds, &wide, all_sets, deadline);
        seen.steps.in_columns = columns::share_in_columns(&rounds[0].eye, film);
        counters += seen.counters;
        let candidates: Vec<Candidate> = SETS
            .iter()
            .enumerate()
            .map(|(i, set)| Candidate {
                name: set.name,
                techniques: set.techniques,
                error: outliers::error(&seen.blocks, i + 1),
                lost: lost(&seen.blocks, i + 1),
                nanoseconds: seen.steps.nanoseconds(set, i + 1),
            })
            .collect();
        let choice = Choice {
            chosen: self.given.unwrap_or_else(|| self.choose(&candidates, lights.has_beams())),
            candidates,
        };
        let integrator = self.made_of(&SETS[choice.chosen], merging, guide);
        Plan { integrator, choice, counters, is_hurried: is_short || seen.is_short }
    }
}

impl Auto {
    /// Path tracing, which alone finds what a camera [receives](Camera::receives).
    fn without_pilot(&self) -> Plan {
        let Set { name, techniques, .. } = SETS[0];
        let only = Candidate { name, techniques, error: 0.0, lost: 0.0, nanoseconds: 0.0 };
        let integrator = Box::new(PathTracing::new(self.merging.roulette_depth));
        Plan {
            integrator,
            choice: Choice { chosen: 0, candidates: vec![only] },
            counters: Counters::default(),
            is_hurried: false,
        }
    }

    /// Beams through fog are photons close to each other: a few pilot samples do not see how noisy they are, so merging is chosen only where
    /// nothing else finds the light.
    fn choose(&self, candidates: &[Candidate], has_beams: bool) -> usize {
        let mut best = 0;
        for (i, set) in SETS.iter().enumerate().skip(1) {
            let (candidate, held) = (&candidates[i], &candidates[best]);
            let is_judged = !has_beams || !set.merges();
            let is_better = is_judged && candidate.time_to_error() * WORTH_MORE < held.time_to_error();
            let finds_more = held.misses_more_than(candidate);
            let samples_all_light = !candidate.misses_more_than(held);
            if (self.may_merge || !set.merges()) && (finds_more || (is_better && samples_all_light)) {
                best = i;
            }
        }
        best
    }

    fn made_of(&self, set: &Set, merging: Merging, guide: Option<Arc<Guide>>) -> Box<dyn PixelIntegrator> {
        if !set.splats && !set.connections && !set.merges() {
            return Box::new(PathTracing::new(self.merging.roulette_depth));
        }
        Box::new(Vcm { merging: set.merging(merging), guide })
    }
}

/// The fraction of the light that the techniques of a set cannot find.
fn lost(blocks: &[Block], set: usize) -> f64 {
    let sum = |of: fn(&Block, usize) -> f64| blocks.iter().map(|block| of(block, set)).sum::<f64>();
    let light = sum(|block, _| block.mean);
    if light > 0.0 { sum(|block, set| block.lost[set]) / light } else { 0.0 }
}

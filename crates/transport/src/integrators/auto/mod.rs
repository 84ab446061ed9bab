//! `auto`: decides from a first look which ways of finding light are worth their time in this scene, and then uses these.
//! [Grittmann 2022]
//!
//! The look depends on scene, film, seed and depth alone, and so does the choice: not on threads, crop, range of samples,
//! or time. None of its samples is in the picture.

mod cost;
mod pilot;

use super::path::Path;
use super::vcm::Vcm;
use super::{IntegratorEntry, PixelIntegrator, merging};
use crate::bidirectional::{Lanes, Merging, Ways};
use crate::eye::Eye;
use crate::plan::{Choice, Plan, Rival};
use crate::render::RenderSettings;
use crate::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{Camera, Ray, Scene};
use pilot::{Block, Turn};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "auto",
        summary: "path tracing, with light paths, joins and photons where a first look finds them worth their time",
        source: "Grittmann 2022",
        parameters: &[
            Parameter {
                name: "merge",
                summary: "whether vertices that lie close together may count as one, which blurs a little",
                unit: "",
                kind: ParameterKind::Choice(&["auto", "never"]),
                default: "auto",
            },
            super::ROULETTE_DEPTH,
            Parameter {
                name: "radius",
                summary: "as that of vcm; 0 for three pixels as the camera sees them",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1.0 },
                default: "0",
            },
            merging::ALPHA,
            merging::LIGHT_PATHS,
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        Ok(Box::new(Auto {
            may_merge: reader.text("merge") == "auto",
            roulette_depth: reader.integer("roulette_depth") as u32,
            merging: merging::read(reader, Ways::BOTH_ENDS),
        }))
    },
};

struct Auto {
    may_merge: bool,
    roulette_depth: u32,
    merging: Merging,
}

/// A set of ways, beside those that a camera path has by itself.
struct Set {
    name: &'static str,
    sees: bool,
    joins: bool,
    merges: bool,
}

/// What there is to choose from, the simplest first.
const SETS: [Set; 6] = [
    Set { name: "path", sees: false, joins: false, merges: false },
    Set { name: "path and light", sees: true, joins: false, merges: false },
    Set { name: "bdpt", sees: true, joins: true, merges: false },
    Set { name: "path and photons", sees: false, joins: false, merges: true },
    Set { name: "path, light and photons", sees: true, joins: false, merges: true },
    Set { name: "vcm", sees: true, joins: true, merges: true },
];

/// A set has to be so much better than one that stands before it, or that does not blur.
const WORTH_MORE: f64 = 1.1;

/// Photons are merged over so many pixels to begin with, where nothing else is said.
const PIXELS: f32 = 3.0;

/// The iteration whose radius stands for all.
const TYPICAL_ITERATION: u32 = 16;

impl PixelIntegrator for Auto {
    /// Without a plan: path tracing.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        Path::new(self.roulette_depth).radiance(ray, task)
    }

    fn roulette_depth(&self) -> u32 {
        self.roulette_depth
    }

    fn plan(&self, scene: &Scene, camera: &dyn Camera, film: &RenderSettings) -> Option<Plan> {
        let settings = pilot::settings(film);
        let sources = settings.each_ref().map(|turn| pilot::photon_settings(film, turn));
        let eye = |settings| Eye::new(scene, camera, self, settings);
        let turns: Vec<Turn> = settings
            .iter()
            .zip(&sources)
            .map(|(settings, sources)| Turn { eye: eye(settings), light: eye(sources) })
            .collect();
        let mut merging = self.merging;
        if merging.radius == 0.0 {
            merging.radius = PIXELS * pilot::pixel_radius(&turns[0].eye, film) / scene.bounds().radius();
        }
        let light_paths =
            (u64::from(film.width) * u64::from(film.height)).min(u64::from(merging.max_light_paths)) as f32;
        let eta = merging.area(scene, TYPICAL_ITERATION) * light_paths;
        let ways = |set: &Set| Ways {
            eta: Lanes([if set.merges { eta } else { 0.0 }]),
            ..Ways::beside_merging(set.sees, set.joins)
        };
        let lanes = |own: f32| {
            let all = std::iter::once(merging.ways(own, 1.0)).chain(SETS.iter().map(ways));
            Ways::together(all)
        };
        let seen = pilot::look(&turns, &merging, lanes);
        let rivals: Vec<Rival> = SETS
            .iter()
            .enumerate()
            .map(|(i, set)| Rival {
                name: set.name,
                error: error(&seen.blocks, i + 1),
                lost: lost(&seen.blocks, i + 1),
                nanoseconds: seen.steps.nanoseconds(&ways(set)),
            })
            .collect();
        let choice = Choice { chosen: self.choose(&rivals), rivals };
        Some(Plan {
            integrator: self.made_of(&SETS[choice.chosen], merging),
            choice,
            counters: seen.counters,
        })
    }
}

impl Auto {
    fn choose(&self, rivals: &[Rival]) -> usize {
        let mut best = 0;
        for (i, set) in SETS.iter().enumerate().skip(1) {
            let (rival, held) = (&rivals[i], &rivals[best]);
            let is_better = rival.time_to_error() * WORTH_MORE < held.time_to_error();
            let finds_more = held.misses_more_than(rival);
            let finds_all = !rival.misses_more_than(held);
            if (self.may_merge || !set.merges) && (finds_more || (is_better && finds_all)) {
                best = i;
            }
        }
        best
    }

    fn made_of(&self, set: &Set, merging: Merging) -> Box<dyn PixelIntegrator> {
        if !set.sees && !set.joins && !set.merges {
            return Box::new(Path::new(self.roulette_depth));
        }
        let radius = if set.merges { merging.radius } else { 0.0 };
        let merging = Merging { radius, ways: Ways::beside_merging(set.sees, set.joins), ..merging };
        Box::new(Vcm { roulette_depth: self.roulette_depth, merging })
    }
}

/// Relative error of one sample with the ways of a lane, as a mean over blocks. The worst block of a hundred is left out:
/// what no set of ways finds well tells nothing about any of them.
fn error(blocks: &[Block], lane: usize) -> f64 {
    let light: f64 = blocks.iter().map(|block| block.mean).sum();
    let dark = DARK * light / blocks.len() as f64;
    let of =
        |block: &Block, lane: usize| block.variance[lane].max(0.0) / (block.mean * block.mean + dark * dark);
    let mut kept: Vec<&Block> = blocks.iter().collect();
    kept.sort_by(|a, b| of(a, 0).total_cmp(&of(b, 0)));
    kept.truncate(blocks.len() - blocks.len() / 100);
    kept.iter().map(|block| of(block, lane)).sum::<f64>() / kept.len().max(1) as f64
}

/// The part of the light that the ways of a lane cannot find.
fn lost(blocks: &[Block], lane: usize) -> f64 {
    let sum = |of: fn(&Block, usize) -> f64| blocks.iter().map(|block| of(block, lane)).sum::<f64>();
    let light = sum(|block, _| block.mean);
    if light > 0.0 { sum(|block, lane| block.lost[lane]) / light } else { 0.0 }
}

/// So dark, as a part of the mean, that nobody sees the noise of what is darker.
const DARK: f64 = 0.3;

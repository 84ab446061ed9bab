//! What light paths should be aimed at, as a look at the scene tells that is taken before all others.
//!
//! What counts is noise: a light path that begins in a cell of the guide is worth the root of the mean square of what it
//! leaves in the picture, relative to what is there besides. So cells from which the camera sees nothing get few paths, and
//! so do those whose light other ways find as well. [Pantaleoni 2017]
//!
//! Few light paths tell little, and a guide by what only happened to be seen makes noise instead of less of it. So what each
//! half of them has learned is tried on the other, and where that gains little nothing is aimed.

use super::pilot::{Grid, PilotRound, SAMPLES, sample_all};
use crate::bidirectional::{
    Contribution, Lanes, LightPathVisitor, Merging, Tally, Technique, TechniqueCounts,
};
use crate::emission::Guide;
use crate::sampler::PixelSampler;
use bilux_math::Vec2;
use bilux_scene::Counters;
use std::sync::{Arc, Mutex, PoisonError};

/// Least light paths of an iteration.
pub(super) const MIN_LIGHT_PATHS: u64 = 2048;

/// So many light paths are begun, and not followed, to see how often each cell is one's.
const STARTS: u32 = 1 << 16;

/// A guide has to make the square of what light paths leave so many times smaller: those that are aimed go further, and
/// what other ways leave stays.
const WORTH_AIMING: f64 = 2.0;

/// One lane for the ways of the look itself, one for those that light paths are to be aimed for, and one for these without
/// merging.
const LANES: usize = 3;

/// All lanes, given η of the look's photons and of the film's, and the light paths that the camera is shown for each sample
/// of the look.
fn techniques(own: f32, film: f32, shown: f32, direct: bool) -> TechniqueCounts<LANES> {
    TechniqueCounts {
        splats: Lanes([shown, 1.0, 1.0]),
        joins: Lanes::ZERO,
        eta: Lanes([own, film, 0.0]),
        direct,
    }
}

/// Learns from a turn whose light paths are aimed at nothing. `eta` is that of the film's photons, of which `near` are merged with a vertex that the camera sees.
pub(super) fn learn(
    turn: PilotRound,
    merging: &Merging,
    (eta, near): (f32, f64),
) -> (Option<Guide>, Counters) {
    let mut counters = Counters::default();
    let Some(untaught) = Guide::untaught(turn.eye.scene) else { return (None, counters) };
    let turn = turn.guided(&Some(Arc::new(untaught.clone())));
    let grid = Grid::of(turn.eye.settings);
    let tiles = grid.tiles();
    let pixels = tiles.iter().map(|tile| tile.pixels()).sum::<usize>() as f32;
    let shown = turn.light.settings.width as f32 / pixels;
    let lanes = |own| techniques(own, eta, shown, merging.techniques.direct);
    let mut lessons = AimStatistics { means: vec![0.0; tiles.len()], finds: Vec::new() };
    let mut halves = Vec::new();
    for iteration in 0..SAMPLES {
        let wall = Wall::default();
        let (here, rays) = sample_all::<LANES, Contributions, Wall>(
            &turn,
            merging,
            &lanes,
            (&grid, &tiles, iteration),
            Some(&wall),
        );
        counters += rays;
        for (index, finds) in here.into_iter().enumerate() {
            let share = 1.0 / (tiles[index].pixels() as f64 * f64::from(SAMPLES));
            for finds in finds {
                lessons.means[index] += finds.light * share;
                lessons.finds.extend(finds.here.iter().map(|&(cell, square)| (index as u32, cell, square)));
            }
        }
        for seen in wall.in_order().into_iter().flat_map(|finds| finds.there) {
            let index = grid.tile_at(seen.film);
            let share = 1.0 / (tiles[index].pixels() as f64 * f64::from(SAMPLES));
            lessons.means[index] += seen.light * share;
            lessons.finds.push((index as u32, seen.cell, seen.square / (1.0 + near)));
        }
        halves.push(lessons.finds.len());
    }
    let starts = starts(&turn, untaught.cells());
    let middle = halves[halves.len() / 2 - 1];
    let parts = [0..middle, middle..lessons.finds.len()].map(|part| lessons.squares(part, starts.len()));
    let gains = [0, 1].map(|i| untaught.gain(&starts, &parts[i], &parts[1 - i]));
    if gains.map(f64::recip).iter().sum::<f64>() > 2.0 / WORTH_AIMING {
        return (None, counters);
    }
    let all: Vec<f64> = parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b).collect();
    (untaught.taught(&worth(&starts, &all)), counters)
}

/// As often as a path begins there, times the root of the mean square of what it leaves.
fn worth(starts: &[f64], squares: &[f64]) -> Vec<f64> {
    starts.iter().zip(squares).map(|(starts, sum)| (starts * sum).sqrt()).collect()
}

/// How often each cell is that of a light path that is aimed at nothing.
fn starts(turn: &PilotRound, cells: usize) -> Vec<f64> {
    let (scene, seed) = (turn.eye.scene, turn.eye.settings.seed);
    let mut counts = vec![0.0; cells];
    for i in 0..STARTS {
        let mut sampler = PixelSampler::new(seed, i, 0, 0);
        let (u_light, u) = (sampler.next_1d(), (sampler.next_2d(), sampler.next_2d()));
        if let Some(start) = turn.eye.emission.sample(scene, scene.shutter()[0], u_light, u) {
            counts[usize::from(start.cell)] += 1.0 / f64::from(STARTS);
        }
    }
    counts
}

impl Guide {
    /// How many times smaller the squares of what light paths leave would be by what was learned from others.
    fn gain(&self, starts: &[f64], learned: &[f64], squares: &[f64]) -> f64 {
        let Some(taught) = self.clone().taught(&worth(starts, learned)) else { return 0.0 };
        let often = |cell: usize| starts[cell].max(1.0 / f64::from(STARTS));
        let aimed =
            |(cell, square): (usize, &f64)| square * often(cell) / taught.probability(cell, often(cell));
        squares.iter().sum::<f64>() / squares.iter().enumerate().map(aimed).sum::<f64>()
    }
}

/// What the look has seen.
struct AimStatistics {
    /// Of each of its tiles.
    means: Vec<f64>,
    /// By light paths: tile, cell, and square of the light.
    finds: Vec<(u32, u16, f64)>,
}

impl AimStatistics {
    /// Sums of the squares for each cell, relative to what there is in the tiles.
    fn squares(&self, part: std::ops::Range<usize>, cells: usize) -> Vec<f64> {
        let dark = super::DARK * self.means.iter().sum::<f64>() / self.means.len() as f64;
        let mut sums = vec![0.0; cells];
        for &(tile, cell, square) in &self.finds[part] {
            let around = self.means[tile as usize] + dark;
            sums[usize::from(cell)] += square / (around * around).max(f64::MIN_POSITIVE);
        }
        sums
    }
}

/// What a sample has found.
#[derive(Default)]
struct Contributions {
    /// Not counting what the camera is shown of light paths.
    light: f64,
    /// By photons: the cell of each, and the square of its light.
    here: Vec<(u16, f64)>,
    there: Vec<VisibleContribution>,
}

/// What the camera sees of a light path.
struct VisibleContribution {
    film: Vec2,
    cell: u16,
    square: f64,
    light: f64,
}

/// Light as weighted by the look's ways, and the square of what the ways of another lane would find, times how often they
/// would.
fn square(found: &Contribution<LANES>, lane: usize) -> Option<(f64, f64)> {
    let all = found.own + found.others;
    let light = |lane: usize| f64::from(found.light.luminance() * found.favour) / f64::from(all.0[lane]);
    let often = f64::from(found.own.0[lane]) / f64::from(found.own.0[0]);
    let square = if often > 0.0 { often * light(lane) * light(lane) } else { 0.0 };
    (light(0).is_finite() && square.is_finite()).then_some((light(0), square))
}

impl Tally<LANES> for Contributions {
    fn here(&mut self, technique: Technique, found: &Contribution<LANES>) {
        let Some((light, square)) = square(found, 1) else { return };
        self.light += light;
        if matches!(technique, Technique::Merged { .. }) {
            self.here.push((found.origin, square));
        }
    }

    fn there(&mut self, film: Vec2, _way: Technique, found: &Contribution<LANES>) {
        if let Some((light, square)) = square(found, 2) {
            self.there.push(VisibleContribution { film, cell: found.origin, square, light });
        }
    }
}

/// Keeps what the camera sees of light paths.
#[derive(Default)]
struct Wall(Mutex<Vec<(usize, Contributions)>>);

impl LightPathVisitor<LANES> for Wall {
    type Tally = Contributions;

    fn tally(&self) -> Contributions {
        Contributions::default()
    }

    fn take(&self, tile: usize, finds: Contributions) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((tile, finds));
    }
}

impl Wall {
    /// As it would be on one thread.
    fn in_order(self) -> Vec<Contributions> {
        let mut all = self.0.into_inner().unwrap_or_else(PoisonError::into_inner);
        all.sort_by_key(|(tile, _)| *tile);
        all.into_iter().map(|(_, finds)| finds).collect()
    }
}

//! Learns where to aim light subpaths, from a pilot round before all others.
//!
//! What counts is noise: a light subpath that begins in a cell of the guide is worth the root mean square of what it
//! contributes to the picture, relative to the light there. So cells from which the camera sees nothing get few
//! subpaths, and so do those whose light other techniques find as well. [Pantaleoni 2017]
//!
//! A few light subpaths teach little, and a guide that follows what was seen by mere chance adds noise instead of
//! reducing it. So what each half of them teaches is tested on the other half, and where that gains little nothing is
//! aimed.

use super::grid::Grid;
use super::pilot::{GridPass, PilotRound, SAMPLES, sample_all};
use super::sets::DARK;
use crate::light::emission::Guide;
use crate::photons::{MergeCounts, Merging};
use crate::sampling::sampler::PixelSampler;
use crate::techniques::{Contribution, LightPathVisitor, PerSet, Tally, Technique, TechniqueCounts};
use bilux_math::Vec2;
use bilux_math::parallel::{map, ranges};
use bilux_scene::Counters;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Number of light subpaths of an iteration: one for so many of the film's pixels, within these limits.
const PART: u64 = 8;
const LIGHT_PATHS: [u64; 2] = [2048, 4096];

/// Number of light subpaths that are started, but not traced, to measure how often each cell is chosen.
const STARTS: u32 = 1 << 16;

/// A guide must reduce the squares of light subpaths' contributions by this factor: subpaths that are aimed go further,
/// and what other techniques contribute stays.
const WORTH_AIMING: f64 = 2.0;

/// One set for the techniques of the round itself, one for those that light subpaths are aimed for, and one for the
/// latter without merging.
const SET_COUNT: usize = 3;

/// All sets, given how often the round's photons are merged and the film's, and the number of light subpaths that are connected
/// with the camera for each sample of the round.
fn techniques(own: &MergeCounts, film: &TechniqueCounts, splats: f32) -> TechniqueCounts<SET_COUNT> {
    TechniqueCounts {
        splats: PerSet([splats, 1.0, 1.0]),
        connections: PerSet::ZERO,
        eta: PerSet([own.eta, film.eta.0[0], 0.0]),
        beams: PerSet([own.beams, film.beams.0[0], 0.0]),
        densest: film.densest,
        points: PerSet([own.points, film.points.0[0], 0.0]),
        radius: film.radius,
        direct: film.direct,
        splats_cones: film.splats_cones,
    }
}

/// The number of light subpaths of an iteration for a film of so many pixels.
pub(super) fn light_paths(pixels: u64) -> u64 {
    let [least, most] = LIGHT_PATHS;
    (pixels / PART).clamp(least, most)
}

/// Learns from a round whose light subpaths are not aimed. `film` are the techniques of the picture, of whose photons `near` are
/// merged with a vertex that the camera sees. Learns nothing if the time is too short for all of the round, as
/// the last of what is returned says.
pub(super) fn learn(
    round: PilotRound,
    merging: &Merging,
    film: &TechniqueCounts,
    near: f64,
    time: Option<Duration>,
) -> (Option<Guide>, Counters, bool) {
    let begun = Instant::now();
    let mut counters = Counters::default();
    let Some(untrained) = Guide::untrained(round.eye.context.scene) else { return (None, counters, false) };
    let round = round.guided(&Some(Arc::new(untrained.clone())));
    let grid = Grid::of(round.eye.settings);
    let tiles = grid.tiles();
    let pixels = tiles.iter().map(|tile| tile.pixels()).sum::<usize>() as f32;
    let splats = round.light.settings.width as f32 / pixels;
    let all_sets = |own: &MergeCounts| techniques(own, film, splats);
    let mut lessons = GuideStatistics { means: vec![0.0; tiles.len()], finds: Vec::new() };
    let mut halves = Vec::new();
    for iteration in 0..SAMPLES {
        let by_tile = ContributionsByTile::default();
        let (here, rays) = sample_all::<SET_COUNT, Contributions, ContributionsByTile>(
            &round,
            merging,
            &all_sets,
            GridPass { grid: &grid, tiles: &tiles, iteration },
            Some(&by_tile),
        );
        counters += rays;
        for (index, finds) in here.into_iter().enumerate() {
            let share = 1.0 / (tiles[index].pixels() as f64 * f64::from(SAMPLES));
            for finds in finds {
                lessons.means[index] += finds.light * share;
                lessons.finds.extend(finds.here.iter().map(|&(cell, square)| (index as u32, cell, square)));
            }
        }
        for seen in by_tile.in_order().into_iter().flat_map(|finds| finds.there) {
            let Some(index) = grid.tile_at(seen.film) else { continue };
            let share = 1.0 / (tiles[index].pixels() as f64 * f64::from(SAMPLES));
            lessons.means[index] += seen.light * share;
            lessons.finds.push((index as u32, seen.cell, seen.square / (1.0 + near)));
        }
        halves.push(lessons.finds.len());
        let expected = begun.elapsed() * SAMPLES / (iteration + 1);
        if time.is_some_and(|time| expected > time) {
            return (None, counters, true);
        }
    }
    let starts = starts(&round, untrained.cells());
    let middle = halves[halves.len() / 2 - 1];
    let parts = [0..middle, middle..lessons.finds.len()].map(|part| lessons.squares(part, starts.len()));
    let gains = [0, 1].map(|i| untrained.gain(&starts, &parts[i], &parts[1 - i]));
    if gains.map(f64::recip).iter().sum::<f64>() > 2.0 / WORTH_AIMING {
        return (None, counters, false);
    }
    let all: Vec<f64> = parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b).collect();
    (untrained.trained(&worth(&starts, &all)), counters, false)
}

/// Frequency with which a subpath begins in each cell, times the root mean square of what it contributes.
fn worth(starts: &[f64], squares: &[f64]) -> Vec<f64> {
    starts.iter().zip(squares).map(|(starts, sum)| (starts * sum).sqrt()).collect()
}

/// Frequency with which an unaimed light subpath begins in each cell.
fn starts(round: &PilotRound, cells: usize) -> Vec<f64> {
    let (scene, seed) = (round.eye.context.scene, round.eye.settings.seed);
    let cell = |i| {
        let mut sampler = PixelSampler::new(seed, i, 0, 0);
        let (u_light, u) = (sampler.next_1d(), (sampler.next_2d(), sampler.next_2d()));
        Some(round.eye.context.emission.sample(scene, scene.shutter()[0], u_light, u)?.cell)
    };
    let begun =
        map(ranges(STARTS as usize, 256), |some| some.map(|i| cell(i as u32)).collect::<Vec<Option<u16>>>());
    let mut counts = vec![0.0; cells];
    for cell in begun.into_iter().flatten().flatten() {
        counts[usize::from(cell)] += 1.0 / f64::from(STARTS);
    }
    counts
}

impl Guide {
    /// The factor by which a guide learned from others would reduce the squares of light subpaths' contributions.
    fn gain(&self, starts: &[f64], learned: &[f64], squares: &[f64]) -> f64 {
        let Some(trained) = self.clone().trained(&worth(starts, learned)) else { return 0.0 };
        let often = |cell: usize| starts[cell].max(1.0 / f64::from(STARTS));
        let aimed =
            |(cell, square): (usize, &f64)| square * often(cell) / trained.probability(cell, often(cell));
        squares.iter().sum::<f64>() / squares.iter().enumerate().map(aimed).sum::<f64>()
    }
}

/// The measurements of the round.
struct GuideStatistics {
    /// The mean of each of its tiles.
    means: Vec<f64>,
    /// Contributions of light subpaths: tile, cell, and square of the light.
    finds: Vec<(u32, u16, f64)>,
}

impl GuideStatistics {
    /// Sums of the squares for each cell, relative to the light in the tiles.
    fn squares(&self, part: std::ops::Range<usize>, cells: usize) -> Vec<f64> {
        let dark = DARK * self.means.iter().sum::<f64>() / self.means.len() as f64;
        let mut sums = vec![0.0; cells];
        for &(tile, cell, square) in &self.finds[part] {
            let around = self.means[tile as usize] + dark;
            sums[usize::from(cell)] += square / (around * around).max(f64::MIN_POSITIVE);
        }
        sums
    }
}

/// Contributions of one sample.
#[derive(Default)]
struct Contributions {
    /// Without splats.
    light: f64,
    /// Of photons: the cell of each, and the square of its light.
    here: Vec<(u16, f64)>,
    there: Vec<VisibleContribution>,
}

/// A splat of a light subpath.
struct VisibleContribution {
    film: Vec2,
    cell: u16,
    square: f64,
    light: f64,
}

/// The light as weighted by the round's techniques, and the square of what the techniques of another set would find,
/// times how often they would.
fn square(found: &Contribution<SET_COUNT>, set: usize) -> Option<(f64, f64)> {
    let all = found.own + found.others;
    let light = |set: usize| f64::from(found.light.luminance() * found.power_factor) / f64::from(all.0[set]);
    let often = f64::from(found.own.0[set]) / f64::from(found.own.0[0]);
    let square = if often > 0.0 { often * light(set) * light(set) } else { 0.0 };
    (light(0).is_finite() && square.is_finite()).then_some((light(0), square))
}

impl Tally<SET_COUNT> for Contributions {
    fn add_sample(&mut self, technique: Technique, found: &Contribution<SET_COUNT>) {
        let Some((light, square)) = square(found, 1) else { return };
        self.light += light;
        if matches!(technique, Technique::Merged { .. }) {
            self.here.push((found.origin, square));
        }
    }

    fn add_splat(&mut self, film: Vec2, _technique: Technique, found: &Contribution<SET_COUNT>) {
        if let Some((light, square)) = square(found, 2) {
            self.there.push(VisibleContribution { film, cell: found.origin, square, light });
        }
    }
}

/// Collects the splats of light subpaths.
#[derive(Default)]
struct ContributionsByTile(Mutex<Vec<(usize, Contributions)>>);

impl LightPathVisitor<SET_COUNT> for ContributionsByTile {
    type Tally = Contributions;

    fn tally(&self) -> Contributions {
        Contributions::default()
    }

    fn take(&self, tile: usize, finds: Contributions) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((tile, finds));
    }
}

impl ContributionsByTile {
    /// In the order of one thread.
    fn in_order(self) -> Vec<Contributions> {
        let mut all = self.0.into_inner().unwrap_or_else(PoisonError::into_inner);
        all.sort_by_key(|(tile, _)| *tile);
        all.into_iter().map(|(_, finds)| finds).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::integrators;
    use crate::schedule::settings::RenderSettings;
    use crate::shapes::built;
    use bilux_scene::Spec;

    /// Photons hardly ever fall within the footprints of small pixels.
    #[test]
    fn light_under_water_is_aimed_at_in_films_of_any_size() {
        let scene = built(&bilux_gallery::generate(&Spec::new("", "pool")).unwrap());
        let auto = integrators::build(&Spec::new("", "auto").with("techniques", "path-photons")).unwrap();
        for (width, height) in [(128, 96), (512, 384), (2048, 1536)] {
            for seed in 0..4 {
                let film = RenderSettings { seed, ..RenderSettings::new(width, height, 1) };
                let plan = auto.chooser().unwrap().plan(&scene, &*scene.cameras()[0].1, &film);
                let guide = plan.integrator.light_subpaths().and_then(|both| both.guide());
                assert!(guide.is_some(), "{width}x{height}, seed {seed}");
            }
        }
    }
}

//! The pilot: a few samples of the scene with all techniques. For each set of techniques it estimates how noisy a
//! picture with no others would be, and which steps a sample would take.
//!
//! Many techniques can find a path, and whichever found it here, the pilot knows how likely each set was to find it.
//! What is a rare firefly to one set is thus predicted by another that finds it all the time, which no number of the
//! one set's own pilot samples would have shown. [Grittmann 2022, eq. 10 to 13]

use super::contributions::Contributions;
use super::cost::Steps;
use super::grid::Grid;
use super::sets::SET_COUNT;
use crate::bidirectional::{BothEnds, BothEndsQueue, QueuedSample};
use crate::film::failures::SamplePlace;
use crate::film::filters::Filter;
use crate::film::window::Window;
use crate::light::emission::Guide;
use crate::photons::{MergeCounts, Merging, Photons};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::IterationSplats;
use crate::schedule::settings::{PixelAnchor, RenderSettings};
use crate::techniques::{Contribution, LightPathVisitor, Step, Tally, Technique, TechniqueCounts};
use bilux_math::Vec2;
use bilux_math::hash::hash_words;
use bilux_math::parallel::map_with;
use bilux_scene::{Counters, Tracer};
use std::sync::Arc;
use std::time::Instant;

/// The pilot takes two rounds, to separate what changes between them from what does not; and one before these, to learn
/// where light subpaths should be aimed.
pub(super) const ROUNDS: u64 = 2;

/// Samples per pixel in a round: enough to show the gain of their even distribution, which differs between techniques.
pub(super) const SAMPLES: u32 = 8;

/// The number of blocks whose samples are taken together.
const TOGETHER: usize = 8;

/// Number of photon paths in one of its iterations. Rare light is seen by them alone.
pub(super) const LIGHT_PATHS: u64 = 512;

/// Photons are merged as widely as a film of this many pixels would: the pixels that the pilot samples are few, and nearly no photon falls
/// within the footprints of small ones.
const MERGED_PIXELS: f32 = 32.0 * 24.0;

/// Maximum merging radius that is chosen, as a fraction of the scene's radius, however large the pixels' footprints are.
pub(super) const WIDEST: f32 = 0.1;

/// The pilot's measurements of a block of pixels, as means over its pixels. Luminances only.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) mean: f64,
    /// Expected variance of a pixel, times its samples, for each set: without the second moment of `finds`.
    pub(super) variance: [f64; SET_COUNT],
    /// Expected contributions of the single techniques of each set.
    pub(super) finds: [Contributions; SET_COUNT],
    /// Light that the techniques of a set cannot find at all.
    pub(super) lost: [f64; SET_COUNT],
}

/// The results of a pilot.
pub(super) struct Pilot {
    pub(super) blocks: Vec<Block>,
    /// Steps of one sample with all techniques.
    pub(super) steps: Steps,
    pub(super) counters: Counters,
    /// Whether time ended it before all of its samples.
    pub(super) is_short: bool,
}

/// The settings of a film's pilot rounds. They depend neither on the number of samples nor on the crop, so that all
/// parts of a picture are rendered in the same way.
pub(super) fn settings(film: &RenderSettings) -> [RenderSettings; 1 + ROUNDS as usize] {
    [0, 1, 2].map(|round| RenderSettings {
        spp: SAMPLES,
        samples: 0..SAMPLES,
        crop: None,
        // No sample of the picture may be one that decided how to render it.
        seed: hash_words([film.seed, 0x7069_6c6f_7421 + round]),
        ..film.clone()
    })
}

/// The settings of the photons of a round: the light subpaths of a film of its own.
pub(super) fn photon_settings(round: &RenderSettings, light_paths: u64) -> RenderSettings {
    // They may be connected with the camera, for which this is no film: none reaches beyond the edge of the true one.
    let (filter, pixel_anchor) = (Filter::default(), PixelAnchor::Centre);
    RenderSettings { width: light_paths as u32, height: 1, filter, pixel_anchor, ..round.clone() }
}

/// Merging in the pilot, where a film of so many pixels merges like this.
pub(super) fn merging(film: &Merging, pixels: f32) -> Merging {
    let wide = (film.radius * (pixels / MERGED_PIXELS).sqrt()).min(WIDEST);
    Merging { radius: film.radius.max(wide), ..*film }
}

/// The radius of a disc as large as a pixel's footprint on the first surface there, in metres: the median over the
/// pilot's pixels.
pub(super) fn pixel_radius(eye: &CameraRays, film: &RenderSettings) -> f32 {
    let mut tracer = Tracer::new(eye.context.scene, false);
    let pixels = film.width as f32 * film.height as f32;
    let grid = Grid::of(film);
    let whole = Window::whole(grid.size[0], grid.size[1]);
    let mut areas: Vec<f32> = (0..whole.pixels())
        .map(|i| grid.pixel(whole.position(i)))
        .filter_map(|(x, y)| {
            let (ray, _) = eye.sample(SamplePlace { x, y, sample: 0 });
            let camera = eye.context.camera;
            let surface = tracer.closest(&ray)?;
            let cos = surface.n_geom.dot(ray.direction.into()).abs();
            Some(1.0 / (camera.density(&ray, surface.t) * cos * pixels)).filter(|area| area.is_finite())
        })
        .collect();
    areas.sort_by(f32::total_cmp);
    areas.get(areas.len() / 2).map_or(0.0, |area| (area / std::f32::consts::PI).sqrt())
}

/// The camera subpaths of one round, and the light subpaths that provide its photons.
pub(super) struct PilotRound<'a> {
    pub(super) eye: CameraRays<'a>,
    pub(super) light: CameraRays<'a>,
}

impl PilotRound<'_> {
    /// This round with light subpaths that are aimed by a guide.
    pub(super) fn guided(self, guide: &Option<Arc<Guide>>) -> Self {
        PilotRound { eye: self.eye.guided(guide.clone()), light: self.light.guided(guide.clone()) }
    }
}

/// Runs the pilot, with fewer samples if time ends it. `techniques` gives all sets, given the η of the pilot's own photons.
pub(super) fn look(
    rounds: &[PilotRound],
    merging: &Merging,
    techniques: impl Fn(&MergeCounts) -> TechniqueCounts<SET_COUNT> + Sync,
    deadline: Option<Instant>,
) -> Pilot {
    let grid = Grid::of(rounds[0].eye.settings);
    let tiles = grid.tiles();
    let mut pilot = Pilot {
        blocks: vec![Block::default(); tiles.len()],
        steps: Steps::default(),
        counters: Counters::default(),
        is_short: false,
    };
    let pixels = tiles.iter().map(Window::pixels).sum::<usize>();
    let sums = || tiles.iter().map(|tile| vec![[0.0; SET_COUNT]; tile.pixels()]).collect::<Vec<_>>();
    let (mut both, mut taken) = ([sums(), sums()], 0);
    while taken < SAMPLES && (taken == 0 || !is_over(deadline)) {
        let pass = GridPass { grid: &grid, tiles: &tiles, iteration: taken };
        for (round, sums) in rounds.iter().zip(&mut both) {
            one_sample(round, merging, &techniques, pass, &mut pilot, sums);
        }
        taken += 1;
    }
    let samples = f64::from(taken);
    pilot.is_short = taken < SAMPLES;
    for (index, block) in pilot.blocks.iter_mut().enumerate() {
        block.scale(f64::from(SAMPLES) / samples);
        block.compare(&both[0][index], &both[1][index], samples);
    }
    pilot.steps = Steps::default().plus(&pilot.steps, 1.0 / (pixels as f64 * ROUNDS as f64 * samples));
    pilot
}

/// Whether it is too late for more.
pub(super) fn is_over(deadline: Option<Instant>) -> bool {
    deadline.is_some_and(|deadline| Instant::now() >= deadline)
}

/// One sample of each of a grid's pixels.
#[derive(Clone, Copy)]
pub(super) struct GridPass<'a> {
    pub(super) grid: &'a Grid,
    pub(super) tiles: &'a [Window],
    /// The number of the sample.
    pub(super) iteration: u32,
}

/// Takes one sample of each pixel.
fn one_sample(
    round: &PilotRound,
    merging: &Merging,
    techniques: &(impl Fn(&MergeCounts) -> TechniqueCounts<SET_COUNT> + Sync),
    pass: GridPass<'_>,
    pilot: &mut Pilot,
    sums: &mut [Vec<[f64; SET_COUNT]>],
) {
    let (looked, counters) =
        sample_all::<SET_COUNT, PilotSample, IterationSplats>(round, merging, techniques, pass, None);
    pilot.counters += counters;
    // One after the other, so that sums do not depend on threads.
    for (index, looks) in looked.into_iter().enumerate() {
        for (look, sum) in looks.iter().zip(&mut sums[index]) {
            pilot.steps = std::mem::take(&mut pilot.steps).plus(&look.steps, 1.0);
            pilot.blocks[index].add(&look.sample, share(&pass.tiles[index]));
            for (sum, found) in sum.iter_mut().zip(look.sample.sums) {
                *sum += found;
            }
            for (film, seen) in &look.seen {
                let Some(index) = pass.grid.tile_at(*film) else { continue };
                pilot.blocks[index].add(&Sample::seen(seen), share(&pass.tiles[index]));
            }
        }
    }
}

/// Takes a sample of each of the grid's pixels, tile by tile.
///
/// Each has a light subpath of its own that is connected with the camera, or none where a `visitor` receives the
/// photons' connections instead.
pub(super) fn sample_all<const N: usize, T, O>(
    PilotRound { eye, light }: &PilotRound,
    merging: &Merging,
    techniques: &(impl Fn(&MergeCounts) -> TechniqueCounts<N> + Sync),
    GridPass { grid, tiles, iteration }: GridPass<'_>,
    visitor: Option<&O>,
) -> (Vec<Vec<T>>, Counters)
where
    T: Tally<N> + Default + Send,
    O: LightPathVisitor<N>,
{
    let sources = Window::whole(light.settings.width, 1).tiles(256);
    let (photons, mut counted) =
        Photons::trace(light, merging, &sources, iteration, techniques, visitor, None);
    let splats = visitor.is_none();
    let both_ends = BothEnds::merging(&photons, splats, merging.roulette_depth);
    let look = |queue: &mut BothEndsQueue<N>, tiles: &[Window]| {
        let mut tracer = Tracer::new(eye.context.scene, eye.settings.count_work);
        let places = tiles.iter().flat_map(|tile| (0..tile.pixels()).map(|i| grid.pixel(tile.position(i))));
        let places = places.map(|(x, y)| SamplePlace { x, y, sample: iteration });
        let mut samples: Vec<_> = places.map(|place| QueuedSample::new(eye.sample(place), true)).collect();
        let mut tallies: Vec<T> = samples.iter().map(|_| T::default()).collect();
        let mut splats = Vec::new();
        let add_splat =
            |i, film, technique, found: &Contribution<N>| splats.push((i, film, technique, *found));
        queue.take(&both_ends, &mut samples, &eye.context, &mut tracer, &mut tallies, add_splat);
        for (i, film, technique, found) in &splats {
            tallies[*i].add_splat(*film, *technique, found);
        }
        let mut tallies = tallies.into_iter();
        let of_tile = |tile: &Window| tallies.by_ref().take(tile.pixels()).collect();
        (tiles.iter().map(of_tile).collect(), tracer.counters)
    };
    let mut all = Vec::with_capacity(tiles.len());
    for (found, counters) in map_with(tiles.chunks(TOGETHER), BothEndsQueue::default, look) {
        all.extend::<Vec<Vec<T>>>(found);
        counted += counters;
    }
    (all, counted)
}

/// Samples per pixel in both rounds.
const SAMPLES_IN_ALL: f64 = (ROUNDS * SAMPLES as u64) as f64;

/// The weight of one sample in the mean of a block.
fn share(tile: &Window) -> f64 {
    1.0 / (tile.pixels() as f64 * SAMPLES_IN_ALL)
}

/// One sample of the pilot.
#[derive(Clone, Debug, Default)]
struct PilotSample {
    sample: Sample,
    /// The splats of its light subpath.
    seen: Vec<(Vec2, Contribution<SET_COUNT>)>,
    steps: Steps,
}

/// Light that a sample has found.
#[derive(Clone, Debug, Default)]
struct Sample {
    /// As weighted by the pilot's techniques.
    light: f64,
    /// Sum of what the single techniques of each set find, and sum of its squares.
    sums: [f64; SET_COUNT],
    squares: [f64; SET_COUNT],
    /// Prediction of that sum of squares by all techniques.
    finds: [Contributions; SET_COUNT],
    lost: [f64; SET_COUNT],
}

impl Sample {
    /// The sample of a splat. Splats come one by one: nothing else in the pixel belongs with this one.
    fn seen(found: &Contribution<SET_COUNT>) -> Sample {
        let mut sample = Sample::default();
        sample.take(found);
        Sample { squares: [0.0; SET_COUNT], ..sample }
    }

    fn take(&mut self, found: &Contribution<SET_COUNT>) {
        let Contribution { light, own, others, power_factor, .. } = *found;
        let all = own + others;
        let weighted = f64::from(light.luminance()) / f64::from(all.0[0]);
        let power_factor = f64::from(power_factor);
        if !weighted.is_finite() {
            return;
        }
        self.light += weighted * power_factor;
        for k in 0..SET_COUNT {
            // How often the set finds this path, for each time that the pilot does.
            let ratio = f64::from(all.0[k]) / f64::from(all.0[0]);
            if ratio <= 0.0 {
                self.lost[k] += weighted * power_factor;
                continue;
            }
            let found = weighted / ratio;
            self.finds[k].add(weighted, found);
            let found = found * f64::from(own.0[k]) / f64::from(own.0[0]);
            self.sums[k] += found * power_factor;
            // The prediction replaces these; neither includes `power_factor`.
            self.squares[k] += found * found;
        }
    }
}

impl Tally<SET_COUNT> for PilotSample {
    fn spend(&mut self, step: Step, count: usize) {
        self.steps.count(step, count);
    }

    fn add_sample(&mut self, technique: Technique, found: &Contribution<SET_COUNT>) {
        if matches!(technique, Technique::Merged { .. }) {
            self.steps.merge(found.own);
        }
        match technique {
            // Directly visible lights and background: antialiased edges, which all sets resolve alike, and soon.
            Technique::Connected { s: 0, t: 2 } => {
                self.sample.light += f64::from(found.weighted().luminance())
            }
            _ => self.sample.take(found),
        }
    }

    fn add_splat(&mut self, film: Vec2, _technique: Technique, found: &Contribution<SET_COUNT>) {
        self.seen.push((film, *found));
    }
}

impl Block {
    /// Adds what a sample shows by itself. The squares of what was found here make room for the predicted ones.
    fn add(&mut self, sample: &Sample, share: f64) {
        self.mean += share * sample.light;
        for k in 0..SET_COUNT {
            self.finds[k].plus(&sample.finds[k], share);
            self.variance[k] -= share * sample.squares[k];
            self.lost[k] += share * sample.lost[k];
        }
    }

    /// Multiplies all that was added, where there are fewer samples than were expected.
    fn scale(&mut self, factor: f64) {
        let finds = std::mem::take(&mut self.finds);
        self.mean *= factor;
        for (k, found) in finds.iter().enumerate() {
            self.finds[k].plus(found, factor);
            self.variance[k] *= factor;
            self.lost[k] *= factor;
        }
    }

    /// Adds what the means of each pixel over so many samples in both rounds show, given their sums: half the square of their difference
    /// is, on average, the variance of one.
    fn compare(&mut self, a: &[[f64; SET_COUNT]], b: &[[f64; SET_COUNT]], samples: f64) {
        for (one, other) in a.iter().zip(b) {
            for k in 0..SET_COUNT {
                let apart = (one[k] - other[k]) / samples;
                self.variance[k] += 0.5 * apart * apart * samples / a.len() as f64;
            }
        }
    }
}

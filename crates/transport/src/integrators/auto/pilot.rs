//! A first look at the scene: few samples, taken in all ways there are. For each set of ways it tells how noisy a picture
//! would be that was made with no others, and which steps a sample would take.
//!
//! A path is found in many ways, and whichever found it here, all sets know how likely each of theirs was to find it.
//! What is a rare and bright dot to one set is thus foreseen by means of another that finds it all the time, which no
//! number of first samples of the one would have told. [Grittmann 2022, eq. 10 to 13]

use super::cost::Steps;
use super::outliers::Contributions;
use crate::bidirectional::{
    Contribution, LightPathVisitor, Merging, Photons, Step, Tally, Technique, TechniqueCounts,
};
use crate::camera_rays::CameraRays;
use crate::emission::Guide;
use crate::integrators::bdpt::BothEnds;
use crate::render::RenderSettings;
use crate::splats::IterationSplats;
use crate::window::Window;
use bilux_math::Vec2;
use bilux_math::hash::hash_words;
use bilux_scene::{Counters, Tracer};
use rayon::prelude::*;
use std::sync::Arc;

/// One lane for the ways of the pilot itself, and one for each set that is compared.
pub(super) const LANES: usize = 1 + super::SETS.len();

/// The pilot is taken twice, so that what changes from one to the other can be told from what does not; and once before, to
/// learn what light paths should be aimed at.
pub(super) const TURNS: u64 = 2;

/// Samples of each pixel in a turn: so many that it shows what is gained by their being spread evenly, which is much for
/// some ways and little for others.
pub(super) const SAMPLES: u32 = 8;

/// Side of a block of pixels that is looked at as a whole.
const BLOCK: u32 = 4;

/// Most pixels of a pilot; and least, unless the film has fewer.
const MAX_PIXELS: u64 = 1024;
const MIN_PIXELS: u64 = 128;
/// One pixel for so many of the film's, between the two.
const PART: u64 = 48;

/// Most photon paths of one of its iterations, and least.
const MAX_LIGHT_PATHS: u64 = 8192;
pub(super) const MIN_LIGHT_PATHS: u64 = 1024;
/// One for so many of the film's, between the two.
const LIGHT_PART: u64 = 8;

/// What the pilot has seen of a block of pixels, as means over its pixels. Luminances only.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) mean: f64,
    /// Expected variance of a pixel, times its samples, for each lane: but for the second moment of `finds`.
    pub(super) variance: [f64; LANES],
    /// What single ways of each lane are expected to find.
    pub(super) finds: [Contributions; LANES],
    /// What the ways of a lane cannot find at all.
    pub(super) lost: [f64; LANES],
}

/// What a pilot has found out.
pub(super) struct Pilot {
    pub(super) blocks: Vec<Block>,
    /// Steps of one sample with all ways.
    pub(super) steps: Steps,
    pub(super) counters: Counters,
}

/// How the turns of a film's pilot are taken. They depend neither on the number of samples nor on what is cropped, so that
/// all parts of a picture are made in the same way.
pub(super) fn settings(film: &RenderSettings) -> [RenderSettings; 1 + TURNS as usize] {
    [0, 1, 2].map(|turn| RenderSettings {
        spp: SAMPLES,
        samples: 0..SAMPLES,
        crop: None,
        // No sample of the picture may be one by which it was decided how to make it.
        seed: hash_words([film.seed, 0x7069_6c6f_7421 + turn]),
        ..film.clone()
    })
}

/// The pixels of the film that a pilot looks at: a regular grid of them, each as small as it is. What differs from one
/// to the next is no noise, as it would be within larger ones.
pub(super) struct Grid {
    film: [u32; 2],
    /// Columns and rows.
    size: [u32; 2],
}

impl Grid {
    pub(super) fn of(film: &RenderSettings) -> Grid {
        let pixels = u64::from(film.width) * u64::from(film.height);
        let wanted = (pixels / PART).clamp(MIN_PIXELS, MAX_PIXELS).min(pixels);
        let scale = (wanted as f64 / pixels as f64).sqrt();
        let size =
            [film.width, film.height].map(|side| ((f64::from(side) * scale).round() as u32).clamp(1, side));
        Grid { film: [film.width, film.height], size }
    }

    pub(super) fn tiles(&self) -> Vec<Window> {
        Window::whole(self.size[0], self.size[1]).tiles(BLOCK)
    }

    /// The film's pixel at a place of the grid.
    fn pixel(&self, (x, y): (u32, u32)) -> (u32, u32) {
        let along = |at: u32, axis: usize| {
            let middle = (2 * u64::from(at) + 1) * u64::from(self.film[axis]);
            (middle / (2 * u64::from(self.size[axis]))) as u32
        };
        (along(x, 0), along(y, 1))
    }

    /// The tile at a point of the film (0..=1).
    pub(super) fn tile_at(&self, film: Vec2) -> usize {
        let [width, height] = self.size;
        let place = (film * Vec2::new(width as f32, height as f32)).as_uvec2();
        let place = [place.x.min(width - 1), place.y.min(height - 1)].map(|at| at / BLOCK);
        (place[1] * width.div_ceil(BLOCK) + place[0]) as usize
    }
}

/// Where the pilot's photons come from: the light paths of a film of its own, `least` or more.
pub(super) fn photon_settings(film: &RenderSettings, turn: &RenderSettings, least: u64) -> RenderSettings {
    let pixels = u64::from(film.width) * u64::from(film.height);
    let wanted = (pixels / LIGHT_PART).clamp(least, MAX_LIGHT_PATHS.max(least));
    RenderSettings { width: wanted as u32, height: 1, ..turn.clone() }
}

/// The radius of a disc as large as what a pixel of the film shows of the first surface there, in metres: the median over
/// the pilot's pixels.
pub(super) fn pixel_radius(eye: &CameraRays, film: &RenderSettings) -> f32 {
    let mut tracer = Tracer::new(eye.scene, false);
    let pixels = film.width as f32 * film.height as f32;
    let grid = Grid::of(film);
    let whole = Window::whole(grid.size[0], grid.size[1]);
    let mut areas: Vec<f32> = (0..whole.pixels())
        .map(|i| grid.pixel(whole.position(i)))
        .filter_map(|(x, y)| {
            let (ray, task) = eye.sample(&mut tracer, x, y, 0);
            let camera = task.camera;
            let surface = task.tracer.closest(&ray)?;
            let cos = surface.n_geom.dot(ray.direction.into()).abs();
            Some(1.0 / (camera.density(&ray, surface.t) * cos * pixels)).filter(|area| area.is_finite())
        })
        .collect();
    areas.sort_by(f32::total_cmp);
    areas.get(areas.len() / 2).map_or(0.0, |area| (area / std::f32::consts::PI).sqrt())
}

/// One turn's camera paths, and whose light paths give it photons.
pub(super) struct PilotRound<'a> {
    pub(super) eye: CameraRays<'a>,
    pub(super) light: CameraRays<'a>,
}

impl PilotRound<'_> {
    /// With light paths that are aimed as a guide says.
    pub(super) fn guided(self, guide: &Option<Arc<Guide>>) -> Self {
        PilotRound { eye: self.eye.guided(guide.clone()), light: self.light.guided(guide.clone()) }
    }
}

/// Takes the samples. `ways` tells all lanes, given the η of the pilot's own photons.
pub(super) fn look(
    turns: &[PilotRound],
    merging: &Merging,
    techniques: impl Fn(f32) -> TechniqueCounts<LANES> + Sync,
) -> Pilot {
    let grid = Grid::of(turns[0].eye.settings);
    let tiles = grid.tiles();
    let mut pilot = Pilot {
        blocks: vec![Block::default(); tiles.len()],
        steps: Steps::default(),
        counters: Counters::default(),
    };
    let pixels = tiles.iter().map(Window::pixels).sum::<usize>();
    let sums = |turn: &PilotRound, pilot: &mut Pilot| -> Vec<Vec<[f64; LANES]>> {
        let mut sums: Vec<_> = tiles.iter().map(|tile| vec![[0.0; LANES]; tile.pixels()]).collect();
        for iteration in 0..SAMPLES {
            one_sample(turn, merging, &techniques, (&grid, &tiles, iteration), pilot, &mut sums);
        }
        sums
    };
    let both: Vec<_> = turns.iter().map(|turn| sums(turn, &mut pilot)).collect();
    for (index, block) in pilot.blocks.iter_mut().enumerate() {
        block.compare(&both[0][index], &both[1][index]);
    }
    pilot.steps = Steps::default().plus(&pilot.steps, 1.0 / (pixels as f64 * SAMPLES_IN_ALL));
    pilot
}

/// One sample of each pixel.
fn one_sample(
    turn: &PilotRound,
    merging: &Merging,
    techniques: &(impl Fn(f32) -> TechniqueCounts<LANES> + Sync),
    (grid, tiles, iteration): (&Grid, &[Window], u32),
    pilot: &mut Pilot,
    sums: &mut [Vec<[f64; LANES]>],
) {
    let (looked, counters) = sample_all::<LANES, PilotSample, IterationSplats>(
        turn,
        merging,
        techniques,
        (grid, tiles, iteration),
        None,
    );
    pilot.counters += counters;
    // One after the other, so that sums do not depend on threads.
    for (index, looks) in looked.into_iter().enumerate() {
        for (look, sum) in looks.iter().zip(&mut sums[index]) {
            pilot.steps = std::mem::take(&mut pilot.steps).plus(&look.steps, 1.0);
            pilot.blocks[index].add(&look.sample, share(&tiles[index]));
            for (sum, found) in sum.iter_mut().zip(look.sample.sums) {
                *sum += found / f64::from(SAMPLES);
            }
            for (film, seen) in &look.seen {
                let index = grid.tile_at(*film);
                pilot.blocks[index].add(&Sample::seen(seen), share(&tiles[index]));
            }
        }
    }
}

/// What camera paths find, a sample of each of the grid's pixels, tile by tile; each with a light path of its own that is seen
/// from the camera, or without where an `visitor` sees the photons.
pub(super) fn sample_all<const N: usize, T, O>(
    PilotRound { eye, light }: &PilotRound,
    merging: &Merging,
    techniques: &(impl Fn(f32) -> TechniqueCounts<N> + Sync),
    (grid, tiles, iteration): (&Grid, &[Window], u32),
    visitor: Option<&O>,
) -> (Vec<Vec<T>>, Counters)
where
    T: Tally<N> + Default + Send,
    O: LightPathVisitor<N>,
{
    let sources = Window::whole(light.settings.width, 1).tiles(256);
    let (photons, mut counted) =
        Photons::trace(light, merging, &sources, iteration, |eta, _| techniques(eta), visitor);
    let of_tile = |tile: &Window| {
        let mut tracer = Tracer::new(eye.scene, eye.settings.count_work);
        let look = |i| {
            let (x, y) = grid.pixel(tile.position(i));
            let mut tally = T::default();
            let (ray, mut task) = eye.sample(&mut tracer, x, y, iteration);
            let both_ends = BothEnds::merging(&photons, visitor.is_none(), eye.integrator.roulette_depth());
            both_ends.sample(&ray, true, &mut task, &mut tally);
            tally
        };
        let tallies: Vec<T> = (0..tile.pixels()).map(look).collect();
        (tallies, tracer.counters)
    };
    let (found, counters): (Vec<_>, Vec<Counters>) = tiles.par_iter().map(of_tile).unzip();
    counters.into_iter().for_each(|counters| counted += counters);
    (found, counted)
}

/// Of a pixel, over both turns.
const SAMPLES_IN_ALL: f64 = (TURNS * SAMPLES as u64) as f64;

/// What one sample counts in the mean of a block.
fn share(tile: &Window) -> f64 {
    1.0 / (tile.pixels() as f64 * SAMPLES_IN_ALL)
}

/// One sample of the pilot.
#[derive(Clone, Debug, Default)]
struct PilotSample {
    sample: Sample,
    /// What its light path has left on the film.
    seen: Vec<(Vec2, Contribution<LANES>)>,
    steps: Steps,
}

/// Light that was found.
#[derive(Clone, Debug, Default)]
struct Sample {
    /// As weighted by the pilot's ways.
    light: f64,
    /// Sum of what the single ways of each lane find, and sum of its squares.
    sums: [f64; LANES],
    squares: [f64; LANES],
    /// That sum of squares as foreseen by all ways.
    finds: [Contributions; LANES],
    lost: [f64; LANES],
}

impl Sample {
    /// Of a light path that the camera is shown. They come one by one: there is nothing else of the pixel that this one
    /// would go with.
    fn seen(found: &Contribution<LANES>) -> Sample {
        let mut sample = Sample::default();
        sample.take(found);
        Sample { squares: [0.0; LANES], ..sample }
    }

    fn take(&mut self, found: &Contribution<LANES>) {
        let Contribution { light, own, others, favour, .. } = *found;
        let all = own + others;
        let weighted = f64::from(light.luminance()) / f64::from(all.0[0]);
        let favour = f64::from(favour);
        if !weighted.is_finite() {
            return;
        }
        self.light += weighted * favour;
        for k in 0..LANES {
            // How often this path is found in the lane, for once here.
            let ratio = f64::from(all.0[k]) / f64::from(all.0[0]);
            if ratio <= 0.0 {
                self.lost[k] += weighted * favour;
                continue;
            }
            let found = weighted / ratio;
            self.finds[k].add(weighted, found);
            let found = found * f64::from(own.0[k]) / f64::from(own.0[0]);
            self.sums[k] += found * favour;
            // What is foreseen takes the place of these; neither knows of favour.
            self.squares[k] += found * found;
        }
    }
}

impl Tally<LANES> for PilotSample {
    fn spend(&mut self, step: Step, count: usize) {
        self.steps.count(step, count);
    }

    fn here(&mut self, technique: Technique, found: &Contribution<LANES>) {
        if matches!(technique, Technique::Merged { .. }) {
            self.steps.merged += 1.0 / f64::from(found.own.0[0]);
        }
        match technique {
            // Lights and sky as the camera sees them: smoothed edges, which all sets have alike, and soon.
            Technique::Joined { s: 0, t: 2 } => self.sample.light += f64::from(found.weighted().luminance()),
            _ => self.sample.take(found),
        }
    }

    fn there(&mut self, film: Vec2, _way: Technique, found: &Contribution<LANES>) {
        self.seen.push((film, *found));
    }
}

impl Block {
    /// What is told by a sample alone. The squares of what was found here make place for those that were foreseen.
    fn add(&mut self, sample: &Sample, share: f64) {
        self.mean += share * sample.light;
        for k in 0..LANES {
            self.finds[k].plus(&sample.finds[k], share);
            self.variance[k] -= share * sample.squares[k];
            self.lost[k] += share * sample.lost[k];
        }
    }

    /// What is told by the means of each pixel in both turns: half the square of their difference is, on average, the
    /// variance of one.
    fn compare(&mut self, a: &[[f64; LANES]], b: &[[f64; LANES]]) {
        for (one, other) in a.iter().zip(b) {
            for k in 0..LANES {
                let apart = one[k] - other[k];
                self.variance[k] += 0.5 * apart * apart * f64::from(SAMPLES) / a.len() as f64;
            }
        }
    }
}

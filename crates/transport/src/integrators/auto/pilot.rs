//! A first look at the scene: few samples, taken in all ways there are. For each set of ways it tells how noisy a picture
//! would be that was made with no others, and which steps a sample would take.
//!
//! A path is found in many ways, and whichever found it here, all sets know how likely each of theirs was to find it.
//! What is a rare and bright dot to one set is thus foreseen by means of another that finds it all the time, which no
//! number of first samples of the one would have told. [Grittmann 2022, eq. 10 to 13]

use super::cost::Steps;
use crate::bidirectional::{Found, Merging, Photons, Step, Tally, Way, Ways};
use crate::eye::Eye;
use crate::integrators::bdpt::BothEnds;
use crate::render::RenderSettings;
use crate::window::Window;
use bilux_math::Vec2;
use bilux_math::hash::hash_words;
use bilux_scene::{Counters, Tracer};
use rayon::prelude::*;

/// One lane for the ways of the pilot itself, and one for each set that is compared.
pub(super) const LANES: usize = 1 + super::SETS.len();

/// Samples of each pixel of the pilot: two, so that what changes from one to the other can be told from what does not.
const SAMPLES: u32 = 2;

/// Side of a block of pixels that is looked at as a whole.
const BLOCK: u32 = 8;

/// Most pixels of a pilot; and least, unless the film has fewer.
const MOST_PIXELS: u64 = 8192;
const LEAST_PIXELS: u64 = 256;
/// What part of the film's pixels it has between the two.
const PART: u64 = 16;

/// What the pilot has seen of a block of pixels, as means over its pixels. Luminances only.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) mean: f64,
    /// Expected variance of one sample, for each lane.
    pub(super) variance: [f64; LANES],
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

/// How the pilot of a film is taken: at the same places, with fewer pixels. It depends neither on the number of samples
/// nor on what is cropped, so that all parts of a picture are made in the same way.
pub(super) fn settings(film: &RenderSettings) -> RenderSettings {
    let pixels = u64::from(film.width) * u64::from(film.height);
    let wanted = (pixels / PART).clamp(LEAST_PIXELS, MOST_PIXELS).min(pixels);
    let scale = (wanted as f64 / pixels as f64).sqrt();
    let shrunk = |side: u32| ((f64::from(side) * scale).round() as u32).clamp(1, side);
    RenderSettings {
        width: shrunk(film.width),
        height: shrunk(film.height),
        spp: SAMPLES,
        samples: 0..SAMPLES,
        crop: None,
        // No sample of the picture may be one by which it was decided how to make it.
        seed: hash_words([film.seed, 0x7069_6c6f_7421]),
        ..film.clone()
    }
}

/// The radius of a disc as large as what a pixel of the film shows of the first surface there, in metres: the median over
/// the pilot's pixels.
pub(super) fn pixel_radius(eye: &Eye, film: &RenderSettings) -> f32 {
    let mut tracer = Tracer::new(eye.scene, false);
    let pixels = film.width as f32 * film.height as f32;
    let whole = Window::whole(eye.settings.width, eye.settings.height);
    let mut areas: Vec<f32> = (0..whole.pixels())
        .map(|i| whole.position(i))
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

/// Takes the samples. `ways` tells all lanes, given the η of the pilot's own photons.
pub(super) fn look(eye: &Eye, merging: &Merging, ways: impl Fn(f32) -> Ways<LANES>) -> Pilot {
    let size = Vec2::new(eye.settings.width as f32, eye.settings.height as f32);
    let tiles = Window::whole(eye.settings.width, eye.settings.height).tiles(BLOCK);
    let across = eye.settings.width.div_ceil(BLOCK);
    let mut pilot = Pilot {
        blocks: vec![Block::default(); tiles.len()],
        steps: Steps::default(),
        counters: Counters::default(),
    };
    let mut before: Vec<Vec<Sample>> = Vec::new();
    let samples = tiles.iter().map(Window::pixels).sum::<usize>() as f64 * f64::from(SAMPLES);
    for iteration in 0..SAMPLES {
        let (photons, counters) = Photons::trace(eye, merging, &tiles, iteration, |eta, _| ways(eta), None);
        pilot.counters += counters;
        let of_tile = |tile: &Window| {
            let mut tracer = Tracer::new(eye.scene, eye.settings.count_work);
            let look = |i| {
                let (x, y) = tile.position(i);
                let mut look = Look::default();
                let (ray, mut task) = eye.sample(&mut tracer, x, y, iteration);
                let both_ends = BothEnds::merging(&photons, true, eye.integrator.roulette_depth());
                both_ends.sample(&ray, true, &mut task, &mut look);
                look
            };
            let looks: Vec<Look> = (0..tile.pixels()).map(look).collect();
            (looks, tracer.counters)
        };
        let looked: Vec<(Vec<Look>, Counters)> = tiles.par_iter().map(of_tile).collect();
        let mut now = Vec::new();
        // One after the other, so that sums do not depend on threads.
        for (index, (looks, counters)) in looked.into_iter().enumerate() {
            pilot.counters += counters;
            for look in &looks {
                pilot.steps.add(&look.steps, 1.0 / samples);
                pilot.blocks[index].add(&look.sample, share(&tiles[index]));
                for (film, seen) in &look.seen {
                    let place = (*film * size).as_uvec2() / BLOCK;
                    let index = (place.y * across + place.x.min(across - 1)) as usize;
                    let index = index.min(tiles.len() - 1);
                    pilot.blocks[index].add(seen, share(&tiles[index]));
                }
            }
            let samples: Vec<Sample> = looks.into_iter().map(|look| look.sample).collect();
            if let Some(before) = before.get(index) {
                pilot.blocks[index].compare(before, &samples);
            }
            now.push(samples);
        }
        before = now;
    }
    pilot
}

/// What one sample counts in the mean of a block.
fn share(tile: &Window) -> f64 {
    1.0 / (tile.pixels() as f64 * f64::from(SAMPLES))
}

/// One sample of the pilot.
#[derive(Clone, Debug, Default)]
struct Look {
    sample: Sample,
    /// What its light path has left on the film.
    seen: Vec<(Vec2, Sample)>,
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
    foreseen: [f64; LANES],
    lost: [f64; LANES],
}

impl Sample {
    fn take(&mut self, found: &Found<LANES>) {
        let Found { light, own, others } = *found;
        let all = own + others;
        let weighted = f64::from(light.luminance()) / f64::from(all.0[0]);
        if !weighted.is_finite() {
            return;
        }
        self.light += weighted;
        for k in 0..LANES {
            // How often this path is found in the lane, for once here.
            let ratio = f64::from(all.0[k]) / f64::from(all.0[0]);
            if ratio <= 0.0 {
                self.lost[k] += weighted;
                continue;
            }
            let found = weighted / ratio;
            self.foreseen[k] += weighted * found;
            let found = found * f64::from(own.0[k]) / f64::from(own.0[0]);
            self.sums[k] += found;
            self.squares[k] += found * found;
        }
    }
}

impl Tally<LANES> for Look {
    fn spend(&mut self, step: Step, count: usize) {
        self.steps.count(step, count);
    }

    fn here(&mut self, way: Way, found: &Found<LANES>) {
        if way == Way::Merged {
            self.steps.merged += 1.0 / f64::from(found.own.0[0]);
        }
        self.sample.take(found);
    }

    fn there(&mut self, film: Vec2, found: &Found<LANES>) {
        let mut seen = Sample::default();
        seen.take(found);
        // Light paths come one by one: there is nothing else of the pixel that this one would go with.
        self.seen.push((film, Sample { squares: [0.0; LANES], ..seen }));
    }
}

impl Block {
    /// What is told by a sample alone. The squares of what was found here make place for those that were foreseen.
    fn add(&mut self, sample: &Sample, share: f64) {
        self.mean += share * sample.light;
        for k in 0..LANES {
            self.variance[k] += share * (sample.foreseen[k] - sample.squares[k]);
            self.lost[k] += share * sample.lost[k];
        }
    }

    /// What is told by two samples of each pixel: half the square of their difference is, on average, the variance of one.
    fn compare(&mut self, a: &[Sample], b: &[Sample]) {
        for (one, other) in a.iter().zip(b) {
            for k in 0..LANES {
                let apart = one.sums[k] - other.sums[k];
                self.variance[k] += 0.5 * apart * apart / a.len() as f64;
            }
        }
    }
}

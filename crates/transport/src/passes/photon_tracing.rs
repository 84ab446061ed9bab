//! Traces the light subpaths of one iteration, whose vertices are kept as photons.

use crate::bidirectional::{BATCH, LightPaths, QueuedSample, Vertex};
use crate::film::failures::SamplePlace;
use crate::film::window::Window;
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::photons::{MergeCounts, Merging, PhotonPaths, PhotonWalk, Photons, TracedPhotons};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::IterationSplats;
use crate::techniques::{Contribution, LightPathVisitor, PerSet, Tally, TechniqueCounts};
use bilux_math::parallel::map;
use bilux_scene::{Counters, Scene, Tracer};
use std::ops::Range;
use std::time::Instant;

/// One in this many of the tiles of light subpaths is traced even where time is up.
const LEAST: usize = 64;

/// The samples that can be taken together: where subpaths are merged, one of each pixel, since each iteration has photons of
/// its own; otherwise all of them.
pub(crate) fn iterations(
    integrator: &dyn PixelIntegrator,
    samples: &Range<u32>,
) -> impl Iterator<Item = Range<u32>> + use<> {
    let end = samples.end;
    let step = if integrator.merging().is_some() { 1 } else { samples.len().max(1) as u32 };
    samples.clone().step_by(step as usize).map(move |first| first..end.min(first + step))
}

/// The pixels whose light subpaths an iteration traces, and those of them that keep their beams and points: every so many.
struct Followed {
    width: u64,
    step: u64,
    beam_step: u64,
    point_step: u64,
    counts: MergeCounts,
}

impl Followed {
    fn of(scene: &Scene, merging: &Merging, tiles: &[Window], iteration: u32) -> Followed {
        let pixels: usize = tiles.iter().map(Window::pixels).sum();
        let most = ((pixels as f64 * f64::from(merging.part)) as usize).min(merging.max_light_paths as usize);
        let step = pixels.div_ceil(most.max(1)) as u64;
        let width = u64::from(tiles.iter().map(|tile| tile.x + tile.width).max().unwrap_or(1));
        let count = |step| {
            let is_one = |tile: &Window, i: usize| is_nth(tile.position(i), width, step);
            let in_tile = |tile: &Window| (0..tile.pixels()).filter(|&i| is_one(tile, i)).count();
            tiles.iter().map(in_tile).sum::<usize>() as f32
        };
        let traced = count(step);
        let beam_step = step * merging.beam_step(scene, iteration, traced) as u64;
        let point_step = step * Merging::point_step(traced) as u64;
        let paths = PhotonPaths { all: traced, with_beams: count(beam_step), with_points: count(point_step) };
        let counts = merging.counts(scene, iteration, paths, pixels as f32);
        Followed { width, step, beam_step, point_step, counts }
    }

    fn is_traced(&self, at: (u32, u32)) -> bool {
        is_nth(at, self.width, self.step)
    }

    fn count_in(&self, tile: &Window) -> usize {
        (0..tile.pixels()).filter(|&i| self.is_traced(tile.position(i))).count()
    }

    fn has_beams(&self, at: (u32, u32)) -> bool {
        is_nth(at, self.width, self.beam_step)
    }

    fn has_points(&self, at: (u32, u32)) -> bool {
        is_nth(at, self.width, self.point_step)
    }
}

/// Every pixel of so many, row by row.
fn is_nth((x, y): (u32, u32), width: u64, step: u64) -> bool {
    (u64::from(y) * width + u64::from(x)).is_multiple_of(step)
}

impl Photons {
    /// The photons of an iteration, where the integrator merges subpaths, and the work that they took. What the camera sees of
    /// their light subpaths goes to `splats`. If a `deadline` ends it early, the light subpaths so far stand for all.
    pub(crate) fn of_iteration(
        integrator: &dyn PixelIntegrator,
        rays: &CameraRays,
        tiles: &[Window],
        iteration: u32,
        splats: Option<&IterationSplats>,
        deadline: Option<Instant>,
    ) -> Option<(Photons, Counters)> {
        let merging = integrator.merging()?;
        let techniques = |counts: &MergeCounts| merging.techniques(counts);
        Some(Photons::trace(rays, merging, tiles, iteration, techniques, splats, deadline))
    }
}

impl<const N: usize> TracedPhotons<N> {
    /// Keeps the photons of a light subpath: on surfaces, and those in media if it is one `with_points`.
    fn keep<'v>(
        &mut self,
        vertices: impl Iterator<Item = &'v Vertex<N>> + Clone,
        scene: &Scene,
        channel: u8,
        techniques: &TechniqueCounts<N>,
        with_points: bool,
    ) {
        let is_kept = |vertex: &&Vertex<N>| vertex.depth > 0 || techniques.direct;
        self.surfaces.extend(vertices.clone().filter(is_kept).filter_map(Vertex::photon));
        if scene.has_coloured_distances() {
            let is_kept = |vertex: &&Vertex<N>| !vertex.at.is_in_medium() && is_kept(vertex);
            let walk = |vertex: &Vertex<N>| PhotonWalk { odds: vertex.odds, channel };
            self.walks.extend(vertices.clone().filter(is_kept).map(walk));
        }
        if with_points {
            let is_kept = |vertex: &&Vertex<N>| vertex.depth > 0 || vertex.at.direct_light(techniques).merges;
            let point = |vertex: &Vertex<N>| vertex.medium_photon(scene, channel);
            self.points.extend(vertices.filter(is_kept).filter_map(point));
        }
    }
}

impl<const N: usize> Photons<N> {
    /// Traces the light subpaths of an iteration, one per pixel, or every `n`th if there would be too many.
    ///
    /// Also returns the number of rays that this took. `techniques` gives all techniques, given how often subpaths are
    /// merged. Connections with the camera go to the `visitor`. After a `deadline` no more of them are begun than a few, and the throughput of those so
    /// far is scaled up ([`Photons::part`]): weights stay as they would be with all, and so do expected values.
    pub(crate) fn trace<O: LightPathVisitor<N>>(
        eye: &CameraRays,
        merging: &Merging,
        tiles: &[Window],
        iteration: u32,
        techniques: impl FnOnce(&MergeCounts) -> TechniqueCounts<N>,
        visitor: Option<&O>,
        deadline: Option<Instant>,
    ) -> (Photons<N>, Counters) {
        let scene = eye.context.scene;
        let followed = Followed::of(scene, merging, tiles, iteration);
        let (radius, mut techniques) = (merging.radius(scene, iteration), techniques(&followed.counts));
        // Of many lights one is sampled, seldom the nearest, which photons find by themselves.
        techniques.direct |= !eye.context.lights.is_few();
        techniques.splats_cones |= eye.context.lights.has_beams();
        let of_tile = |(index, tile): (usize, &Window)| {
            let mut tracer = Tracer::new(scene, eye.settings.count_work);
            let mut traced = TracedPhotons::NONE;
            if index > tiles.len() / LEAST && deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return (traced, tracer.counters, 0);
            }
            let mut tally = visitor.map(O::tally);
            let places: Vec<(u32, u32)> = (0..tile.pixels())
                .map(|i| tile.position(i))
                .filter(|&place| followed.is_traced(place))
                .collect();
            let mut paths = LightPaths::default();
            for places in places.chunks(BATCH) {
                let place = |&(x, y): &(u32, u32)| SamplePlace { x, y, sample: iteration };
                let has_beams = |&at: &(u32, u32)| techniques.beams != PerSet::ZERO && followed.has_beams(at);
                let sample = |at| QueuedSample::of_light(eye.light_sample(place(at)), has_beams(at));
                let mut samples: Vec<_> = places.iter().map(sample).collect();
                let context = &eye.context;
                paths.trace(&mut samples, context, &mut tracer, merging.roulette_depth, &techniques);
                traced.beams.append(&mut paths.beams);
                if let Some(tally) = &mut tally {
                    let mut current = None;
                    let add = |i: usize, film, technique, found: &Contribution<N>| {
                        if current != Some(i) {
                            O::begin(tally, places[i].0, places[i].1, iteration);
                            current = Some(i);
                        }
                        tally.add_splat(film, technique, found);
                    };
                    paths.connect_to_camera(&mut samples, context, &mut tracer, &techniques, add);
                }
                let has_points = |at| techniques.points != PerSet::ZERO && followed.has_points(at);
                for (i, sample) in samples.iter().enumerate() {
                    let (channel, with_points) = (sample.state.channel, has_points(places[i]));
                    traced.keep(paths.of(i), scene, channel, &techniques, with_points);
                }
            }
            if let (Some(visitor), Some(tally)) = (visitor, tally) {
                visitor.take(index, tally);
            }
            (traced, tracer.counters, places.len())
        };
        let (mut all, mut counted) = (TracedPhotons::NONE, Counters::default());
        let mut count = 0;
        for (part, counters, paths) in map(tiles.iter().enumerate(), of_tile) {
            all.append(part);
            counted += counters;
            count += paths;
        }
        let wanted = tiles.iter().map(|tile| followed.count_in(tile)).sum::<usize>();
        let part = (count < wanted).then_some([count, wanted]);
        if part.is_some() {
            all.scale(wanted as f32 / count.max(1) as f32);
        }
        let mut photons = Photons::new(all, radius, techniques);
        photons.part = part;
        (photons, counted)
    }
}

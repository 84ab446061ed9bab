//! Traces the light subpaths of one iteration, whose vertices are kept as photons.

use crate::bidirectional::{BATCH, LightPaths, QueuedSample, Vertex};
use crate::camera_rays::CameraRays;
use crate::failures::SamplePlace;
use crate::photons::{Merging, Photon, PhotonPosition, PhotonWalk, Photons};
use crate::pixel_integrator::PixelIntegrator;
use crate::splats::IterationSplats;
use crate::techniques::{Contribution, LightPathVisitor, Tally, TechniqueCounts};
use crate::window::Window;
use bilux_scene::{Counters, Tracer};
use rayon::prelude::*;
use std::ops::Range;

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

/// The photons of a tile, and their walks.
type OfTile<const N: usize> = (Vec<(PhotonPosition, Photon<N>)>, Vec<PhotonWalk>);

impl Photons {
    /// The photons of an iteration, where the integrator merges subpaths, and the work that they took. What the camera sees of
    /// their light subpaths goes to `splats`.
    pub(crate) fn of_iteration(
        integrator: &dyn PixelIntegrator,
        rays: &CameraRays,
        tiles: &[Window],
        iteration: u32,
        splats: Option<&IterationSplats>,
    ) -> Option<(Photons, Counters)> {
        let merging = integrator.merging()?;
        let techniques = |eta, light_paths| merging.techniques(eta, light_paths);
        Some(Photons::trace(rays, merging, tiles, iteration, techniques, splats))
    }
}

impl<const N: usize> Photons<N> {
    /// Traces the light subpaths of an iteration, one per pixel, or every `n`th if there would be too many.
    ///
    /// Also returns the number of rays that this took. `techniques` gives all techniques, given η and the number of
    /// light subpaths per pixel. Connections with the camera go to the `visitor`.
    pub(crate) fn trace<O: LightPathVisitor<N>>(
        eye: &CameraRays,
        merging: &Merging,
        tiles: &[Window],
        iteration: u32,
        techniques: impl FnOnce(f32, f32) -> TechniqueCounts<N>,
        visitor: Option<&O>,
    ) -> (Photons<N>, Counters) {
        let scene = eye.context.scene;
        let pixels: usize = tiles.iter().map(Window::pixels).sum();
        let most = ((pixels as f64 * f64::from(merging.part)) as usize).min(merging.max_light_paths as usize);
        let step = pixels.div_ceil(most.max(1)) as u32;
        let width = tiles.iter().map(|tile| tile.x + tile.width).max().unwrap_or(1);
        let is_followed = |(x, y): (u32, u32)| {
            (u64::from(y) * u64::from(width) + u64::from(x)).is_multiple_of(u64::from(step))
        };
        let followed = tiles
            .iter()
            .map(|tile| (0..tile.pixels()).filter(|&i| is_followed(tile.position(i))).count())
            .sum::<usize>();
        let radius = merging.radius(scene, iteration);
        // A camera subpath is merged with the light subpaths of its channel, one in three.
        let merged = if scene.has_coloured_distances() { followed as f32 / 3.0 } else { followed as f32 };
        let techniques = techniques(merging.area(scene, iteration) * merged, followed as f32 / pixels as f32);
        let of_tile = |(index, tile): (usize, &Window)| {
            let mut tracer = Tracer::new(scene, eye.settings.count_work);
            let (mut photons, mut walks) = (Vec::new(), Vec::new());
            let mut tally = visitor.map(O::tally);
            let places: Vec<(u32, u32)> =
                (0..tile.pixels()).map(|i| tile.position(i)).filter(|&place| is_followed(place)).collect();
            let mut paths = LightPaths::default();
            for places in places.chunks(BATCH) {
                let place = |&(x, y): &(u32, u32)| SamplePlace { x, y, sample: iteration };
                let mut samples: Vec<_> =
                    places.iter().map(|at| QueuedSample::of_light(eye.light_sample(place(at)))).collect();
                let context = &eye.context;
                paths.trace(&mut samples, context, &mut tracer, merging.roulette_depth, &techniques);
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
                let is_kept = |vertex: &&Vertex<N>| vertex.depth > 0 || techniques.direct;
                let is_coloured = scene.has_coloured_distances();
                for (i, sample) in samples.iter().enumerate() {
                    let vertices = || paths.of(i).filter(is_kept);
                    photons.extend(vertices().filter_map(Vertex::photon));
                    if is_coloured {
                        let channel = sample.state.channel;
                        let on_surface = vertices().filter(|vertex| !vertex.at.is_in_medium());
                        walks.extend(on_surface.map(|vertex| PhotonWalk { odds: vertex.odds, channel }));
                    }
                }
            }
            if let (Some(visitor), Some(tally)) = (visitor, tally) {
                visitor.take(index, tally);
            }
            ((photons, walks), tracer.counters)
        };
        let (parts, counters): (Vec<OfTile<N>>, Vec<Counters>) =
            tiles.par_iter().enumerate().map(of_tile).unzip();
        let (parts, walks): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        let mut counted = Counters::default();
        counters.into_iter().for_each(|counters| counted += counters);
        (Photons::new(parts.concat(), &walks.concat(), radius, techniques), counted)
    }
}

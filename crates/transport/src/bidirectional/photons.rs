//! What the light paths of one iteration leave in the scene, to be found by place: the vertices that camera paths merge
//! with. [Jensen 1996; Georgiev 2012]

use super::{Lanes, Tally, Vertex, Ways, light_vertices, show_to_camera};
use crate::eye::Eye;
use crate::window::Window;
use bilux_math::hash::hash_words;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Counters, Scene, Tracer};
use rayon::prelude::*;

/// How camera paths and light paths are merged.
#[derive(Clone, Copy, Debug)]
pub struct Merging {
    /// The greatest distance at which two vertices count as one in the first iteration, as a part of the scene's radius.
    pub radius: f32,
    /// How fast that distance shrinks: by the power (alpha - 1) / 2 of the iteration's number, 0..1.
    pub alpha: f32,
    /// The most light paths of an iteration whose vertices are kept.
    pub max_light_paths: u32,
    /// Of the light paths that there would be, one for each pixel, those that are followed: 0..=1.
    pub part: f32,
    /// Which ways of finding a path there are beside merging.
    pub(crate) ways: Ways,
}

impl Merging {
    /// Area of the disc that an iteration merges over, in square metres.
    pub(crate) fn area(&self, scene: &Scene, iteration: u32) -> f32 {
        let radius = self.radius(scene, iteration);
        std::f32::consts::PI * radius * radius
    }

    /// All ways of an iteration whose photons give this η, and that has so many light paths for each pixel.
    pub(crate) fn ways(&self, eta: f32, light_paths: f32) -> Ways {
        let splats = if self.shows_photons() { self.ways.splats * light_paths } else { self.ways.splats };
        Ways { eta: Lanes([eta]), splats, ..self.ways }
    }

    /// True where light paths are seen from the camera but not joined with its paths: those of the photons then do for
    /// both.
    pub(crate) fn shows_photons(&self) -> bool {
        self.radius > 0.0 && self.ways.splats != Lanes::ZERO && self.ways.joins == Lanes::ZERO
    }

    /// The radius of an iteration, in metres: it depends on nothing but the iteration's number. [Knaus 2011, eq. 20]
    fn radius(&self, scene: &Scene, iteration: u32) -> f32 {
        let shrunk = bilux_math::transcendental::powf(iteration as f32 + 1.0, 0.5 * (self.alpha - 1.0));
        scene.bounds().radius() * self.radius * shrunk
    }
}

/// A vertex of a light path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Photon<const N: usize = 1> {
    pub(crate) p: Vec3,
    /// Where it came from.
    pub(crate) wo: Vec3,
    pub(crate) n_geom: Vec3,
    pub(crate) beta: Rgb,
    /// [`Partial::joined`] and [`Partial::d_vc`] of the vertex.
    pub(crate) joined: Lanes<N>,
    pub(crate) d_vc: Lanes<N>,
    /// Scattering events before it.
    pub(crate) depth: u16,
    /// As in [`super::Vertex`].
    pub(crate) origin: u16,
}

/// All of an iteration, in a grid whose cells are as wide as the discs that merge.
pub struct Photons<const N: usize = 1> {
    radius: f32,
    /// With the expected light paths on each square metre that they are merged over: η of [Georgiev 2012].
    ways: Ways<N>,
    photons: Vec<Photon<N>>,
    /// `starts[h]..starts[h + 1]` are the photons of all cells whose hash is `h`.
    starts: Vec<u32>,
}

/// Who takes what the camera sees of light paths while they are followed, tile by tile on all threads.
pub(crate) trait Onlooker<const N: usize>: Sync {
    type Tally: Tally<N>;
    /// For one tile.
    fn tally(&self) -> Self::Tally;
    /// The next light path is that of this pixel's sample.
    fn begin(_tally: &mut Self::Tally, _x: u32, _y: u32, _sample: u32) {}
    /// What was seen of a tile's light paths.
    fn take(&self, tile: usize, tally: Self::Tally);
}

impl<const N: usize> Photons<N> {
    /// Follows the light paths of an iteration, each that of a pixel; every `n`th if there would be too many. Also how
    /// many rays that took. `ways` are all ways there are, given η and the number of light paths for each pixel. What the
    /// camera sees of them goes to the `onlooker`.
    pub(crate) fn trace<O: Onlooker<N>>(
        eye: &Eye,
        merging: &Merging,
        tiles: &[Window],
        iteration: u32,
        ways: impl FnOnce(f32, f32) -> Ways<N>,
        onlooker: Option<&O>,
    ) -> (Photons<N>, Counters) {
        let scene = eye.scene;
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
        let ways = ways(merging.area(scene, iteration) * followed as f32, followed as f32 / pixels as f32);
        let of_tile = |(index, tile): (usize, &Window)| {
            let mut tracer = Tracer::new(scene, eye.settings.count_work);
            let mut photons = Vec::new();
            let mut tally = onlooker.map(O::tally);
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)).filter(|&place| is_followed(place)) {
                let (ray, mut task) = eye.sample(&mut tracer, x, y, iteration);
                let vertices = light_vertices(&mut task, ray.time, eye.integrator.roulette_depth(), &ways);
                if let Some(tally) = &mut tally {
                    O::begin(tally, x, y, iteration);
                    show_to_camera(&mut task, &vertices, &ways, tally);
                }
                let is_kept = |vertex: &&Vertex<N>| vertex.depth > 0 || ways.direct;
                photons.extend(vertices.iter().filter(is_kept).map(|vertex| Photon {
                    p: vertex.surface.p,
                    wo: vertex.wo,
                    n_geom: vertex.surface.n_geom,
                    beta: vertex.beta,
                    joined: vertex.partial.joined,
                    d_vc: vertex.partial.d_vc,
                    depth: vertex.depth as u16,
                    origin: vertex.origin,
                }));
            }
            if let (Some(onlooker), Some(tally)) = (onlooker, tally) {
                onlooker.take(index, tally);
            }
            (photons, tracer.counters)
        };
        let (parts, counters): (Vec<Vec<Photon<N>>>, Vec<Counters>) =
            tiles.par_iter().enumerate().map(of_tile).unzip();
        let mut counted = Counters::default();
        counters.into_iter().for_each(|counters| counted += counters);
        (Photons::new(parts.concat(), radius, ways), counted)
    }

    /// In the order of their cells, and within a cell in the order in which they are given.
    pub(super) fn new(photons: Vec<Photon<N>>, radius: f32, ways: Ways<N>) -> Photons<N> {
        let buckets = photons.len().next_power_of_two();
        let hash = |p: Vec3| bucket(cell(p, radius), buckets);
        let mut keys: Vec<(u32, u32)> =
            photons.par_iter().enumerate().map(|(i, photon)| (hash(photon.p), i as u32)).collect();
        keys.par_sort_unstable();
        let mut starts = vec![0; buckets + 1];
        for (bucket, _) in &keys {
            starts[*bucket as usize + 1] += 1;
        }
        for i in 0..buckets {
            starts[i + 1] += starts[i];
        }
        let photons = keys.par_iter().map(|(_, i)| photons[*i as usize]).collect();
        Photons { radius, ways, photons, starts }
    }

    /// All ways of finding a path that there are in this iteration.
    pub(crate) fn ways(&self) -> &Ways<N> {
        &self.ways
    }

    /// Calls `visit` with every photon that is no further than the radius from a point.
    pub(crate) fn around(&self, p: Vec3, mut visit: impl FnMut(&Photon<N>)) {
        let buckets = self.starts.len() - 1;
        // Cells are two radii wide: what is near lies in the point's own or in the nearer neighbour on each axis.
        let middle = cell(p, self.radius);
        let within = p / (2.0 * self.radius) - p_floor(p, self.radius);
        let beside = [within.x, within.y, within.z].map(|x| if x < 0.5 { -1 } else { 1 });
        for corner in 0..8 {
            let near: [i64; 3] = std::array::from_fn(|k| {
                middle[k].saturating_add(if corner >> k & 1 == 1 { beside[k] } else { 0 })
            });
            let bucket = bucket(near, buckets) as usize;
            for photon in &self.photons[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
                // Of other cells with the same hash some may be near too: each is visited from its own.
                if photon.p.distance_squared(p) <= self.radius * self.radius
                    && cell(photon.p, self.radius) == near
                {
                    visit(photon);
                }
            }
        }
    }
}

fn p_floor(p: Vec3, radius: f32) -> Vec3 {
    (p / (2.0 * radius)).floor()
}

fn cell(p: Vec3, radius: f32) -> [i64; 3] {
    let floor = p_floor(p, radius);
    [floor.x as i64, floor.y as i64, floor.z as i64]
}

fn bucket(cell: [i64; 3], buckets: usize) -> u32 {
    hash_words(cell.map(|c| c as u64)) as u32 & (buckets as u32 - 1)
}

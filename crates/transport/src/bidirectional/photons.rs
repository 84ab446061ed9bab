//! What the light paths of one iteration leave in the scene, to be found by place: the vertices that camera paths merge
//! with. [Jensen 1996; Georgiev 2012]

use super::{Lanes, Tally, TechniqueCounts, Vertex, light_vertices, show_to_camera};
use crate::camera_rays::CameraRays;
use crate::window::Window;
use bilux_math::hash::mix64;
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
    pub(crate) techniques: TechniqueCounts,
}

impl Merging {
    /// Area of the disc that an iteration merges over, in square metres.
    pub(crate) fn area(&self, scene: &Scene, iteration: u32) -> f32 {
        let radius = self.radius(scene, iteration);
        std::f32::consts::PI * radius * radius
    }

    /// All ways of an iteration whose photons give this η, and that has so many light paths for each pixel.
    pub(crate) fn techniques(&self, eta: f32, light_paths: f32) -> TechniqueCounts {
        let splats =
            if self.shows_photons() { self.techniques.splats * light_paths } else { self.techniques.splats };
        TechniqueCounts { eta: Lanes([eta]), splats, ..self.techniques }
    }

    /// True where light paths are seen from the camera but not joined with its paths: those of the photons then do for
    /// both.
    pub(crate) fn shows_photons(&self) -> bool {
        self.radius > 0.0 && self.techniques.splats != Lanes::ZERO && self.techniques.joins == Lanes::ZERO
    }

    /// The radius of an iteration, in metres: it depends on nothing but the iteration's number. [Knaus 2011, eq. 20]
    fn radius(&self, scene: &Scene, iteration: u32) -> f32 {
        let shrunk = bilux_math::transcendental::powf(iteration as f32 + 1.0, 0.5 * (self.alpha - 1.0));
        scene.bounds().radius() * self.radius * shrunk
    }
}

/// Where a light path has a vertex: all that is looked at of most photons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) p: Vec3,
    /// Scattering events before it, doubled, and one more where the path is of one wavelength.
    pub(super) steps: u16,
    /// As in [`super::Vertex`].
    pub(crate) origin: u16,
}

impl Spot {
    pub(crate) fn new(p: Vec3, depth: u32, is_split: bool, origin: u16) -> Spot {
        Spot { p, steps: (depth << 1) as u16 | u16::from(is_split), origin }
    }

    /// Scattering events before it.
    #[inline]
    pub(crate) fn depth(&self) -> u32 {
        u32::from(self.steps >> 1)
    }

    /// The path up to here is of one wavelength.
    #[inline]
    pub(crate) fn is_split(&self) -> bool {
        self.steps & 1 == 1
    }
}

/// A vertex of a light path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Photon<const N: usize = 1> {
    /// Where it came from.
    pub(crate) wo: Vec3,
    pub(crate) n_geom: Vec3,
    pub(crate) beta: Rgb,
    /// [`Partial::joined`] and [`Partial::d_vc`] of the vertex.
    pub(crate) joined: Lanes<N>,
    pub(crate) d_vc: Lanes<N>,
}

/// All of an iteration, in a grid whose cells are as wide as the discs that merge. Neighbours along the x axis are
/// neighbours in memory.
pub struct Photons<const N: usize = 1> {
    radius: f32,
    /// With the expected light paths on each square metre that they are merged over: η of [Georgiev 2012].
    techniques: TechniqueCounts<N>,
    spots: Vec<Spot>,
    photons: Vec<Photon<N>>,
    /// `starts[h]..starts[h + 1]` are the photons of all cells whose hash is `h`.
    starts: Vec<u32>,
}

/// Who takes what the camera sees of light paths while they are followed, tile by tile on all threads.
pub(crate) trait LightPathVisitor<const N: usize>: Sync {
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
    /// camera sees of them goes to the `visitor`.
    pub(crate) fn trace<O: LightPathVisitor<N>>(
        eye: &CameraRays,
        merging: &Merging,
        tiles: &[Window],
        iteration: u32,
        techniques: impl FnOnce(f32, f32) -> TechniqueCounts<N>,
        visitor: Option<&O>,
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
        let techniques =
            techniques(merging.area(scene, iteration) * followed as f32, followed as f32 / pixels as f32);
        let of_tile = |(index, tile): (usize, &Window)| {
            let mut tracer = Tracer::new(scene, eye.settings.count_work);
            let mut photons = Vec::new();
            let mut tally = visitor.map(O::tally);
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)).filter(|&place| is_followed(place)) {
                let (ray, mut task) = eye.sample(&mut tracer, x, y, iteration);
                let vertices =
                    light_vertices(&mut task, ray.time, eye.integrator.roulette_depth(), &techniques);
                if let Some(tally) = &mut tally {
                    O::begin(tally, x, y, iteration);
                    show_to_camera(&mut task, &vertices, &techniques, tally);
                }
                let is_kept = |vertex: &&Vertex<N>| vertex.depth > 0 || techniques.direct;
                photons.extend(vertices.iter().filter(is_kept).map(Vertex::photon));
            }
            if let (Some(visitor), Some(tally)) = (visitor, tally) {
                visitor.take(index, tally);
            }
            (photons, tracer.counters)
        };
        let (parts, counters): (Vec<Vec<(Spot, Photon<N>)>>, Vec<Counters>) =
            tiles.par_iter().enumerate().map(of_tile).unzip();
        let mut counted = Counters::default();
        counters.into_iter().for_each(|counters| counted += counters);
        (Photons::new(parts.concat(), radius, techniques), counted)
    }

    /// In the order of their cells, and within a cell in the order in which they are given.
    pub(super) fn new(
        given: Vec<(Spot, Photon<N>)>,
        radius: f32,
        techniques: TechniqueCounts<N>,
    ) -> Photons<N> {
        let mask = given.len().next_power_of_two().max(MIN_BUCKETS) as u32 - 1;
        let buckets: Vec<u32> =
            given.par_iter().map(|(spot, _)| bucket(cell(spot.p, radius), mask)).collect();
        // Photons before each bucket; after the next loop but one, those up to its end.
        let mut starts = vec![0; mask as usize + 2];
        for &bucket in &buckets {
            starts[bucket as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut order = vec![0; given.len()];
        for (i, &bucket) in buckets.iter().enumerate() {
            let place = &mut starts[bucket as usize];
            order[*place as usize] = i as u32;
            *place += 1;
        }
        starts.rotate_right(1);
        starts[0] = 0;
        let (spots, photons) = order.par_iter().map(|&i| given[i as usize]).unzip();
        Photons { radius, techniques, spots, photons, starts }
    }

    /// All ways of finding a path that there are in this iteration.
    pub(crate) fn techniques(&self) -> &TechniqueCounts<N> {
        &self.techniques
    }

    /// Calls `visit` with every photon that is no further than the radius from a point.
    #[inline]
    pub(crate) fn around(&self, p: Vec3, mut visit: impl FnMut(&Spot, &Photon<N>)) {
        let mask = self.starts.len() as u32 - 2;
        // Cells are two radii wide: what is near lies in the point's own or in the nearer neighbour on each axis.
        let scaled = p / (2.0 * self.radius);
        let floor = scaled.floor();
        let (middle, within) = ([floor.x as i64, floor.y as i64, floor.z as i64], scaled - floor);
        let beside = [within.x, within.y, within.z].map(|x| if x < 0.5 { -1 } else { 1 });
        let corner = |i: usize| -> [i64; 3] {
            std::array::from_fn(|k| middle[k].saturating_add(if i >> k & 1 == 1 { beside[k] } else { 0 }))
        };
        // Memory is slow to answer: where photons may lie is asked of all cells at once, before any is looked into.
        let buckets: [u32; 8] = std::array::from_fn(|i| bucket(corner(i), mask));
        let ranges = buckets.map(|b| self.starts[b as usize] as usize..self.starts[b as usize + 1] as usize);
        // Of other cells with the same hash some may be near too: each is visited from its own.
        let is_shared = share_buckets(&buckets, mask);
        let radius2 = self.radius * self.radius;
        for (i, range) in ranges.into_iter().enumerate() {
            for (spot, photon) in self.spots[range.clone()].iter().zip(&self.photons[range]) {
                if spot.p.distance_squared(p) <= radius2
                    && (!is_shared || cell(spot.p, self.radius) == corner(i))
                {
                    visit(spot, photon);
                }
            }
        }
    }
}

/// True where two of the eight cells around a point may have one bucket. They come in pairs, neighbours on the x axis.
#[inline]
fn share_buckets(buckets: &[u32; 8], mask: u32) -> bool {
    let share = |a: usize, b: usize| buckets[2 * a].wrapping_sub(buckets[2 * b]).wrapping_add(1) & mask <= 2;
    share(0, 1) | share(0, 2) | share(0, 3) | share(1, 2) | share(1, 3) | share(2, 3)
}

/// A cell and its neighbours on the x axis have buckets of their own.
const MIN_BUCKETS: usize = 4;

fn cell(p: Vec3, radius: f32) -> [i64; 3] {
    let floor = (p / (2.0 * radius)).floor();
    [floor.x as i64, floor.y as i64, floor.z as i64]
}

/// A row along x begins anywhere; its cells follow one after the other.
#[inline]
fn bucket([x, y, z]: [i64; 3], mask: u32) -> u32 {
    let row = mix64((y as u64) << 32 ^ z as u64 & 0xffff_ffff) as u32;
    row.wrapping_add(x as u32) & mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    /// Points of a cube, or of a sheet of it.
    fn point(i: u64, is_flat: bool) -> Vec3 {
        let [x, y, z] = [0, 1, 2].map(|k| unit_f32(hash_words([i, k]) as u32) * 2.0 - 1.0);
        Vec3::new(x, y, if is_flat { 0.25 } else { z })
    }

    fn photons(count: u64, radius: f32, is_flat: bool) -> Photons {
        let photon = |i| {
            let spot = Spot::new(point(i, is_flat), 0, false, i as u16);
            let (wo, n_geom) = (Vec3::Z, Vec3::Z);
            (spot, Photon { wo, n_geom, beta: Rgb::WHITE, joined: Lanes::ZERO, d_vc: Lanes::ZERO })
        };
        Photons::new((0..count).map(photon).collect(), radius, TechniqueCounts::CAMERA)
    }

    #[test]
    fn each_photon_that_is_near_is_visited_once() {
        // Few photons have few buckets, which many cells share; a great radius has few cells.
        for (count, radius) in
            [(0, 0.1), (1, 0.5), (3, 2.0), (20, 0.3), (500, 0.1), (4000, 0.02), (4000, 0.2)]
        {
            for is_flat in [false, true] {
                let photons = photons(count, radius, is_flat);
                for at in (0..300).map(|i| point(1 << 32 | i, is_flat)) {
                    let mut found = Vec::new();
                    photons.around(at, |spot, _| found.push(u64::from(spot.origin)));
                    found.sort_unstable();
                    let is_near = |i: &u64| point(*i, is_flat).distance_squared(at) <= radius * radius;
                    assert!(found.into_iter().eq((0..count).filter(is_near)), "{count} {radius} {at}");
                }
            }
        }
    }

    #[test]
    fn photons_of_a_cell_keep_their_order() {
        let photons = photons(2000, 4.0, false);
        let mut last = [0; 8];
        for spot in &photons.spots {
            let octant = cell(spot.p, 4.0).iter().fold(0, |sum, c| sum * 2 + usize::from(*c == 0));
            assert!(spot.origin >= last[octant]);
            last[octant] = spot.origin;
        }
    }
}

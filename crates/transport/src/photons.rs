//! The vertices that the light subpaths of one iteration leave in the scene, indexed by position, for camera subpaths
//! to merge with. [Jensen 1996; Georgiev 2012]

use crate::beam::Beam;
use crate::limits::MAX_DEPTH;
use crate::photon_beams::PhotonBeams;
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::hash::mix64;
use bilux_math::{Rgb, Vec3};
use bilux_scene::Scene;
use rayon::prelude::*;

/// How camera subpaths and light subpaths are merged.
#[derive(Clone, Copy, Debug)]
pub struct Merging {
    /// The maximum distance between merged vertices in the first iteration, as a fraction of the scene's radius.
    pub radius: f32,
    /// How fast that distance shrinks: by the power (alpha - 1) / 2 of the iteration's number, 0..1.
    pub alpha: f32,
    /// Maximum number of light subpaths per iteration whose vertices are stored.
    pub max_light_paths: u32,
    /// The fraction of the light subpaths, one per pixel, that are traced: 0..=1.
    pub part: f32,
    /// When Russian roulette begins on the light subpaths.
    pub roulette_depth: u32,
    /// The largest extinction of media in which beams are merged, per metre; `None`: as the radius allows.
    pub(crate) densest: Option<f32>,
    /// The techniques that are used as well as merging.
    pub(crate) techniques: TechniqueCounts,
}

/// How often the photons and beams of an iteration are merged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MergeCounts {
    /// Light subpaths times the area of the disc that they are merged over, in square metres: η of [Georgiev 2012].
    pub(crate) eta: f32,
    /// Those whose beams are kept, times the width that beams are merged over, in metres.
    pub(crate) beams: f32,
    /// The largest extinction of media that have beams, per metre.
    pub(crate) densest: f32,
    /// Light subpaths per pixel.
    pub(crate) light_paths: f32,
}

impl MergeCounts {
    /// Not at all.
    pub(crate) const NONE: MergeCounts = MergeCounts { eta: 0.0, beams: 0.0, densest: 0.0, light_paths: 1.0 };
}

/// Of the mean free path of media with beams, the merging radius is at most this fraction.
const THICKEST: f32 = 0.05;

/// The number of light subpaths whose beams are kept: at most, and over the merging radius as a fraction of the scene's radius. The smaller the
/// radius, the fewer beams a ray meets: some dozens, in a room that is full of fog.
const MAX_BEAM_PATHS: f32 = 16384.0;
const BEAM_PATHS: f32 = 4.0;

impl Merging {
    /// How often an iteration merges `light_paths` light subpaths, and those of them whose beams are kept, in a film of so many
    /// `pixels`.
    pub(crate) fn counts(
        &self,
        scene: &Scene,
        iteration: u32,
        [light_paths, beam_paths]: [f32; 2],
        pixels: f32,
    ) -> MergeCounts {
        let radius = self.radius(scene, iteration);
        // A camera subpath is merged with the light subpaths of its channel, one in three.
        let share = if scene.has_coloured_distances() { 1.0 / 3.0 } else { 1.0 };
        MergeCounts {
            eta: std::f32::consts::PI * radius * radius * (light_paths * share),
            beams: if scene.scatters() { 2.0 * radius * (beam_paths * share) } else { 0.0 },
            densest: self.densest.unwrap_or(THICKEST / radius),
            light_paths: light_paths / pixels,
        }
    }

    /// Of so many light subpaths, the beams of every `n`th are kept.
    pub(crate) fn beam_step(&self, scene: &Scene, iteration: u32, light_paths: f32) -> f32 {
        let relative = self.radius(scene, iteration) / scene.bounds().radius();
        (light_paths / (BEAM_PATHS / relative).min(MAX_BEAM_PATHS)).ceil().max(1.0)
    }

    /// All techniques of an iteration that merges so often.
    pub(crate) fn techniques(&self, counts: &MergeCounts) -> TechniqueCounts {
        let MergeCounts { eta, beams, densest, light_paths } = *counts;
        let splats =
            if self.splats_photons() { self.techniques.splats * light_paths } else { self.techniques.splats };
        TechniqueCounts { eta: PerSet([eta]), beams: PerSet([beams]), densest, splats, ..self.techniques }
    }

    /// True where light subpaths are connected with the camera but not with camera subpaths: the photons' light
    /// subpaths then serve both purposes.
    pub(crate) fn splats_photons(&self) -> bool {
        self.radius > 0.0
            && self.techniques.splats != PerSet::ZERO
            && self.techniques.connections == PerSet::ZERO
    }

    /// The merging radius of an iteration, in metres: it depends only on the iteration's number. [Knaus 2011, eq. 20]
    pub(crate) fn radius(&self, scene: &Scene, iteration: u32) -> f32 {
        let shrunk = bilux_math::transcendental::powf(iteration as f32 + 1.0, 0.5 * (self.alpha - 1.0));
        scene.bounds().radius() * self.radius * shrunk
    }
}

/// The position of a light subpath's vertex: the only part of most photons that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonPosition {
    pub(crate) p: Vec3,
    /// Scattering events before it, in bits: 10 for those that count against the depth, 5 for the others, and one that is set where the
    /// subpath carries a single wavelength.
    pub(crate) steps: u16,
    /// The cell in which its light subpath began: [`crate::emission::Start::cell`].
    pub(crate) origin: u16,
}

/// The number of events that do not count against the depth that a photon knows of.
const MAX_UNCOUNTED: u32 = 31;

// Those that count fit into their bits.
const _: () = assert!(MAX_DEPTH < 1 << 10);

impl PhotonPosition {
    pub(crate) fn new(p: Vec3, counted: u32, uncounted: u32, is_split: bool, origin: u16) -> PhotonPosition {
        let steps = (counted << 6 | uncounted.min(MAX_UNCOUNTED) << 1) as u16 | u16::from(is_split);
        PhotonPosition { p, steps, origin }
    }

    /// Scattering events before it that count against the depth.
    #[inline]
    pub(crate) fn counted(&self) -> u32 {
        u32::from(self.steps >> 6)
    }

    /// Scattering events before it, of which it knows up to 31 that do not count: no one tells longer paths apart.
    #[inline]
    pub(crate) fn depth(&self) -> u32 {
        self.counted() + (u32::from(self.steps >> 1) & MAX_UNCOUNTED)
    }

    /// True where the subpath up to here carries a single wavelength.
    #[inline]
    pub(crate) fn is_split(&self) -> bool {
        self.steps & 1 == 1
    }
}

/// A vertex of a light subpath.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Photon<const N: usize = 1> {
    /// The direction that it came from.
    pub(crate) wo: Vec3,
    pub(crate) n_geom: Vec3,
    pub(crate) beta: Rgb,
    /// What the MIS weights of [`crate::bidirectional`] know of the vertex.
    pub(crate) connected: PerSet<N>,
    pub(crate) d_vc: PerSet<N>,
}

/// What a photon knows of the channels of distances in media.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonWalk {
    /// [`crate::walk::Walk::odds`].
    pub(crate) odds: Rgb,
    /// The channel of its sample's distances. It is merged with camera subpaths of the same channel.
    pub(crate) channel: u8,
}

/// All photons of an iteration, in a grid whose cells are as wide as the discs that merge.
///
/// Cells that are adjacent along the x axis are adjacent in memory.
pub struct Photons<const N: usize = 1> {
    radius: f32,
    /// With the number of light subpaths times the area that they are merged over: η of [Georgiev 2012].
    techniques: TechniqueCounts<N>,
    positions: Vec<PhotonPosition>,
    photons: Vec<Photon<N>>,
    /// What each photon knows of the channels, where distances in media are not the same in all of them.
    walks: Vec<PhotonWalk>,
    /// Their rays through media.
    beams: PhotonBeams<N>,
    /// `starts[h]..starts[h + 1]` are the photons of all cells whose hash is `h`.
    starts: Vec<u32>,
}

impl<const N: usize> Photons<N> {
    /// Sorts the photons by cell, and their walks, if they have any, and beams; within a cell they keep the order in which they are given.
    pub(crate) fn new(
        given: Vec<(PhotonPosition, Photon<N>)>,
        walks: &[PhotonWalk],
        beams: Vec<Beam<N>>,
        radius: f32,
        techniques: TechniqueCounts<N>,
    ) -> Photons<N> {
        let mask = given.len().next_power_of_two().max(MIN_BUCKETS) as u32 - 1;
        let buckets: Vec<u32> =
            given.par_iter().map(|(position, _)| bucket(cell(position.p, radius), mask)).collect();
        // Photons before each bucket; after the loop that fills `order`, photons up to its end.
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
        let (positions, photons) = order.par_iter().map(|&i| given[i as usize]).unzip();
        let walks =
            if walks.is_empty() { Vec::new() } else { order.iter().map(|&i| walks[i as usize]).collect() };
        let beams = PhotonBeams::new(beams, radius);
        Photons { radius, techniques, positions, photons, walks, beams, starts }
    }

    /// All techniques of this iteration.
    pub(crate) fn techniques(&self) -> &TechniqueCounts<N> {
        &self.techniques
    }

    /// The rays of their light subpaths through media.
    pub(crate) fn beams(&self) -> &PhotonBeams<N> {
        &self.beams
    }

    /// Calls `visit` with every photon within the radius of a point, and its walk, if photons have any.
    #[inline]
    pub(crate) fn around(
        &self,
        p: Vec3,
        mut visit: impl FnMut(&PhotonPosition, &Photon<N>, Option<&PhotonWalk>),
    ) {
        let mask = self.starts.len() as u32 - 2;
        // Cells are two radii wide: photons in range lie in the point's own cell or in the nearer neighbour on each
        // axis.
        let scaled = p / (2.0 * self.radius);
        let floor = scaled.floor();
        let (middle, within) = ([floor.x as i64, floor.y as i64, floor.z as i64], scaled - floor);
        let beside = [within.x, within.y, within.z].map(|x| if x < 0.5 { -1 } else { 1 });
        let corner = |i: usize| -> [i64; 3] {
            std::array::from_fn(|k| middle[k].saturating_add(if i >> k & 1 == 1 { beside[k] } else { 0 }))
        };
        // Memory latency is high: the ranges of all cells are loaded at once, before any photon is read.
        let buckets: [u32; 8] = std::array::from_fn(|i| bucket(corner(i), mask));
        let ranges = buckets.map(|b| self.starts[b as usize] as usize..self.starts[b as usize + 1] as usize);
        // Other cells with the same hash may be in range too: each photon is visited from its own cell.
        let is_shared = share_buckets(&buckets, mask);
        let radius2 = self.radius * self.radius;
        for (i, range) in ranges.into_iter().enumerate() {
            let first = range.start;
            let photons = self.positions[range.clone()].iter().zip(&self.photons[range]);
            for (i_photon, (position, photon)) in photons.enumerate() {
                if position.p.distance_squared(p) <= radius2
                    && (!is_shared || cell(position.p, self.radius) == corner(i))
                {
                    visit(position, photon, self.walks.get(first + i_photon));
                }
            }
        }
    }
}

/// True where two of the eight cells around a point may share a bucket. They come in pairs, neighbours on the x axis.
#[inline]
fn share_buckets(buckets: &[u32; 8], mask: u32) -> bool {
    let share = |a: usize, b: usize| buckets[2 * a].wrapping_sub(buckets[2 * b]).wrapping_add(1) & mask <= 2;
    share(0, 1) | share(0, 2) | share(0, 3) | share(1, 2) | share(1, 3) | share(2, 3)
}

/// Minimum number of buckets: a cell and its neighbours on the x axis have buckets of their own.
const MIN_BUCKETS: usize = 4;

fn cell(p: Vec3, radius: f32) -> [i64; 3] {
    let floor = (p / (2.0 * radius)).floor();
    [floor.x as i64, floor.y as i64, floor.z as i64]
}

/// The bucket of a cell: a row along x begins anywhere, and its cells follow one after the other.
#[inline]
fn bucket([x, y, z]: [i64; 3], mask: u32) -> u32 {
    let row = mix64((y as u64) << 32 ^ z as u64 & 0xffff_ffff) as u32;
    row.wrapping_add(x as u32) & mask
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    /// Points of a cube, or of a flat sheet in it.
    fn point(i: u64, is_flat: bool) -> Vec3 {
        let [x, y, z] = [0, 1, 2].map(|k| unit_f32(hash_words([i, k]) as u32) * 2.0 - 1.0);
        Vec3::new(x, y, if is_flat { 0.25 } else { z })
    }

    fn photons(count: u64, radius: f32, is_flat: bool) -> Photons {
        let photon = |i| {
            let position = PhotonPosition::new(point(i, is_flat), 0, 0, false, i as u16);
            let (wo, n_geom) = (Vec3::Z, Vec3::Z);
            (position, Photon { wo, n_geom, beta: Rgb::WHITE, connected: PerSet::ZERO, d_vc: PerSet::ZERO })
        };
        Photons::new((0..count).map(photon).collect(), &[], Vec::new(), radius, TechniqueCounts::CAMERA)
    }

    #[test]
    fn each_photon_that_is_near_is_visited_once() {
        // Few photons have few buckets, which many cells share; a large radius has few cells.
        for (count, radius) in
            [(0, 0.1), (1, 0.5), (3, 2.0), (20, 0.3), (500, 0.1), (4000, 0.02), (4000, 0.2)]
        {
            for is_flat in [false, true] {
                let photons = photons(count, radius, is_flat);
                for at in (0..300).map(|i| point(1 << 32 | i, is_flat)) {
                    let mut found = Vec::new();
                    photons.around(at, |position, _, _| found.push(u64::from(position.origin)));
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
        for position in &photons.positions {
            let octant = cell(position.p, 4.0).iter().fold(0, |sum, c| sum * 2 + usize::from(*c == 0));
            assert!(position.origin >= last[octant]);
            last[octant] = position.origin;
        }
    }
}

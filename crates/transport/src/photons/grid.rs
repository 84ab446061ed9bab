//! Photons that the light subpaths of one iteration leave at single points, indexed by position.

use crate::film::limits::MAX_DEPTH;
use bilux_math::Vec3;
use bilux_math::hash::mix64;
use bilux_math::parallel::{fill, for_each};

/// The position of a light subpath's vertex: the only part of most photons that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonPosition {
    pub(crate) p: Vec3,
    /// Scattering events before it, in bits: 10 for those that count against the depth, 5 for the others, and one that is set where the
    /// subpath carries a single wavelength.
    pub(crate) steps: u16,
    /// The cell in which its light subpath began: [`crate::light::emission::Start::cell`].
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

/// Photons that one thread sorts at a time.
const CHUNK: usize = 4096;

/// Photons in a grid whose cells are two radii wide.
///
/// Cells that are adjacent along the x axis are adjacent in memory.
pub(crate) struct PhotonGrid<P> {
    radius: f32,
    positions: Vec<PhotonPosition>,
    photons: Vec<P>,
    /// `starts[h]..starts[h + 1]` are the photons of all cells whose hash is `h`.
    starts: Vec<u32>,
}

impl<P: Copy + Send + Sync> PhotonGrid<P> {
    /// Sorts photons by cell; within a cell they keep the order in which they are given. Also returns which of the given ones stands at
    /// each place.
    pub(crate) fn new(given: Vec<(PhotonPosition, P)>, radius: f32) -> (PhotonGrid<P>, Vec<u32>) {
        let mask = given.len().next_power_of_two().max(MIN_BUCKETS) as u32 - 1;
        let mut buckets = vec![0; given.len()];
        fill(&mut buckets, CHUNK, |i| bucket(cell(given[i].0.p, radius), mask));
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
        let (mut positions, mut photons) =
            given.first().map_or_else(Default::default, |&(position, photon)| {
                (vec![position; given.len()], vec![photon; given.len()])
            });
        let places = positions.chunks_mut(CHUNK).zip(photons.chunks_mut(CHUNK)).zip(order.chunks(CHUNK));
        for_each(places, |((positions, photons), order)| {
            for ((position, photon), &i) in positions.iter_mut().zip(photons).zip(order) {
                (*position, *photon) = given[i as usize];
            }
        });
        (PhotonGrid { radius, positions, photons, starts }, order)
    }

    /// The largest radius in which photons are found, in metres.
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// Calls `visit` with every photon within a radius of a point, which is at most that of the grid, and with its place.
    #[inline]
    pub(crate) fn around(&self, p: Vec3, radius: f32, mut visit: impl FnMut(usize, &PhotonPosition, &P)) {
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
        let radius2 = radius * radius;
        for (i, range) in ranges.into_iter().enumerate() {
            let first = range.start;
            let photons = self.positions[range.clone()].iter().zip(&self.photons[range]);
            for (i_photon, (position, photon)) in photons.enumerate() {
                if position.p.distance_squared(p) <= radius2
                    && (!is_shared || cell(position.p, self.radius) == corner(i))
                {
                    visit(first + i_photon, position, photon);
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

    fn photons(count: u64, radius: f32, is_flat: bool) -> PhotonGrid<u64> {
        let position = |i| PhotonPosition::new(point(i, is_flat), 0, 0, false, i as u16);
        PhotonGrid::new((0..count).map(|i| (position(i), i)).collect(), radius).0
    }

    #[test]
    fn each_photon_that_is_near_is_visited_once() {
        // Few photons have few buckets, which many cells share; a large radius has few cells.
        for (count, radius) in
            [(0, 0.1), (1, 0.5), (3, 2.0), (20, 0.3), (500, 0.1), (4000, 0.02), (4000, 0.2)]
        {
            for is_flat in [false, true] {
                let photons = photons(count, radius, is_flat);
                for i in 0..300 {
                    let at = point(1 << 32 | i, is_flat);
                    let radius = radius * if i % 3 == 0 { 0.4 } else { 1.0 };
                    let mut found = Vec::new();
                    photons.around(at, radius, |place, _, i| {
                        assert_eq!(photons.photons[place], *i);
                        found.push(*i);
                    });
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

//! One triangle and a group of rays, operation by operation as in [`super::super::block`].

use super::super::leaf::block_bytes;
use super::super::node_format;
use super::orientation::{Corners, Orientation};
use super::rays::{Packet, RAYS, Row};
use super::wide::{Float, Half, Narrow, Wide};
use crate::bvh8::layout::{LANES, NO_TRIANGLE};
use crate::ray::{Culling, Hit, Query};

/// A group of rays at a leaf.
pub(super) struct Group<'p, O> {
    packet: &'p mut Packet,
    orientation: O,
    query: &'p Query<'p>,
    /// Its first ray.
    from: usize,
}

/// What single precision knows of a triangle that may be hit.
struct Estimate<W> {
    /// No distance is less, and none is greater.
    t: [W; 2],
    /// Rays whose hit is beyond doubt, but for its distance.
    certain: u32,
    /// Rays to which the edges run clockwise.
    below: u32,
}

/// The exact stage, for half of a group.
struct Exact<H: Half> {
    /// Rays that pass the edges on different sides.
    mixed: u32,
    /// Those whose determinant is neither zero nor infinite nor NaN.
    sound: u32,
    /// Those for which it is negative.
    below: u32,
    det: H,
    v: H,
    w: H,
    t: H::Narrow,
}

/// The error of an estimated distance, relative to the largest distance of a corner and to the condition of the
/// determinant: 32 units of rounding, where the proof in docs/adr/0032-incoherent-packets.md needs 20.
const ESTIMATE: f32 = 32.0 / 16_777_216.0;

/// Below this, products may have lost digits to underflow.
const TINY: f32 = 1.0 / (1u128 << 100) as f32;

/// Determinants that are this much smaller than their terms are left to the exact stage.
const WORST_CONDITION: f32 = 1024.0;

impl<'p, O> Group<'p, O> {
    #[inline(always)]
    pub(super) fn new(
        packet: &'p mut Packet,
        orientation: O,
        query: &'p Query<'p>,
        from: usize,
    ) -> Group<'p, O> {
        Group { packet, orientation, query, from }
    }

    /// Tests the triangles of a leaf with the rays of a mask; returns those that hit one.
    ///
    /// # Safety
    /// As for [`Group::resolve`]; `leaf` must point to that many blocks.
    #[inline(always)]
    pub(super) unsafe fn test_leaf<W: Wide, const ANY: bool>(
        &mut self,
        leaf: *const u8,
        blocks: usize,
        mut mask: u32,
    ) -> u32
    where
        O: Orientation<W>,
    {
        let mut hits = 0;
        for index in 0..blocks {
            // SAFETY: as the caller promises.
            unsafe {
                let block = leaf.add(index * block_bytes::<node_format::Wide>());
                let primitives = block.add(9 * LANES * 4).cast::<u32>();
                for lane in 0..LANES {
                    if *primitives.add(lane) == NO_TRIANGLE || mask == 0 {
                        break;
                    }
                    let hit = self.test::<W, ANY>(block, lane, mask);
                    hits |= hit;
                    if ANY {
                        mask &= !hit;
                    }
                }
            }
        }
        hits
    }

    /// Tests a triangle of a block with the rays of a mask; returns those that hit it. The nearer hits are kept,
    /// except where any hit will do.
    ///
    /// Most hits are decided in single precision: a sign that is not zero is the true one, and an estimate of the
    /// distance with bounds tells which of two hits is nearer. Only the rest goes to the exact stage.
    ///
    /// # Safety
    /// As for [`Group::resolve`]; `block` must point to a block.
    #[inline(always)]
    unsafe fn test<W: Wide, const ANY: bool>(&mut self, block: *const u8, lane: usize, mask: u32) -> u32
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises.
        unsafe {
            let from = self.from;
            let corners @ [x, y, z] = self.shear::<W>(block, lane);
            let (u, v, w) = (edge(x, y, 2, 1), edge(x, y, 0, 2), edge(x, y, 1, 0));
            let zero = W::splat(0.0);
            let (least, greatest) = (u.0.min(v.0).min(w.0), u.0.max(v.0).max(w.0));
            // If one of the three is NaN, this rejects less; the exact stage tests the rest again.
            let mixed = least.lt(zero) & zero.lt(greatest);
            // Rejects triangles wholly behind the ray's nearest hit: the exact distance is a mean of those of the
            // corners.
            let near = self.orientation.least_distance(self.packet, from, z);
            let mut mask = mask & !mixed & near.le(W::load(self.packet.limit.at(from)));
            if mask == 0 {
                return 0;
            }
            if !ANY && !O::ESTIMATES {
                mask &= !self.excluding::<W>(primitive_of(block, lane));
                return self.decide::<W, ANY>(corners, block, lane, mask);
            }
            let inside = zero.lt(least) | greatest.lt(zero);
            let Estimate { t: [low, high], certain, below } = self.estimate([u, v, w], z, inside);
            let (nearest_low, nearest) =
                (W::load(self.packet.t_low.at(from)), W::load(self.packet.t.at(from)));
            let t_min = W::load(self.packet.t_min.at(from));
            // Certainly outside the part of the ray that counts.
            mask &= !(certain & (high.lt(t_min) | nearest.lt(low)));
            if mask == 0 {
                return 0;
            }
            let primitive = primitive_of(block, lane);
            mask &= !self.excluding::<W>(primitive);
            if self.query.culling == Culling::Back {
                mask &= !(certain & (below ^ self.orientation.down(from)));
            }
            let certain = if self.query.filter.is_some() { 0 } else { certain & mask & t_min.le(low) };
            let hits = certain & if ANY { high.le(nearest) } else { high.lt(nearest_low) };
            if !ANY && hits != 0 {
                let mask = W::mask(hits);
                nearest_low.select(mask, low).store(self.packet.t_low.at_mut(from));
                nearest.select(mask, high).store(self.packet.t.at_mut(from));
                self.name::<W>(block, lane, hits);
            }
            let doubtful = mask & !hits;
            if doubtful == 0 { hits } else { hits | self.decide::<W, ANY>(corners, block, lane, doubtful) }
        }
    }

    /// The distance of a triangle whose edges, with the sizes of their terms, are given.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    unsafe fn estimate<W: Wide>(&self, [u, v, w]: [(W, W); 3], z: [W; 3], inside: u32) -> Estimate<W>
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises.
        unsafe {
            let det = u.0.add(v.0).add(w.0);
            let inverse = W::splat(1.0).div(det);
            let along = u.0.fmadd(z[0], v.0.fmadd(z[1], w.0.mul(z[2])));
            let slowness = W::load(self.packet.slowness.at(self.from));
            let t = self.orientation.forwards(self.packet, self.from, along.mul(inverse)).mul(slowness);
            let size = u.1.add(v.1).add(w.1);
            let reach = z[0].abs().max(z[1].abs()).max(z[2].abs());
            let condition = size.mul(inverse.abs());
            let error = condition.mul(W::splat(ESTIMATE)).mul(reach.mul(slowness));
            let (low, high) = (t.sub(error), t.add(error));
            let (tiny, infinity) = (W::splat(TINY), W::splat(f32::INFINITY));
            let certain = inside
                & condition.lt(W::splat(WORST_CONDITION))
                & tiny.lt(size)
                & tiny.lt(size.mul(reach))
                & tiny.lt(error)
                & W::splat(f32::NEG_INFINITY).lt(low)
                & high.lt(infinity);
            Estimate { t: [low, high], certain, below: det.lt(W::splat(0.0)) }
        }
    }

    /// The exact stage for rays that single precision cannot decide.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn decide<W: Wide, const ANY: bool>(
        &mut self,
        [x, y, z]: Corners<W>,
        block: *const u8,
        lane: usize,
        mask: u32,
    ) -> u32
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises.
        unsafe {
            if !ANY && O::ESTIMATES {
                self.resolve::<W>();
            }
            let half = W::LANES / 2;
            let lower = mask & ((1 << half) - 1);
            let mut hits = 0;
            if lower != 0 {
                let wide = |v: [W; 3]| [v[0].lower_half(), v[1].lower_half(), v[2].lower_half()];
                hits = self.cross::<W, 0, ANY>([wide(x), wide(y), wide(z)], block, lane, lower);
            }
            if mask >> half != 0 {
                let wide = |v: [W; 3]| [v[0].upper_half(), v[1].upper_half(), v[2].upper_half()];
                hits |=
                    self.cross::<W, 1, ANY>([wide(x), wide(y), wide(z)], block, lane, mask >> half) << half;
            }
            hits
        }
    }

    /// Rays that exclude a primitive.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    unsafe fn excluding<W: Wide>(&self, primitive: u32) -> u32 {
        let half = W::LANES / 2;
        // SAFETY: as the caller promises.
        unsafe {
            Float::<W>::places(primitive, self.packet.exclude.at(self.from))
                | Float::<W>::places(primitive, self.packet.exclude.at(self.from + half)) << half
        }
    }

    /// Writes down the triangle that some rays hit.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn name<W: Wide>(&mut self, block: *const u8, lane: usize, mask: u32) {
        // SAFETY: as the caller promises; a tree has fewer numbers than 32 bits can count.
        unsafe {
            let place = block.cast::<f32>().add(lane).offset_from(self.packet.base()) as u32;
            let primitive = primitive_of(block, lane);
            for (half, mask) in
                [(0, mask & ((1 << (W::LANES / 2)) - 1)), (W::LANES / 2, mask >> (W::LANES / 2))]
            {
                let at = self.from + half;
                Float::<W>::put(primitive, mask, self.packet.primitive.at_mut(at));
                Float::<W>::put(place, mask, self.packet.place.at_mut(at));
            }
        }
    }

    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn shear<W: Wide>(&self, block: *const u8, lane: usize) -> Corners<W>
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises.
        unsafe {
            let corners = self.orientation.corners(self.packet, self.from, block, lane);
            self.lean(corners)
        }
    }

    /// Shears corners relative to the origins, axes in the order of sheared space.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    unsafe fn lean<W: Wide>(&self, [x, y, z]: Corners<W>) -> Corners<W> {
        let (packet, from) = (&*self.packet, self.from);
        // SAFETY: as the caller promises.
        unsafe {
            let shear = [W::load(packet.shear[0].at(from)), W::load(packet.shear[1].at(from))];
            let lean = |numbers: [W; 3], axis: usize, k: usize| numbers[k].sub(shear[axis].mul(z[k]));
            [[lean(x, 0, 0), lean(x, 0, 1), lean(x, 0, 2)], [lean(y, 1, 0), lean(y, 1, 1), lean(y, 1, 2)], z]
        }
    }

    /// The exact values for half of the group, and everything else that decides whether a hit counts.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn cross<W: Wide, const HALF: usize, const ANY: bool>(
        &mut self,
        corners: Corners<W::Half>,
        block: *const u8,
        lane: usize,
        mask: u32,
    ) -> u32
    where
        O: Orientation<W>,
    {
        let from = self.from + HALF * W::LANES / 2;
        // SAFETY: as the caller promises.
        unsafe {
            let Exact { mixed, sound, below, det, v, w, t } =
                exact(corners, self.orientation.depth(self.packet, from));
            let primitive = primitive_of(block, lane);
            let nearest = Float::<W>::load(self.packet.t.at(from));
            let mut mask = mask & sound & !mixed & t.le(nearest);
            mask &= Float::<W>::load(self.packet.t_min.at(from)).le(t);
            if self.query.culling == Culling::Back {
                mask &= !(below ^ self.orientation.down(from));
            }
            if mask != 0 && self.query.filter.is_some() {
                let (u, v) = (v.div(det).narrow(), w.div(det).narrow());
                mask = self.apply_filter::<W>(primitive, t, u, v, mask);
            }
            if ANY || mask == 0 {
                return mask;
            }
            let mut ties = mask & t.eq(nearest);
            while ties != 0 {
                let ray = ties.trailing_zeros() as usize;
                ties &= ties - 1;
                if *self.packet.primitive.at(from + ray) <= primitive {
                    mask &= !(1 << ray);
                }
            }
            self.keep::<W>(from, mask, t, [v.div(det).narrow(), w.div(det).narrow()]);
            self.name::<W>(block, lane, mask << (HALF * W::LANES / 2));
            mask
        }
    }

    /// Stores the exact hits of half of a group.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    unsafe fn keep<W: Wide>(&mut self, from: usize, mask: u32, t: Float<W>, [u, v]: [Float<W>; 2]) {
        // SAFETY: as the caller promises.
        unsafe {
            t.store_some(mask, self.packet.t.at_mut(from));
            t.store_some(mask, self.packet.t_low.at_mut(from));
            u.store_some(mask, self.packet.u.at_mut(from));
            v.store_some(mask, self.packet.v.at_mut(from));
        }
    }

    /// Makes exact what has been estimated: the hits that rays of the group have found so far.
    ///
    /// # Safety
    /// The machine must have the level, and the group must have been prepared.
    #[inline(always)]
    pub(super) unsafe fn resolve<W: Wide>(&mut self)
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises; the places are those of triangles.
        unsafe {
            let mask = W::load(self.packet.t_low.at(self.from)).lt(W::load(self.packet.t.at(self.from)));
            if mask == 0 {
                return;
            }
            // Lanes outside the mask have no meaning.
            let mut numbers = [const { Row::<f32>::uninit() }; 9];
            let mut left = mask;
            while left != 0 {
                let ray = left.trailing_zeros() as usize;
                left &= left - 1;
                let place = self.packet.base().add(*self.packet.place.at(self.from + ray) as usize);
                for (row, numbers) in numbers.iter_mut().enumerate() {
                    *numbers.at_mut(ray) = *place.add(row * LANES);
                }
            }
            let load = |axis: usize, corner: usize| W::load(numbers[axis * 3 + corner].at(0));
            let along = |axis: usize| [load(axis, 0), load(axis, 1), load(axis, 2)];
            let corners = self.orientation.relative(self.packet, self.from, [along(0), along(1), along(2)]);
            let [x, y, z] = self.lean(corners);
            let half = W::LANES / 2;
            let lower = |v: [W; 3]| [v[0].lower_half(), v[1].lower_half(), v[2].lower_half()];
            let upper = |v: [W; 3]| [v[0].upper_half(), v[1].upper_half(), v[2].upper_half()];
            let halves = [[lower(x), lower(y), lower(z)], [upper(x), upper(y), upper(z)]];
            for (number, corners) in halves.into_iter().enumerate() {
                let from = self.from + number * half;
                let mask = mask >> (number * half) & ((1 << half) - 1);
                let Exact { det, v, w, t, .. } = exact(corners, self.orientation.depth(self.packet, from));
                self.keep::<W>(from, mask, t, [v.div(det).narrow(), w.div(det).narrow()]);
            }
        }
    }

    /// Those rays of a mask whose hits the filter accepts.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(never)]
    unsafe fn apply_filter<W: Wide>(
        &self,
        primitive: u32,
        t: Float<W>,
        u: Float<W>,
        v: Float<W>,
        mask: u32,
    ) -> u32 {
        let (mut ts, mut us, mut vs) = ([0.0; RAYS], [0.0; RAYS], [0.0; RAYS]);
        // SAFETY: as the caller promises; a group is no larger than a packet.
        unsafe {
            t.store(ts.as_mut_ptr());
            u.store(us.as_mut_ptr());
            v.store(vs.as_mut_ptr());
        }
        let accepts = |ray: usize| {
            self.query.accepts(&Hit { t: ts[ray], u: us[ray], v: vs[ray], primitive, instance: 0 })
        };
        (0..W::LANES / 2)
            .filter(|&ray| mask >> ray & 1 == 1 && accepts(ray))
            .fold(0, |kept, ray| kept | 1 << ray)
    }

    /// After hits: how far its rays still search.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    pub(super) unsafe fn finish<W: Wide>(self) {
        if self.query.early_out {
            // SAFETY: as the caller promises.
            unsafe { self.packet.set_limits::<W>(self.from) };
        }
    }
}

/// On which side of an edge the rays pass, and the size of the terms from which that is computed.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
unsafe fn edge<W: Wide>(x: [W; 3], y: [W; 3], p: usize, q: usize) -> (W, W) {
    // SAFETY: as the caller promises.
    unsafe {
        let (a, b) = (x[p].mul(y[q]), y[p].mul(x[q]));
        (a.sub(b), a.abs().add(b.abs()))
    }
}

/// # Safety
/// The machine must have the level.
#[inline(always)]
unsafe fn exact<H: Half>([x, y, z]: Corners<H>, depth: H::Narrow) -> Exact<H> {
    // SAFETY: as the caller promises.
    unsafe {
        let edge = |p: usize, q: usize| x[p].mul(y[q]).sub(y[p].mul(x[q]));
        let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
        let zero = H::splat(0.0);
        let mixed = (u.lt(zero) | v.lt(zero) | w.lt(zero)) & (zero.lt(u) | zero.lt(v) | zero.lt(w));
        let det = u.add(v).add(w);
        let infinity = H::splat(f64::INFINITY);
        let (below, above) = (det.lt(zero), zero.lt(det));
        let sound = (below & zero.sub(infinity).lt(det)) | (above & det.lt(infinity));
        let along = u.mul(z[0]).add(v.mul(z[1])).add(w.mul(z[2]));
        let t = along.div(det.mul(H::widen(depth))).narrow();
        Exact { mixed, sound, below, det, v, w, t }
    }
}

/// The primitive of a triangle.
///
/// # Safety
/// `block` must point to a block.
#[inline(always)]
unsafe fn primitive_of(block: *const u8, lane: usize) -> u32 {
    // SAFETY: a block stores its primitives after nine rows of four numbers.
    unsafe { *block.add((9 * LANES + lane) * 4).cast::<u32>() }
}

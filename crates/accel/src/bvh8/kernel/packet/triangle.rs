//! One triangle and a group of rays, operation by operation as in [`super::super::block`].

use super::super::leaf::block_bytes;
use super::super::node_format;
use super::super::wide::{Float, Half, Narrow, Wide};
use super::estimate::{Estimate, edge, estimate};
use super::exact::{Exact, exact};
use super::orientation::{Corners, Orientation};
use super::rays::{Packet, RAYS, Row};
use crate::bvh8::layout::{LANES, NO_TRIANGLE};
use crate::ray::{Culling, Hit, Query};

/// A group of rays at a leaf.
pub(super) struct Group<'p, O> {
    packet: &'p mut Packet,
    orientation: O,
    query: &'p Query<'p>,
    /// First ray of the group.
    from: usize,
}

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
            // Rejects triangles wholly behind the nearest hit: the exact distance is a mean of the corners'.
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
            let Estimate { t: [low, high], certain, below } = {
                let slowness = W::load(self.packet.slowness.at(from));
                let forwards = |x| self.orientation.forwards(self.packet, from, x);
                estimate([u, v, w], z, slowness, inside, forwards)
            };
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
            if hits != 0 {
                if !ANY {
                    let mask = W::mask(hits);
                    nearest_low.select(mask, low).store(self.packet.t_low.at_mut(from));
                    nearest.select(mask, high).store(self.packet.t.at_mut(from));
                }
                self.name::<W>(block, lane, hits);
            }
            let doubtful = mask & !hits;
            if doubtful == 0 { hits } else { hits | self.decide::<W, ANY>(corners, block, lane, doubtful) }
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
    unsafe fn name<W: Wide>(&mut self, block: *const u8, lane: usize, mask: u32)
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises; a tree has fewer numbers than 32 bits can count.
        unsafe {
            let place = block.cast::<f32>().add(lane).offset_from(self.packet.base()) as u32;
            let primitive = primitive_of(block, lane);
            for (half, mask) in
                [(0, mask & ((1 << (W::LANES / 2)) - 1)), (W::LANES / 2, mask >> (W::LANES / 2))]
            {
                let at = self.from + half;
                Float::<W>::put(primitive, mask, self.packet.primitive.at_mut(at));
                if O::ESTIMATES {
                    Float::<W>::put(place, mask, self.packet.place.at_mut(at));
                }
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
            if mask == 0 {
                return mask;
            }
            if !ANY {
                let mut ties = mask & t.eq(nearest);
                while ties != 0 {
                    let ray = ties.trailing_zeros() as usize;
                    ties &= ties - 1;
                    if *self.packet.primitive.at(from + ray) <= primitive {
                        mask &= !(1 << ray);
                    }
                }
                self.keep::<W>(from, mask, t, [v.div(det).narrow(), w.div(det).narrow()]);
            }
            self.name::<W>(block, lane, mask << (HALF * W::LANES / 2));
            mask
        }
    }

    /// Stores the exact hits of half of a group.
    ///
    /// # Safety
    /// As for [`Group::resolve`].
    #[inline(always)]
    unsafe fn keep<W: Wide>(&mut self, from: usize, mask: u32, t: Float<W>, [u, v]: [Float<W>; 2])
    where
        O: Orientation<W>,
    {
        // SAFETY: as the caller promises.
        unsafe {
            t.store_some(mask, self.packet.t.at_mut(from));
            if O::ESTIMATES {
                t.store_some(mask, self.packet.t_low.at_mut(from));
            }
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

    /// Rays of a mask whose hits the filter accepts.
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

/// The primitive of a triangle.
///
/// # Safety
/// `block` must point to a block.
#[inline(always)]
unsafe fn primitive_of(block: *const u8, lane: usize) -> u32 {
    // SAFETY: a block stores its primitives after nine rows of four numbers.
    unsafe { *block.add((9 * LANES + lane) * 4).cast::<u32>() }
}

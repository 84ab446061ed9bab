//! One triangle and a group of rays, operation by operation as in [`super::super::block`].

use super::super::leaf::block_bytes;
use super::super::node_format;
use super::orientation::{Corners, Orientation};
use super::rays::{Packet, RAYS};
use super::wide::{Float, Half, Narrow, Wide};
use crate::bvh8::layout::{LANES, NO_TRIANGLE};
use crate::ray::{Culling, Hit, Query};

/// A group of rays at a leaf. Its nearest hit distances stay in registers from triangle to triangle.
pub(super) struct Group<'p, W: Wide, O: Orientation<W>> {
    packet: &'p mut Packet,
    orientation: O,
    query: &'p Query<'p>,
    /// Its first ray.
    from: usize,
    limit: W,
    nearest: [Float<W>; 2],
}

impl<'p, W: Wide, O: Orientation<W>> Group<'p, W, O> {
    /// # Safety
    /// The machine must have the level, and the group must have been prepared.
    #[inline(always)]
    pub(super) unsafe fn new(
        packet: &'p mut Packet,
        orientation: O,
        query: &'p Query<'p>,
        from: usize,
    ) -> Group<'p, W, O> {
        // SAFETY: as the caller promises.
        unsafe {
            let limit = W::load(packet.limit.at(from));
            let nearest =
                [Float::<W>::load(packet.t.at(from)), Float::<W>::load(packet.t.at(from + W::LANES / 2))];
            Group { packet, orientation, query, from, limit, nearest }
        }
    }

    /// Tests the triangles of a leaf with the rays of a mask; returns those that hit one.
    ///
    /// # Safety
    /// As for [`Group::new`]; `leaf` must point to that many blocks.
    #[inline(always)]
    pub(super) unsafe fn test_leaf<const ANY: bool>(
        &mut self,
        leaf: *const u8,
        blocks: usize,
        mut mask: u32,
    ) -> u32 {
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
                    let hit = self.test::<ANY>(block, lane, mask);
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
    /// # Safety
    /// As for [`Group::new`]; `block` must point to a block.
    #[inline(always)]
    unsafe fn test<const ANY: bool>(&mut self, block: *const u8, lane: usize, mask: u32) -> u32 {
        // SAFETY: as the caller promises.
        unsafe {
            let [x, y, z] = self.shear(block, lane);
            let edge = |p: usize, q: usize| x[p].mul(y[q]).sub(y[p].mul(x[q]));
            let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            let zero = W::splat(0.0);
            // If one of the three is NaN, this rejects less; the exact stage tests the rest again.
            let mixed = u.min(v).min(w).lt(zero) & zero.lt(u.max(v).max(w));
            // Rejects triangles wholly behind the ray's nearest hit: the exact distance is a mean of those of the
            // corners.
            let near = self.orientation.least_distance(self.packet, self.from, z);
            let mask = mask & !mixed & near.le(self.limit);
            if mask == 0 {
                return 0;
            }
            let half = W::LANES / 2;
            let lower = mask & ((1 << half) - 1);
            let mut hits = 0;
            if lower != 0 {
                let wide = |v: [W; 3]| [v[0].lower_half(), v[1].lower_half(), v[2].lower_half()];
                hits = self.cross::<0, ANY>([wide(x), wide(y), wide(z)], block, lane, lower);
            }
            if mask >> half != 0 {
                let wide = |v: [W; 3]| [v[0].upper_half(), v[1].upper_half(), v[2].upper_half()];
                hits |= self.cross::<1, ANY>([wide(x), wide(y), wide(z)], block, lane, mask >> half) << half;
            }
            hits
        }
    }

    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn shear(&self, block: *const u8, lane: usize) -> Corners<W> {
        let (packet, from) = (&*self.packet, self.from);
        // SAFETY: as the caller promises.
        unsafe {
            let [x, y, z] = self.orientation.corners(packet, from, block, lane);
            let shear = [W::load(packet.shear[0].at(from)), W::load(packet.shear[1].at(from))];
            let lean = |numbers: [W; 3], axis: usize, k: usize| numbers[k].sub(shear[axis].mul(z[k]));
            [[lean(x, 0, 0), lean(x, 0, 1), lean(x, 0, 2)], [lean(y, 1, 0), lean(y, 1, 1), lean(y, 1, 2)], z]
        }
    }

    /// The exact stage on half of the group, and everything else that decides whether a hit counts.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(always)]
    unsafe fn cross<const HALF: usize, const ANY: bool>(
        &mut self,
        [x, y, z]: Corners<W::Half>,
        block: *const u8,
        lane: usize,
        mask: u32,
    ) -> u32 {
        let from = self.from + HALF * W::LANES / 2;
        // SAFETY: as the caller promises; a block stores its primitives after nine rows of four numbers.
        unsafe {
            let edge = |p: usize, q: usize| x[p].mul(y[q]).sub(y[p].mul(x[q]));
            let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            let zero = W::Half::splat(0.0);
            let mixed = (u.lt(zero) | v.lt(zero) | w.lt(zero)) & (zero.lt(u) | zero.lt(v) | zero.lt(w));
            let det = u.add(v).add(w);
            let infinity = W::Half::splat(f64::INFINITY);
            let (below, above) = (det.lt(zero), zero.lt(det));
            // Not zero, not infinite and not NaN.
            let sound = (below & zero.sub(infinity).lt(det)) | (above & det.lt(infinity));
            let along = u.mul(z[0]).add(v.mul(z[1])).add(w.mul(z[2]));
            let depth = W::Half::widen(self.orientation.depth(self.packet, from));
            let t = along.div(det.mul(depth)).narrow();
            let primitive = *block.add((9 * LANES + lane) * 4).cast::<u32>();
            let nearest = self.nearest[HALF];
            let mut mask = mask & sound & !mixed & t.le(nearest);
            mask &= Float::<W>::load(self.packet.t_min.at(from)).le(t);
            mask &= !Float::<W>::places(primitive, self.packet.exclude.at(from));
            if self.query.culling == Culling::Back {
                mask &= !(below ^ self.orientation.down(from));
            }
            if mask != 0 && self.query.filter.is_some() {
                mask = self.apply_filter(primitive, t, v.div(det).narrow(), w.div(det).narrow(), mask);
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
            self.nearest[HALF] = nearest.blend(mask, t);
            v.div(det).narrow().store_some(mask, self.packet.u.at_mut(from));
            w.div(det).narrow().store_some(mask, self.packet.v.at_mut(from));
            Float::<W>::put(primitive, mask, self.packet.primitive.at_mut(from));
            mask
        }
    }

    /// Those rays of a mask whose hits the filter accepts.
    ///
    /// # Safety
    /// As for [`Group::test`].
    #[inline(never)]
    unsafe fn apply_filter(&self, primitive: u32, t: Float<W>, u: Float<W>, v: Float<W>, mask: u32) -> u32 {
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

    /// Writes the results back to the packet.
    ///
    /// # Safety
    /// As for [`Group::new`].
    #[inline(always)]
    pub(super) unsafe fn finish(self) {
        // SAFETY: as the caller promises.
        unsafe {
            self.nearest[0].store(self.packet.t.at_mut(self.from));
            self.nearest[1].store(self.packet.t.at_mut(self.from + W::LANES / 2));
            if self.query.early_out {
                self.packet.set_limits::<W>(self.from);
            }
        }
    }
}

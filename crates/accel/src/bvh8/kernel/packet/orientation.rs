//! Which axes of space are x, y and z of sheared space, for a group of rays.

use super::super::wide::{Float, Wide};
use super::frustum::Frustum;
use super::rays::Packet;
use super::ready::Ready;
use crate::bvh8::layout::LANES;

/// Corners: `[axis][corner]`.
pub(super) type Corners<V> = [[V; 3]; 3];

/// The axes of sheared space.
///
/// # Safety
/// Functions must be called only on machines that have the level, with the packet that this was made for, the first
/// lane of the group, and a block.
pub(super) trait Orientation<W: Wide>: Copy {
    /// Whether the nearest hits are estimated first. Coherent rays hit the same few triangles, so for them the exact
    /// stage costs less than making estimates exact in the end.
    const ESTIMATES: bool;
    // SAFETY: as the trait says.
    /// The corners of a triangle of a block relative to the origins of the rays, axes in the order of sheared space.
    unsafe fn corners(self, packet: &Packet, from: usize, block: *const u8, lane: usize) -> Corners<W>;
    // SAFETY: as the trait says.
    /// Given corners, one for each ray and along the axes of space, likewise.
    unsafe fn relative(self, packet: &Packet, from: usize, corners: Corners<W>) -> Corners<W>;
    // SAFETY: as the trait says.
    /// A number along the third axis, as a distance along the ray.
    unsafe fn forwards(self, packet: &Packet, from: usize, x: W) -> W;
    // SAFETY: as the trait says.
    /// A distance that no point of a triangle is nearer than; takes what is along the third axis.
    unsafe fn least_distance(self, packet: &Packet, from: usize, z: [W; 3]) -> W;
    // SAFETY: as the trait says.
    /// The direction along the third axis, of half a group that begins at the lane.
    unsafe fn depth(self, packet: &Packet, from: usize) -> Float<W>;
    /// A bit for each lane from this one on in which that is negative.
    fn down(self, from: usize) -> u32;
}

/// The corner of a triangle of a block, in every lane.
///
/// # Safety
/// The machine must have the level; a block holds nine rows of four numbers.
#[inline(always)]
unsafe fn splat<W: Wide>(block: *const u8, axis: usize, corner: usize, lane: usize) -> W {
    // SAFETY: as the caller promises.
    unsafe { W::splat(*block.cast::<f32>().add((axis * 3 + corner) * LANES + lane)) }
}

/// Axes that all rays share.
impl<W: Wide> Orientation<W> for &Frustum {
    const ESTIMATES: bool = false;

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn corners(self, packet: &Packet, from: usize, block: *const u8, lane: usize) -> Corners<W> {
        // SAFETY: as the trait demands.
        unsafe {
            let corner = |axis: usize, k: usize| {
                splat::<W>(block, axis, k, lane).sub(W::load(packet.origin[axis].at(from)))
            };
            let row = |axis: usize| [corner(axis, 0), corner(axis, 1), corner(axis, 2)];
            [row(self.axes[0]), row(self.axes[1]), row(self.axes[2])]
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn relative(self, packet: &Packet, from: usize, corners: Corners<W>) -> Corners<W> {
        // SAFETY: as the trait demands.
        unsafe {
            let row = |axis: usize| {
                let ([a, b, c], origin) = (corners[axis], W::load(packet.origin[axis].at(from)));
                [a.sub(origin), b.sub(origin), c.sub(origin)]
            };
            [row(self.axes[0]), row(self.axes[1]), row(self.axes[2])]
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn forwards(self, _: &Packet, _: usize, x: W) -> W {
        // SAFETY: as the trait demands.
        unsafe { if self.down[self.axes[2]] { W::splat(0.0).sub(x) } else { x } }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn least_distance(self, _: &Packet, _: usize, z: [W; 3]) -> W {
        // SAFETY: as the trait demands.
        unsafe {
            if self.down[self.axes[2]] {
                W::splat(0.0).sub(z[0].max(z[1]).max(z[2]))
            } else {
                z[0].min(z[1]).min(z[2])
            }
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn depth(self, packet: &Packet, from: usize) -> Float<W> {
        // SAFETY: as the trait demands.
        unsafe { super::super::wide::Narrow::load(packet.direction[self.axes[2]].at(from)) }
    }

    #[inline(always)]
    fn down(self, _: usize) -> u32 {
        if self.down[self.axes[2]] { u32::MAX } else { 0 }
    }
}

/// One for each ray; masks have a bit for each.
pub(super) struct Mixed {
    /// Rays that are steepest along x, and along y.
    steep: [u64; 2],
    /// Rays that run downwards along their steepest axis.
    down: u64,
}

/// A group of them.
#[derive(Clone, Copy)]
pub(super) struct MixedLanes<W: Wide> {
    steep: [W::Mask; 2],
    down: u64,
}

impl Mixed {
    /// Finds the axes of all rays and computes their shear.
    ///
    /// # Safety
    /// The machine must have the level, and the packet must be prepared.
    #[inline(always)]
    pub(super) unsafe fn new<W: Wide>(packet: &mut Packet, ready: &Ready) -> Mixed {
        let mut steep = [0; 2];
        let mut from = 0;
        while from < ready.lanes {
            // SAFETY: as the caller promises.
            unsafe {
                let load = |axis: usize| W::load(packet.direction[axis].at(from));
                let d = [load(0), load(1), load(2)];
                let [x, y, z] = [d[0].abs(), d[1].abs(), d[2].abs()];
                // The last of a tie.
                let along_z = x.le(z) & y.le(z);
                let along_y = x.le(y) & !along_z;
                let along_x = !(along_y | along_z) & ((1u32 << W::LANES) - 1);
                let masks = [W::mask(along_x), W::mask(along_y)];
                let [x, y, z] = sheared::<W>(d, masks);
                z.store(packet.depth.at_mut(from));
                x.div(z).store(packet.shear[0].at_mut(from));
                y.div(z).store(packet.shear[1].at_mut(from));
                steep[0] |= u64::from(along_x) << from;
                steep[1] |= u64::from(along_y) << from;
            }
            from += W::LANES;
        }
        let [x, y] = steep;
        let down = ready.down[0] & x | ready.down[1] & y | ready.down[2] & !(x | y);
        Mixed { steep, down }
    }

    /// The group that begins at a lane.
    ///
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    pub(super) unsafe fn lanes<W: Wide>(&self, from: usize) -> MixedLanes<W> {
        // SAFETY: as the caller promises.
        let mask = |all: u64| unsafe { W::mask((all >> from) as u32 & ((1 << W::LANES) - 1)) };
        MixedLanes { steep: [mask(self.steep[0]), mask(self.steep[1])], down: self.down }
    }
}

/// Three numbers along the axes of space, in the order of sheared space.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
unsafe fn sheared<W: Wide>([x, y, z]: [W; 3], [along_x, along_y]: [W::Mask; 2]) -> [W; 3] {
    // SAFETY: as the caller promises.
    unsafe {
        [
            x.select(along_x, y).select(along_y, z),
            y.select(along_x, z).select(along_y, x),
            z.select(along_x, x).select(along_y, y),
        ]
    }
}

impl<W: Wide> MixedLanes<W> {
    /// A corner whose x is given, relative to the origins. Not a closure, which would be compiled without the level's
    /// instructions, and called.
    ///
    /// # Safety
    /// The machine must have the level, and the number must belong to a block.
    #[inline(always)]
    unsafe fn corner(self, packet: &Packet, from: usize, x: *const f32) -> [W; 3] {
        // SAFETY: as the caller promises; the numbers along the other axes are three rows of four further on, and six.
        unsafe {
            let (y, z) = (x.add(3 * LANES), x.add(6 * LANES));
            self.minus_origins(packet, from, [W::splat(*x), W::splat(*y), W::splat(*z)])
        }
    }

    /// Points relative to the origins.
    ///
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    unsafe fn minus_origins(self, packet: &Packet, from: usize, [x, y, z]: [W; 3]) -> [W; 3] {
        // SAFETY: as the caller promises.
        unsafe {
            let x = x.sub(W::load(packet.origin[0].at(from)));
            let y = y.sub(W::load(packet.origin[1].at(from)));
            let z = z.sub(W::load(packet.origin[2].at(from)));
            sheared::<W>([x, y, z], self.steep)
        }
    }
}

impl<W: Wide> Orientation<W> for MixedLanes<W> {
    const ESTIMATES: bool = true;

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn corners(self, packet: &Packet, from: usize, block: *const u8, lane: usize) -> Corners<W> {
        // SAFETY: as the trait demands.
        unsafe {
            let a = self.corner(packet, from, block.cast::<f32>().add(lane));
            let b = self.corner(packet, from, block.cast::<f32>().add(LANES + lane));
            let c = self.corner(packet, from, block.cast::<f32>().add(2 * LANES + lane));
            [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]]
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn relative(self, packet: &Packet, from: usize, [x, y, z]: Corners<W>) -> Corners<W> {
        // SAFETY: as the trait demands.
        unsafe {
            let a = self.minus_origins(packet, from, [x[0], y[0], z[0]]);
            let b = self.minus_origins(packet, from, [x[1], y[1], z[1]]);
            let c = self.minus_origins(packet, from, [x[2], y[2], z[2]]);
            [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]]
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn forwards(self, packet: &Packet, from: usize, x: W) -> W {
        // SAFETY: as the trait demands.
        unsafe { W::load(packet.depth.at(from)).by_sign(x, W::splat(0.0).sub(x)) }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn least_distance(self, packet: &Packet, from: usize, z: [W; 3]) -> W {
        // SAFETY: as the trait demands.
        unsafe {
            let back = W::splat(0.0).sub(z[0].max(z[1]).max(z[2]));
            W::load(packet.depth.at(from)).by_sign(z[0].min(z[1]).min(z[2]), back)
        }
    }

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn depth(self, packet: &Packet, from: usize) -> Float<W> {
        // SAFETY: as the trait demands.
        unsafe { super::super::wide::Narrow::load(packet.depth.at(from)) }
    }

    #[inline(always)]
    fn down(self, from: usize) -> u32 {
        (self.down >> from) as u32
    }
}

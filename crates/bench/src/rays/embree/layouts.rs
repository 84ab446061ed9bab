//! Rays, hits and arguments as Embree lays them out.

use bilux::accel::{Hit, Ray};
use std::ffi::c_void;

pub(super) type Pointer = *mut c_void;

const INVALID: u32 = u32::MAX;

/// `RTCRayHit`: a ray and its hit, with room for what later versions append.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub(super) struct RayHit1 {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instances: [u32; 5],
}

/// `RTCRayHit4`, `RTCRayHit8` and `RTCRayHit16`: the same for several rays, field by field.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub(super) struct RayHits<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    primitive: [u32; N],
    geometry: [u32; N],
    instances: [[u32; N]; 2],
}

/// A flag for each ray of a packet: all bits are set if it takes part. Narrower packets read the first ones.
#[repr(C, align(64))]
pub(super) struct Valid(pub(super) [i32; 16]);

/// `RTCIntersectArguments`, which has the same layout as `RTCOccludedArguments` except for the type of its last
/// function.
#[repr(C)]
pub(super) struct Arguments {
    pub(super) flags: u32,
    pub(super) features: u32,
    pub(super) context: Pointer,
    pub(super) filter: Pointer,
    pub(super) query: Pointer,
    pub(super) reserved: [usize; 2],
}

// Embree requires these layouts; otherwise it would read past the end. The narrower packets are padded at their ends.
const _: () = assert!(size_of::<RayHit1>() == 96 && align_of::<RayHit1>() == 16);
const _: () = assert!(size_of::<RayHits<16>>() == 21 * 64 && align_of::<RayHits<16>>() == 64);
const _: () = assert!(size_of::<RayHits<8>>() >= 21 * 32 && size_of::<RayHits<4>>() >= 21 * 16);

impl RayHit1 {
    pub(super) fn new(ray: &Ray) -> RayHit1 {
        RayHit1 {
            origin: ray.origin,
            t_near: ray.t_min,
            direction: ray.direction,
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: INVALID,
            geometry: INVALID,
            instances: [INVALID; 5],
        }
    }

    /// For any-hit queries, only whether there is a hit: Embree then sets the ray's end to minus infinity.
    pub(super) fn hit(&self) -> Option<Hit> {
        let is_hit = self.geometry != INVALID || self.t_far == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far, self.u, self.v, self.primitive);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}

impl<const N: usize> RayHits<N> {
    /// A packet of up to `N` rays; the last one fills the remaining lanes.
    pub(super) fn new(rays: &[Ray]) -> RayHits<N> {
        let ray = |lane: usize| &rays[lane.min(rays.len() - 1)];
        let each = |value: &dyn Fn(&Ray) -> f32| std::array::from_fn(|lane| value(ray(lane)));
        RayHits {
            origin: std::array::from_fn(|axis| each(&|ray| ray.origin[axis])),
            t_near: each(&|ray| ray.t_min),
            direction: std::array::from_fn(|axis| each(&|ray| ray.direction[axis])),
            time: [0.0; N],
            t_far: each(&|ray| ray.t_max),
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instances: [[INVALID; N]; 2],
        }
    }

    pub(super) fn hit(&self, lane: usize) -> Option<Hit> {
        let is_hit = self.geometry[lane] != INVALID || self.t_far[lane] == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far[lane], self.u[lane], self.v[lane], self.primitive[lane]);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}

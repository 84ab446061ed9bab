//! Rays in the form in which Embree takes them: one by one, or in packets.

use super::{Pointer, Tree};
use crate::rays::engines::{Answers, Engine};
use crate::rays::{Batch, Mode};
use bilux::accel::{Hit, Ray};
use std::ptr::{null, null_mut};
use std::rc::Rc;
use std::time::Instant;

const FLAG_COHERENT: u32 = 1 << 16;
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
pub(super) struct Valid([i32; 16]);

/// `RTCIntersectArguments`, which has the same layout as `RTCOccludedArguments` except for the type of its last
/// function.
#[repr(C)]
pub(super) struct Arguments {
    flags: u32,
    features: u32,
    context: Pointer,
    filter: Pointer,
    query: Pointer,
    reserved: [usize; 2],
}

// Embree requires these layouts; otherwise it would read past the end. The narrower packets are padded at their ends.
const _: () = assert!(size_of::<RayHit1>() == 96 && align_of::<RayHit1>() == 16);
const _: () = assert!(size_of::<RayHits<16>>() == 21 * 64 && align_of::<RayHits<16>>() == 64);
const _: () = assert!(size_of::<RayHits<8>>() >= 21 * 32 && size_of::<RayHits<4>>() >= 21 * 16);

/// How rays are passed to Embree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rays) struct Packets {
    /// The number of rays in a call: 1, 4, 8 or 16.
    pub(super) width: usize,
    /// Embree is told that rays run side by side.
    pub(super) coherent: bool,
}

impl Packets {
    pub(super) const ONE: Packets = Packets { width: 1, coherent: false };

    /// What follows the name of a tree in the name of an engine.
    pub(in crate::rays) fn suffix(self) -> String {
        match self {
            Packets::ONE => String::new(),
            Packets { width, coherent: false } => format!("/{width}"),
            Packets { width, coherent: true } => format!("/{width}-coherent"),
        }
    }
}

/// A tree together with one way of tracing rays through it.
pub(in crate::rays) struct EmbreeEngine {
    pub(in crate::rays) tree: Rc<Tree>,
    pub(in crate::rays) packets: Packets,
}

/// A call that traces a packet.
///
/// # Safety
/// It must be called as Embree's documentation says.
type Query<const N: usize> = unsafe extern "C" fn(*const Valid, Pointer, *mut RayHits<N>, *const Arguments);

impl Engine for EmbreeEngine {
    fn mode(&self) -> Mode {
        if self.packets == Packets::ONE { Mode::Single } else { Mode::Batch }
    }

    fn build_seconds(&self) -> f64 {
        self.tree.build_seconds
    }

    fn bytes(&self) -> usize {
        self.tree.bytes
    }

    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let f = &self.tree.embree.functions;
        match (self.packets.width, batch.any) {
            (4, false) => self.in_packets(f.rtcIntersect4, batch, answers),
            (4, true) => self.in_packets(f.rtcOccluded4, batch, answers),
            (8, false) => self.in_packets(f.rtcIntersect8, batch, answers),
            (8, true) => self.in_packets(f.rtcOccluded8, batch, answers),
            (16, false) => self.in_packets(f.rtcIntersect16, batch, answers),
            (16, true) => self.in_packets(f.rtcOccluded16, batch, answers),
            _ => self.singly(batch, answers),
        }
    }
}

impl EmbreeEngine {
    fn arguments(&self) -> Arguments {
        Arguments {
            flags: if self.packets.coherent { FLAG_COHERENT } else { 0 },
            features: u32::MAX,
            context: null_mut(),
            filter: null_mut(),
            query: null_mut(),
            reserved: [0; 2],
        }
    }

    fn singly(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let mut rays: Vec<RayHit1> = batch.rays.iter().map(RayHit1::new).collect();
        let (f, scene) = (&self.tree.embree.functions, self.tree.scene);
        let begun = Instant::now();
        let query = if batch.any { f.rtcOccluded1 } else { f.rtcIntersect1 };
        for ray in &mut rays {
            // SAFETY: the scene is committed, the ray has the required layout and alignment, and null selects default
            // arguments.
            unsafe { query(scene, ray, null()) };
        }
        let seconds = begun.elapsed().as_secs_f64();
        if let Some(answers) = answers {
            answers.fill(batch.any, rays.iter().map(RayHit1::hit));
        }
        seconds
    }

    fn in_packets<const N: usize>(
        &self,
        query: Query<N>,
        batch: &Batch,
        answers: Option<&mut Answers>,
    ) -> f64 {
        let mut packets: Vec<RayHits<N>> = batch.rays.chunks(N).map(RayHits::new).collect();
        let (scene, arguments) = (self.tree.scene, self.arguments());
        let valid = Valid([-1; 16]);
        let begun = Instant::now();
        for packet in &mut packets {
            // SAFETY: as above; the flags and the arguments live until the call returns.
            unsafe { query(&valid, scene, packet, &arguments) };
        }
        let seconds = begun.elapsed().as_secs_f64();
        if let Some(answers) = answers {
            let hits = packets.iter().flat_map(|packet| (0..N).map(|lane| packet.hit(lane)));
            answers.fill(batch.any, hits.take(batch.rays.len()));
        }
        seconds
    }
}

impl RayHit1 {
    fn new(ray: &Ray) -> RayHit1 {
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
    fn hit(&self) -> Option<Hit> {
        let is_hit = self.geometry != INVALID || self.t_far == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far, self.u, self.v, self.primitive);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}

impl<const N: usize> RayHits<N> {
    /// A packet of up to `N` rays; the last one fills the remaining lanes.
    fn new(rays: &[Ray]) -> RayHits<N> {
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

    fn hit(&self, lane: usize) -> Option<Hit> {
        let is_hit = self.geometry[lane] != INVALID || self.t_far[lane] == f32::NEG_INFINITY;
        let (t, u, v, primitive) = (self.t_far[lane], self.u[lane], self.v[lane], self.primitive[lane]);
        is_hit.then_some(Hit { t, u, v, primitive, instance: 0 })
    }
}

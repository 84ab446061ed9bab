//! Rays that Embree takes one by one, or in packets.

use super::layouts::{Arguments, Pointer, RayHit1, RayHits, Valid};
use super::library::Embree;
use super::tree::Tree;
use crate::rays::batch::{Answers, Batch};
use crate::rays::engine::{Engine, Mode};
use std::ptr::{null, null_mut};
use std::rc::Rc;
use std::time::Instant;

const FLAG_COHERENT: u32 = 1 << 16;
/// Packets of four, eight and sixteen rays are native.
const PROPERTIES_NATIVE: [(usize, u32); 3] = [(4, 32), (8, 33), (16, 34)];

/// Packing of rays for Embree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::rays) struct Packets {
    /// The number of rays in a call: 1, 4, 8 or 16.
    width: usize,
    /// Embree is told that rays run side by side.
    coherent: bool,
}

impl Packets {
    const ONE: Packets = Packets { width: 1, coherent: false };

    /// Every way of passing rays to Embree on this machine: one by one, in packets of each width that it traces as such (it
    /// takes others apart), and in the widest of them as coherent rays.
    pub(in crate::rays) fn ways(embree: &Embree) -> Vec<Packets> {
        // SAFETY: the device lives as long as `embree`; version 4 has these properties.
        let is_native =
            |property| unsafe { (embree.functions.rtcGetDeviceProperty)(embree.device, property) } != 0;
        let native = PROPERTIES_NATIVE.iter().filter(|(_, property)| is_native(*property));
        let widths: Vec<usize> = native.map(|&(width, _)| width).collect();
        let of_width = widths.iter().map(|&width| Packets { width, coherent: false });
        let coherent = widths.last().map(|&width| Packets { width, coherent: true });
        [Packets::ONE].into_iter().chain(of_width).chain(coherent).collect()
    }

    /// Suffix to the name of a tree in the name of an engine.
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

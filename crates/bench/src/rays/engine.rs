//! Engines to measure, behind one trait whose calls take a whole batch, and the timing of a call.

use super::batch::{Answers, Batch};
use bilux::accel::{Hit, Ray};
use std::hint::black_box;
use std::time::Instant;

/// Number of rays in a call of an engine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// One per call.
    #[default]
    Single,
    /// Several per call.
    Batch,
}

impl Mode {
    pub(super) fn name(self) -> &'static str {
        match self {
            Mode::Single => "single",
            Mode::Batch => "batch",
        }
    }
}

/// A structure over a scene's mesh, and one way of querying it.
pub(super) trait Engine {
    fn mode(&self) -> Mode;
    fn build_seconds(&self) -> f64;
    fn bytes(&self) -> usize;
    /// The seconds that the rays take. Converting them into the engine's own form, and reading the answers out of it,
    /// is not timed.
    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64;
}

/// An engine with its name.
pub(super) struct Named {
    pub(super) name: String,
    /// Whether it is one of our own.
    pub(super) ours: bool,
    pub(super) engine: Box<dyn Engine>,
}

/// The hit that stands for any hit, which has no location.
pub(super) const HIT_WITHOUT_LOCATION: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive: 0, instance: 0 };

/// Times `ask` over all rays, one by one.
pub(super) fn loop_over<T: Clone + Default>(
    batch: &Batch,
    answers: Option<&mut Answers>,
    ask: impl Fn(&Ray) -> T,
    hit: impl Fn(&T) -> Option<Hit>,
) -> f64 {
    let each = |rays: &[Ray], found: &mut [T]| {
        for (slot, ray) in found.iter_mut().zip(rays) {
            *slot = ask(ray);
        }
    };
    timed(batch, batch.rays.len(), answers, each, hit)
}

/// Times `ask` over all rays, `size` per call. Answers go into memory that is already allocated, as Embree's do.
#[inline(always)]
pub(super) fn timed<T: Clone + Default>(
    batch: &Batch,
    size: usize,
    answers: Option<&mut Answers>,
    ask: impl Fn(&[Ray], &mut [T]),
    hit: impl Fn(&T) -> Option<Hit>,
) -> f64 {
    let mut found = vec![T::default(); batch.rays.len()];
    // Memory that was never written costs page faults, which must not count as tracing time.
    found.iter_mut().for_each(|slot| *black_box(slot) = T::default());
    let (size, begun) = (size.max(1), Instant::now());
    for (rays, found) in batch.rays.chunks(size).zip(found.chunks_mut(size)) {
        ask(rays, found);
    }
    let seconds = begun.elapsed().as_secs_f64();
    if let Some(answers) = answers {
        answers.fill(batch.any, found.iter().map(hit));
    }
    black_box(found);
    seconds
}

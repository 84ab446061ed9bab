//! Samples in batches, as the queues of subpaths take them.

use super::queued_sample::QueuedSample;
use crate::film::failures::SamplePlace;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::sample_queue::{SampleQueue, SampleSink};
use crate::sampling::task::Context;
use bilux_math::{Rgb, Vec2};
use bilux_scene::Tracer;

/// The number of samples in a batch: the vertices of their light subpaths fit into the second cache.
pub(crate) const BATCH: usize = 256;

/// A queue that takes each event of all samples of a batch before the next event.
pub(crate) trait BatchQueue {
    /// Takes up to [`BATCH`] samples, and returns the light of each in its own pixel. Splats go to `add_splat` in the order of
    /// the samples: the index of a sample, the point of the film, the light as an integral over the whole film.
    fn take_batch<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        add_splat: &mut dyn FnMut(usize, Vec2, Rgb),
    ) -> Vec<Rgb>;
}

impl<Q: BatchQueue> SampleQueue for Q {
    fn take<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        places: &[SamplePlace],
        sink: &mut SampleSink,
    ) -> bool {
        for places in places.chunks(BATCH) {
            if sink.is_cancelled() {
                return false;
            }
            let queued = |&place: &SamplePlace| QueuedSample::new(rays.sample(place), sink.is_wanted(place));
            let mut samples: Vec<_> = places.iter().map(queued).collect();
            let mut add_splat = |i: usize, film, light| sink.splats(places[i]).add(film, light);
            let light = self.take_batch(&mut samples, &rays.context, tracer, &mut add_splat);
            for (&place, light) in places.iter().zip(light) {
                sink.add(place, light);
            }
        }
        true
    }
}

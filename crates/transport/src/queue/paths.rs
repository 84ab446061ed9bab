//! The paths of a queue, and what happens to them at one event.

use crate::film::failures::SamplePlace;
use crate::path_tracing::Path;
use crate::sampling::task::{Context, SampleState, Task};
use crate::walk::shadow_rays::ShadowRays;
use bilux_accel::Hit;
use bilux_math::Rgb;
use bilux_scene::Tracer;

/// A path in the queue.
pub(super) struct QueuedPath {
    pub(super) path: Path,
    pub(super) state: SampleState,
    /// Light that connections of its current vertex bring, and the throughput there, as the colour channels see it.
    pub(super) direct: Rgb,
    pub(super) beta: Rgb,
    /// The sample that it belongs to.
    pub(super) place: SamplePlace,
}

impl QueuedPath {
    /// Starts an event: no connection has contributed anything yet.
    #[inline]
    pub(super) fn begin_event(&mut self) {
        (self.direct, self.beta) = (Rgb::BLACK, self.path.walk.seen(&self.state));
    }

    /// The path, and the tools for its sample.
    #[inline]
    pub(super) fn parts<'t, 'a>(
        &'t mut self,
        context: &'t Context<'a>,
        tracer: &'t mut Tracer<'a>,
    ) -> (&'t mut Path, Task<'t, 'a>) {
        (&mut self.path, Task { context, tracer, sample: &mut self.state })
    }
}

/// Light that the connection of a path's vertex with a light brings if its shadow ray hits nothing.
#[derive(Clone, Copy)]
pub(super) struct Unoccluded {
    /// Index of the path.
    pub(super) path: u32,
    pub(super) light: Rgb,
}

/// Connections with lights. Rays towards the same light are next to each other, since these are traced fastest.
#[derive(Default)]
pub(super) struct Connections {
    lists: [ShadowRays<Unoccluded>; LISTS],
}

/// A light has a list of its own if it is one of few.
const LISTS: usize = 4;

impl Connections {
    pub(super) fn clear(&mut self) {
        self.lists.iter_mut().for_each(ShadowRays::clear);
    }

    /// The list of a light. Connections of one vertex come in the order of the lights.
    #[inline]
    pub(super) fn with(&mut self, light: usize) -> &mut ShadowRays<Unoccluded> {
        &mut self.lists[light.min(LISTS - 1)]
    }
}

/// All paths, and lists of those that the current event concerns.
#[derive(Default)]
pub(super) struct Paths {
    pub(super) paths: Vec<QueuedPath>,
    pub(super) connections: Connections,
    /// Paths that have left the scene.
    pub(super) escaped: Vec<u32>,
    /// Path, object, hit.
    pub(super) diffuse_hits: Vec<(u32, u32, Hit)>,
    /// Path, object, hit.
    pub(super) smooth_hits: Vec<(u32, u32, Hit)>,
    pub(super) opaque_hits: Vec<(u32, Hit)>,
    pub(super) general_hits: Vec<(u32, Hit)>,
    /// Paths that go on after it.
    pub(super) next: Vec<u32>,
    /// Paths that connect to lights.
    pub(super) shaded: Vec<u32>,
}

impl Paths {
    /// Begins another event.
    pub(super) fn clear_lists(&mut self) {
        self.next.clear();
        self.connections.clear();
        self.escaped.clear();
        self.diffuse_hits.clear();
        self.smooth_hits.clear();
        self.opaque_hits.clear();
        self.general_hits.clear();
        self.shaded.clear();
    }

    /// Traces the shadow rays, and adds the light of connections that nothing blocks. The light of a vertex is summed
    /// before it is weighted by the throughput, as in a single path.
    pub(super) fn add_direct_light(&mut self, tracer: &mut Tracer) {
        for list in &mut self.connections.lists {
            list.trace(tracer, |contribution, passed| {
                self.paths[contribution.path as usize].direct += contribution.light * passed.transmittance;
            });
        }
        for &index in &self.shaded {
            let one = &mut self.paths[index as usize];
            one.path.light += one.beta * one.direct;
        }
    }
}

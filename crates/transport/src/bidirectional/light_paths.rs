//! Light subpaths: from a light through the scene, and how the camera sees them. One at a time, or many together: both
//! give the same vertices, bit for bit.

use super::connect::{Connection, Join, places_on_film, to_camera};
use super::queued_sample::QueuedSample;
use super::{Subpath, Vertex};
use crate::light::emission::Start;
use crate::photons::beam::Beam;
use crate::sampling::task::{Context, SampleState, Task};
use crate::techniques::mis::Partial;
use crate::techniques::{Contribution, Step, Tally, Technique, TechniqueCounts};
use crate::walk::segment::Segment;
use crate::walk::shadow_rays::ShadowRays;
use bilux_accel::Hit;
use bilux_math::Vec2;
use bilux_scene::{Ray, Tracer, TransportMode};

/// Random number streams of light subpaths begin here, far from those of camera subpaths.
pub(super) const LIGHT_STREAM: u64 = 1 << 32;

impl SampleState {
    /// Enters the stream of random numbers for connecting a vertex of the light subpath.
    pub(crate) fn enter_light_vertex(&mut self, depth: u32) {
        self.sampler.enter(2 * LIGHT_STREAM + u64::from(depth));
    }
}

/// Traces a light subpath: every vertex, in order, except those that scatter into single directions only, and of long walks
/// through media those that are not to be connected. `visit` is told of all of them.
pub(crate) fn light_vertices<const N: usize>(
    task: &mut Task,
    time: f32,
    roulette_depth: u32,
    techniques: &TechniqueCounts<N>,
    mut visit: impl FnMut(&Vertex<N>),
) -> Vec<Vertex<N>> {
    let mut vertices = Vec::new();
    let Some(mut subpath) = begin_at_light(task, time, techniques) else { return vertices };
    while let Some(vertex) = subpath.next_vertex(task) {
        if !vertex.events().are_within(task.context.max_depth) {
            break;
        }
        visit(&vertex);
        let goes_on = goes_on(&mut subpath, &vertex, roulette_depth, task);
        if vertex.is_open() {
            vertices.push(vertex);
        }
        if !goes_on {
            break;
        }
    }
    vertices
}

/// Continues from a vertex; false when the subpath ends there.
fn goes_on<const N: usize>(
    subpath: &mut Subpath<N>,
    vertex: &Vertex<N>,
    roulette_depth: u32,
    task: &mut Task,
) -> bool {
    // One more event has to come; it may be one that does not count.
    let Context { scene, max_depth, .. } = task.context;
    if vertex.events().counted >= *max_depth && !scene.scatters() {
        return false;
    }
    task.sample.sampler.enter(LIGHT_STREAM + 1 + u64::from(vertex.depth));
    subpath.scatter(vertex, roulette_depth, task)
}

/// Connects every vertex of a light subpath with the camera.
pub(crate) fn connect_to_camera<const N: usize>(
    task: &mut Task,
    light_path: &[Vertex<N>],
    techniques: &TechniqueCounts<N>,
    tally: &mut impl Tally<N>,
) {
    for y in light_path.iter().filter(|y| is_connectible(y, techniques)) {
        task.sample.enter_light_vertex(y.depth);
        tally.spend(Step::Seen, 1);
        if let Some((film, connection)) = to_camera(task, y, techniques)
            && let Some((technique, found)) = connection.trace(task.tracer)
        {
            let Segment { ray, through, .. } = &connection.segment;
            // The ray ends at the camera at t = 1.
            tally.join(y.at.p(), ray.direction.into(), through.distance);
            for film in places_on_film(task.context, film) {
                tally.add_splat(film, technique, &found);
            }
        }
    }
}

/// Whether light subpaths are connected with the camera at this vertex.
fn is_connectible<const N: usize>(y: &Vertex<N>, techniques: &TechniqueCounts<N>) -> bool {
    y.depth > 0 || y.at.direct_light(techniques).splats
}

pub(super) fn begin_at_light<'w, const N: usize>(
    task: &mut Task,
    time: f32,
    techniques: &'w TechniqueCounts<N>,
) -> Option<Subpath<'w, N>> {
    task.sample.sampler.enter(LIGHT_STREAM);
    let (u_light, u_point, u_direction) =
        (task.sample.sampler.next_1d(), task.sample.sampler.next_2d(), task.sample.sampler.next_2d());
    if task.context.max_depth == 0 {
        return None;
    }
    let scene = task.context.scene;
    let start = task.context.emission.sample(scene, time, u_light, (u_point, u_direction))?;
    let Start { light: index, ray, .. } = start;
    let light = &scene.lights()[index].light;
    let (cos, pdf_emission) = (ray.cos(), ray.pdf_emission);
    // As a point of a medium would choose it: the first vertex knows better.
    let pdf_direct = ray.pdf_direct * task.context.lights.probability(index, None);
    let beta = ray.le * (cos / pdf_emission);
    let partial = Partial::of_light(pdf_direct, pdf_emission, cos, light.is_delta());
    // The start of a ray from infinity already has a density over area.
    let by_area = light.is_infinite();
    let spawned = ray.spawn(time);
    let subpath = Subpath::new(TransportMode::Importance, spawned, beta, partial, by_area, techniques);
    Some(subpath.leaving(start))
}

/// The light subpaths of many samples, which are traced together.
#[derive(Default)]
pub(crate) struct LightPaths<const N: usize = 1> {
    /// All vertices, by depth; those of the same depth in the order of the samples.
    vertices: Vec<Vertex<N>>,
    /// The sample of each vertex.
    samples: Vec<u32>,
    /// Indices of the vertices: those of the first sample, by depth, then those of the second.
    order: Vec<u32>,
    /// `starts[i]..starts[i + 1]` of `order` are the vertices of sample `i`.
    starts: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    active: Vec<u32>,
    next: Vec<u32>,
    shadow_rays: ShadowRays<Splat<N>>,
    /// The beams of those samples that keep them.
    pub(crate) beams: Vec<Beam<N>>,
}

/// A connection with the camera.
struct Splat<const N: usize> {
    sample: u32,
    film: Vec2,
    join: Join<N>,
}

impl<const N: usize> LightPaths<N> {
    /// Forgets all vertices, for as many samples.
    pub(crate) fn clear(&mut self, samples: usize) {
        self.vertices.clear();
        self.samples.clear();
        self.order.clear();
        self.beams.clear();
        self.starts.clear();
        self.starts.resize(samples + 1, 0);
    }

    /// Traces the light subpath of each sample, as [`light_vertices`] does.
    pub(crate) fn trace<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        roulette_depth: u32,
        techniques: &TechniqueCounts<N>,
    ) {
        self.clear(samples.len());
        self.active.clear();
        let mut subpaths = Vec::with_capacity(samples.len());
        for (i, sample) in samples.iter_mut().enumerate() {
            let mut task = Task { context, tracer: &mut *tracer, sample: &mut sample.state };
            let subpath = begin_at_light(&mut task, sample.ray.time, techniques);
            let subpath = subpath.map(|subpath| subpath.keeping_beams(sample.has_beams));
            self.active.extend(subpath.is_some().then_some(i as u32));
            subpaths.push(subpath);
        }
        while !self.active.is_empty() {
            self.rays.clear();
            self.rays.extend(self.active.iter().filter_map(|&i| {
                let i = i as usize;
                Some(subpaths[i].as_mut()?.ray(context.scene, &mut samples[i].state))
            }));
            self.hits.clear();
            self.hits.resize(self.rays.len(), None);
            tracer.hits(&self.rays, &mut self.hits);
            self.next.clear();
            for (&i, hit) in self.active.iter().zip(&self.hits) {
                let Some(subpath) = &mut subpaths[i as usize] else { continue };
                let surface = hit.map(|hit| tracer.surface(&subpath.walk.ray, &hit));
                let state = &mut samples[i as usize].state;
                let mut task = Task { context, tracer: &mut *tracer, sample: state };
                let before = self.vertices.len();
                self.vertices.extend(subpath.vertex_before(surface, &mut task));
                self.beams.append(&mut subpath.beams);
                let Some(vertex) = self.vertices.get(before) else { continue };
                let exists = vertex.events().are_within(context.max_depth);
                let goes_on = exists && goes_on(subpath, vertex, roulette_depth, &mut task);
                self.next.extend(goes_on.then_some(i));
                if exists && vertex.is_open() {
                    self.samples.push(i);
                } else {
                    self.vertices.truncate(before);
                }
            }
            std::mem::swap(&mut self.active, &mut self.next);
        }
        self.sort();
    }

    /// Lists the vertices by sample.
    fn sort(&mut self) {
        for &sample in &self.samples {
            self.starts[sample as usize + 1] += 1;
        }
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        self.order.resize(self.samples.len(), 0);
        for (vertex, &sample) in self.samples.iter().enumerate() {
            let place = &mut self.starts[sample as usize];
            self.order[*place as usize] = vertex as u32;
            *place += 1;
        }
        // Each start has become an end.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// The vertices of a sample's light subpath, in order.
    #[inline]
    pub(crate) fn of(&self, sample: usize) -> impl Iterator<Item = &Vertex<N>> + Clone {
        let range = self.starts[sample] as usize..self.starts[sample + 1] as usize;
        self.order[range].iter().map(|&vertex| &self.vertices[vertex as usize])
    }

    /// Vertices of a sample's light subpath that are connected with the camera.
    #[inline]
    pub(super) fn connectible(
        &self,
        sample: usize,
        techniques: &TechniqueCounts<N>,
    ) -> impl Iterator<Item = &Vertex<N>> {
        self.of(sample).filter(|y| is_connectible(y, techniques))
    }

    /// Connects every vertex with the camera, as [`connect_to_camera`] does. `add` receives the index of the sample, the
    /// point of the film, and what was found, in the order of the samples.
    pub(crate) fn connect_to_camera<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        techniques: &TechniqueCounts<N>,
        mut add: impl FnMut(usize, Vec2, Technique, &Contribution<N>),
    ) {
        let mut shadow_rays = std::mem::take(&mut self.shadow_rays);
        shadow_rays.clear();
        let is_plain = context.scene.has_plain_shadows();
        for (i, sample) in samples.iter_mut().enumerate() {
            let mut task = Task { context, tracer: &mut *tracer, sample: &mut sample.state };
            for y in self.connectible(i, techniques) {
                task.sample.enter_light_vertex(y.depth);
                let Some((film, connection)) = to_camera(&mut task, y, techniques) else { continue };
                let Connection { join, segment } = connection;
                let splat = Splat { sample: i as u32, film, join };
                segment.list(&mut shadow_rays, context.scene, is_plain, splat);
            }
        }
        shadow_rays.trace(tracer, |Splat { sample, film, join }, passage| {
            let (technique, found) = join.along(passage);
            for film in places_on_film(context, *film) {
                add(*sample as usize, film, technique, &found);
            }
        });
        self.shadow_rays = shadow_rays;
    }
}

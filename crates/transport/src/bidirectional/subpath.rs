//! Subpaths while they grow, from either end.

use super::vertex::{Vertex, count, kept_share};
use crate::beam::{Beam, Leaving};
use crate::emission::Start;
use crate::equiangular::{self, Approach, Lit};
use crate::media::{Media, MediumPart, Travelled};
use crate::mis::{Edge, Partial};
use crate::task::{PathVertex, SampleState, Task, VertexKind};
use crate::techniques::{PerSet, TechniqueCounts};
use crate::walk::Walk;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Ray, Scene, Surface, TransportMode};

/// A subpath on its way to the next vertex.
pub(crate) struct Subpath<'w, const N: usize = 1> {
    pub(crate) walk: Walk,
    /// What it carries: radiance on a camera subpath, importance on a light subpath.
    mode: TransportMode,
    pub(crate) partial: Partial<N>,
    /// The density of arriving is over area already: at the first vertex that light from infinity reaches.
    by_area: bool,
    /// The maximum channel at the start; Russian roulette measures the survival of light subpaths against it.
    full: f32,
    /// The light that it comes from and how it left, until it has a vertex.
    start: Option<Start>,
    origin: u16,
    /// Its last vertex is a point of a medium.
    leaves_medium: bool,
    /// What media on the way to the next vertex emit, over the density of finding it.
    glow: Rgb,
    /// The parts of its last ray through media in which rays are merged; none before the ray is followed.
    pub(crate) beams: Vec<Beam<N>>,
    /// Whether it keeps them.
    has_beams: bool,
    /// Whether points of its rays are sampled by their [angle to lights](equiangular), and it as it was before its last ray, with the first
    /// surface there.
    has_points: bool,
    pub(super) before: Option<Box<Before<N>>>,
    /// The last vertex, if camera subpaths may find it near a light.
    near: Option<Near<N>>,
    /// The techniques by which its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
}

/// A subpath before its next ray is followed.
pub(super) struct Before<const N: usize> {
    walk: Walk,
    partial: Partial<N>,
    leaves_medium: bool,
    first: Surface,
}

/// A vertex that a subpath has left, for the sake of points that are sampled by their angle to lights.
#[derive(Clone, Copy)]
enum Near<const N: usize> {
    /// Of a camera subpath, which may hit the light by chance next.
    Eye(Approach),
    /// Of a light subpath, which came straight from its light.
    Light(Lit<N>),
}

impl<'w, const N: usize> Subpath<'w, N> {
    /// A subpath with only its first ray. The media that this starts in are looked for when it is followed.
    pub(crate) fn new(
        mode: TransportMode,
        ray: Ray,
        beta: Rgb,
        partial: Partial<N>,
        by_area: bool,
        techniques: &'w TechniqueCounts<N>,
    ) -> Subpath<'w, N> {
        let (walk, full) = (Walk::new(&ray, beta, Media::AIR), beta.max_channel());
        Subpath {
            walk,
            mode,
            partial,
            by_area,
            full,
            start: None,
            origin: 0,
            leaves_medium: false,
            glow: Rgb::BLACK,
            beams: Vec::new(),
            has_beams: mode == TransportMode::Radiance && techniques.beams != PerSet::ZERO,
            has_points: false,
            before: None,
            near: None,
            techniques,
        }
    }

    /// The same, with points that are sampled by their angle to lights.
    pub(super) fn having_points(self) -> Subpath<'w, N> {
        Subpath { has_points: true, ..self }
    }

    /// The same from a light of the scene.
    pub(crate) fn leaving(self, start: Start) -> Subpath<'w, N> {
        Subpath { origin: start.cell, start: Some(start), ..self }
    }

    /// The same, and keeps its beams if it `has_beams`.
    pub(super) fn keeping_beams(self, has_beams: bool) -> Subpath<'w, N> {
        Subpath { has_beams, ..self }
    }

    /// The light that it comes from.
    #[cfg(test)]
    pub(super) fn light(&self) -> Option<usize> {
        self.start.map(|start| start.light)
    }

    /// Traces to the next vertex; `None` where the ray leaves the scene.
    pub(crate) fn next_vertex(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let first = task.tracer.closest(&self.walk.ray);
        let vertex = first.and_then(|first| self.vertex_before(first, task));
        let sample = &mut *task.sample;
        sample.vertices += u32::from(vertex.is_some());
        let is_light = self.mode == TransportMode::Importance;
        let kind = if is_light { VertexKind::LightPath } else { VertexKind::Surface };
        match &vertex {
            None => sample.note(self.walk.depth, || {
                format!("{} leaves the scene towards {:?}", self.whose(), self.walk.ray.direction)
            }),
            Some(Vertex { at, .. }) => sample.note_vertex(self.walk.depth, || {
                let (p, whose) = (at.p(), self.whose());
                match at.surface() {
                    Some(surface) => {
                        (PathVertex::new(kind, p), format!("{whose} hits object {} at {p}", surface.object))
                    }
                    None => {
                        let kind = if is_light { kind } else { VertexKind::Medium };
                        (PathVertex::new(kind, p), format!("{whose} meets a medium at {p}"))
                    }
                }
            }),
        }
        vertex
    }

    /// The same where the first surface along the ray is known.
    #[inline]
    pub(crate) fn vertex_before(&mut self, first: Surface, task: &mut Task) -> Option<Vertex<N>> {
        let Task { context, tracer, sample } = task;
        let walk = &mut self.walk;
        if walk.depth == 0 {
            walk.media = Media::at_start(tracer, &walk.ray);
        }
        self.before = None;
        if self.has_points && !self.leaves_medium && equiangular::is_used_in(context.scene) {
            let (walk, partial, leaves_medium) = (*walk, self.partial, self.leaves_medium);
            self.before = Some(Box::new(Before { walk, partial, leaves_medium, first }));
        }
        let leaving = self.has_beams.then(|| Leaving {
            origin: self.origin,
            channel: sample.channel,
            is_split: walk.is_split,
            leaves_medium: self.leaves_medium,
            by_area: self.by_area,
            partial: self.partial,
            start: self.start,
            depth: walk.depth,
            events: walk.events(),
            beta: walk.beta,
            odds: walk.odds,
        });
        let (ray, techniques, beams) = (walk.ray, self.techniques, &mut self.beams);
        let keep = |MediumPart { object, medium, ends, before }: MediumPart| {
            let Some(leaving) = &leaving else { return };
            let sigma_t = medium.sigma_t();
            if medium.density.is_none()
                && techniques.has_beams_in(sigma_t)
                && sigma_t[usize::from(leaving.channel)] > 0.0
            {
                beams.push(leaving.beam(&ray, object, ends, before));
            }
        };
        let travelled = walk.travel(Some(first), tracer, sample, self.mode, keep);
        self.glow = travelled.emitted;
        self.arrived(&travelled, task)
    }

    /// The next vertex, where the walk has travelled so far; `None` where that leaves the scene.
    #[inline]
    fn arrived(&mut self, travelled: &Travelled, task: &mut Task) -> Option<Vertex<N>> {
        let Task { context, sample, .. } = task;
        let Travelled { arrival, passage, .. } = travelled;
        let walk = &self.walk;
        // Light sampling connects the first surface of a light subpath with the light.
        let is_at_light = walk.depth == 0 && self.mode == TransportMode::Importance;
        let media = walk.media;
        let back = passage.returning(self.leaves_medium);
        let Some(at) = media.interaction(context.scene, arrival, &sample.wavelength) else {
            self.partial.pass(1.0, Edge { forward: passage.survival, back });
            return None;
        };
        let (wo, t) = (walk.wo(), at.t());
        let edge = Edge { forward: passage.arriving(at.cos(wo)), back };
        let distance2 = if self.by_area { 1.0 } else { t * t };
        let connections = if is_at_light { PerSet::ONE } else { self.techniques.connections };
        let straight_from = if is_at_light { self.start.map(|start| start.light) } else { None };
        let is_left = is_at_light && !at.finds_direct_light(self.techniques);
        let merged = if is_left { PerSet::ZERO } else { at.merged(self.techniques, sample.channel) };
        let distance2 = distance2 * self.light_sampling_ratio(context.scene, at.p());
        self.partial.arrive(distance2, edge, connections, merged);
        if let Some(Near::Light(lit)) = self.near
            && !at.is_in_medium()
        {
            self.partial.d_vc = self.partial.d_vc + lit.picked(context.scene, wo, t) * (1.0 / edge.forward);
        }
        let events = self.walk.events().and(at.is_inside());
        self.partial.in_row(events.in_row);
        self.by_area = false;
        let approach = Approach::of(&at, wo, edge.forward).filter(|_| !self.leaves_medium);
        self.leaves_medium = at.is_in_medium();
        let Subpath { walk: Walk { beta, odds, depth, is_split, .. }, partial, origin, .. } = *self;
        let share = match self.mode {
            TransportMode::Importance => kept_share(events.in_row),
            TransportMode::Radiance => 1.0,
        };
        let is_kept = share == 1.0 || sample.sampler.next_1d() < share;
        let beta = beta / share;
        let arriving = edge.forward;
        Some(Vertex {
            at,
            wo,
            beta,
            odds,
            partial,
            depth,
            events,
            is_kept,
            origin,
            came_split: is_split,
            media,
            arriving,
            straight_from,
            approach,
        })
    }

    /// Continues from a vertex; false when the subpath ends there.
    pub(crate) fn scatter(&mut self, vertex: &Vertex<N>, roulette_depth: u32, task: &mut Task) -> bool {
        self.beams.clear();
        let sampler = &mut task.sample.sampler;
        let (u_choice, u) = (sampler.next_1d(), sampler.next_2d());
        let u_survival = sampler.next_1d();
        let Vertex { at, wo, media, .. } = vertex;
        let Some(sample) = at.sample(*wo, u_choice, u, self.mode) else { return false };
        let cos = at.cos(sample.wi).unwrap_or(1.0);
        let back = || at.pdf_solid_angle(sample.wi, *wo, self.mode.reversed());
        let pdfs = (!sample.is_delta).then(|| (sample.pdf_solid_angle, back()));
        let finds_direct = self.mode == TransportMode::Importance || at.finds_direct_light(self.techniques);
        self.partial.leave(cos, at.sine(*wo, sample.wi), pdfs, finds_direct, vertex.events.in_row);
        self.near = match (self.mode, vertex.straight_from) {
            (TransportMode::Radiance, _) => vertex.approach.map(Near::Eye),
            (TransportMode::Importance, Some(light)) if at.is_near_lights() => {
                let connected = vertex.partial.connected * (1.0 / sample.pdf_solid_angle);
                Some(Near::Light(Lit { light, p: at.p(), connected }))
            }
            _ => None,
        };
        self.walk.is_split = vertex.is_split();
        self.walk.follow(task.context.scene, at, *wo, media, &sample, self.mode);
        self.walk.survives(roulette_depth, self.full, || u_survival)
    }

    /// A vertex as if the last ray had come to a point at this distance, in metres, where points are sampled by their angle to lights;
    /// `None` where they are not, or where the ray does not come so far.
    pub(super) fn vertex_near(&self, distance: f32, task: &mut Task) -> Option<Vertex<N>> {
        let Before { walk, partial, leaves_medium, first } = self.before.as_deref()?;
        let (walk, travelled) = walk.in_fog(*first, distance, task.tracer, task.sample)?;
        let mut alike = Subpath {
            walk,
            partial: *partial,
            leaves_medium: *leaves_medium,
            start: None,
            beams: Vec::new(),
            has_beams: false,
            before: None,
            near: None,
            ..*self
        };
        alike.arrived(&travelled, task)
    }

    /// How it came to its last vertex, if that is a point of fog that may be sampled by its angle to a light.
    pub(super) fn approach(&self) -> Option<Approach> {
        if let Some(Near::Eye(approach)) = self.near { Some(approach) } else { None }
    }

    /// The light that media have emitted on the way here, as the colour channels see it; `None` if there is none. No other technique
    /// finds it.
    #[inline]
    pub(super) fn take_glow(&mut self, sample: &SampleState) -> Option<Rgb> {
        let glow = std::mem::take(&mut self.glow);
        (!glow.is_black()).then(|| sample.seen(glow, self.walk.is_split))
    }

    /// The number of its vertices if it hits an emitter next.
    pub(crate) fn count(&self) -> u32 {
        count(self.walk.depth)
    }

    /// The factor by which the first vertex of a light subpath would sample its start more often than assumed so far.
    fn light_sampling_ratio(&mut self, scene: &Scene, from: Vec3) -> f32 {
        self.start.take().map_or(1.0, |start| start.light_sampling_ratio(scene, from))
    }

    fn whose(&self) -> &'static str {
        if self.mode == TransportMode::Radiance { "the camera's path" } else { "the light's path" }
    }
}

//! Subpaths while they grow, from either end.

use super::behind_panes::BehindPanes;
use super::vertex::{Vertex, count, kept_share};
use crate::light::emission::Start;
use crate::media::equiangular::{self, Approach, Lit};
use crate::media::interaction::Interaction;
use crate::media::{Media, MediumPart, Travelled};
use crate::path_tracing::passes_straight;
use crate::photons::beam::{Beam, Leaving};
use crate::sampling::task::{Context, PathVertex, SampleState, Task, VertexKind};
use crate::techniques::mis::{Edge, Partial};
use crate::techniques::{DirectLight, PerSet, TechniqueCounts};
use crate::walk::Walk;
use bilux_math::Rgb;
use bilux_scene::media::Flight;
use bilux_scene::{BsdfSample, Ray, Scene, Surface, TransportMode};

/// A subpath on its way to the next vertex.
pub(crate) struct Subpath<'w, const N: usize = 1> {
    pub(crate) walk: Walk,
    /// Quantity that it carries: radiance on a camera subpath, importance on a light subpath.
    mode: TransportMode,
    pub(crate) partial: Partial<N>,
    /// The density of arriving is over area already: at the first vertex that light from infinity reaches.
    by_area: bool,
    /// The maximum channel at the start; Russian roulette measures the survival of light subpaths against it.
    full: f32,
    /// The light that it comes from and how it left.
    start: Option<Start>,
    origin: u16,
    /// Light that media on the way to the next vertex emit, over the density of finding it.
    glow: Rgb,
    /// The parts of its last ray through media in which rays are merged; none before the ray is followed.
    pub(crate) beams: Vec<Beam<N>>,
    /// Whether it keeps them.
    has_beams: bool,
    /// Whether its rays have [equiangular points](equiangular).
    is_equiangular: bool,
    /// Flight along the next ray, if that is known before the ray is traced.
    ahead: Option<Flight>,
    /// State before the last ray, if that ray has equiangular points.
    before: Option<Box<Before<N>>>,
    /// Last vertex, of a camera subpath and of a light subpath, where equiangular points may be.
    approach: Option<Approach>,
    lit: Option<Lit<N>>,
    /// Origin that it has come straight from, in a scene with panes.
    straight: Option<BehindPanes>,
    /// The techniques by which its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
}

/// A subpath before its next ray is followed, and the first surface along that.
struct Before<const N: usize> {
    walk: Walk,
    partial: Partial<N>,
    first: Surface,
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
            glow: Rgb::BLACK,
            beams: Vec::new(),
            has_beams: mode == TransportMode::Radiance && techniques.beams != PerSet::ZERO,
            is_equiangular: false,
            ahead: None,
            before: None,
            approach: None,
            lit: None,
            straight: None,
            techniques,
        }
    }

    /// This subpath with [equiangular points](equiangular) on its rays.
    pub(super) fn with_equiangular_points(self) -> Subpath<'w, N> {
        Subpath { is_equiangular: true, ..self }
    }

    /// This subpath, leaving a light of the scene.
    pub(crate) fn leaving(self, start: Start) -> Subpath<'w, N> {
        Subpath { origin: start.cell, start: Some(start), ..self }
    }

    /// This subpath, which keeps its beams if it `has_beams`.
    pub(super) fn keeping_beams(self, has_beams: bool) -> Subpath<'w, N> {
        Subpath { has_beams, ..self }
    }

    /// The light that it comes from.
    #[cfg(test)]
    pub(super) fn light(&self) -> Option<usize> {
        self.start.map(|start| start.light)
    }

    /// Next ray, as far as it has to be traced: to the event that the subpath [finds ahead](Walk::ahead).
    #[inline]
    pub(super) fn ray(&mut self, scene: &Scene, sample: &mut SampleState) -> Ray {
        let (ray, ahead) = self.walk.ahead(scene, sample, self.mode);
        self.ahead = ahead;
        ray
    }

    /// Traces to the next vertex; `None` where the ray leaves the scene.
    pub(crate) fn next_vertex(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let ray = self.ray(task.context.scene, task.sample);
        let first = task.tracer.closest(&ray);
        let vertex = self.vertex_before(first, task);
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

    /// Goes on to the next vertex, where the first surface along [its ray](Subpath::ray) is known; `None` where the ray leaves
    /// the scene.
    #[inline]
    pub(crate) fn vertex_before(&mut self, first: Option<Surface>, task: &mut Task) -> Option<Vertex<N>> {
        self.before = None;
        let ahead = self.ahead.take();
        if first.is_none() && ahead.is_none() {
            return None;
        }
        let Task { context, tracer, sample } = task;
        let walk = &mut self.walk;
        if walk.depth == 0 {
            let lights = context.scene.lights();
            let is_far = self.start.is_some_and(|start| lights[start.light].light.is_infinite());
            let at_start = if is_far { Media::from_infinity } else { Media::at_start };
            walk.media = at_start(tracer, &walk.ray);
            if context.scene.has_panes() {
                self.straight = self.start.as_ref().map(BehindPanes::light);
            }
        }
        if let Some(first) = first
            && self.is_equiangular
            && !walk.leaves_medium
            && equiangular::is_used_in(context.scene)
        {
            self.before = Some(Box::new(Before { walk: *walk, partial: self.partial, first }));
        }
        let leaving = self.has_beams.then(|| Leaving {
            origin: self.origin,
            channel: sample.channel,
            is_split: walk.is_split,
            leaves_medium: walk.leaves_medium,
            by_area: self.by_area,
            partial: self.partial,
            start: self.start.filter(|_| walk.depth == 0),
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
        let travelled = walk.travel((first, ahead), tracer, sample, self.mode, keep);
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
        let back = passage.returning(walk.leaves_medium);
        if let Some(straight) = &mut self.straight {
            straight.arrive(passage.survival);
        }
        let Some(at) = media.interaction(context.scene, arrival, &sample.wavelength) else {
            self.partial.pass(1.0, Edge { forward: passage.survival, back });
            return None;
        };
        let (wo, t) = (walk.wo(), at.t());
        let edge = Edge { forward: passage.arriving(at.cos(wo)), back };
        let approach = Approach::of(&at, wo, false, edge.forward).filter(|_| !walk.leaves_medium);
        let distance2 = if self.by_area { 1.0 } else { t * t };
        let connections = if is_at_light { PerSet::ONE } else { self.techniques.connections };
        let straight_from = if is_at_light { self.start.map(|start| start.light) } else { None };
        let is_left = is_at_light && !at.direct_light(self.techniques).merges;
        let ball = media.ball(context.scene, &at, self.techniques);
        let merged = if is_left { PerSet::ZERO } else { at.merged(self.techniques, sample.channel, ball) };
        let distance2 = distance2 * self.light_sampling_ratio(context, &at);
        self.partial.arrive(distance2, edge, connections, merged);
        if let (Some(straight), Some(start), Some(cos)) = (&self.straight, &self.start, at.cos(wo)) {
            let often = PerSet::ONE * straight.sampled_from(start, context, at.p(), cos);
            self.partial.connected = self.partial.connected + often;
        }
        if let Some(lit) = self.lit.filter(|_| !at.is_in_medium()) {
            self.partial.d_vc = self.partial.d_vc + lit.picked(context.scene, wo, t) * (1.0 / edge.forward);
        }
        let events = self.walk.events().and(at.is_inside());
        self.partial.in_row(events.in_row);
        self.by_area = false;
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
            ball,
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
        let direct = match self.mode {
            TransportMode::Importance => DirectLight::ALL,
            TransportMode::Radiance => at.direct_light(self.techniques),
        };
        self.partial.leave(cos, at.sine(*wo, sample.wi, self.techniques), pdfs, direct, vertex.events.in_row);
        self.approach = vertex.approach;
        self.lit = vertex.lit(1.0 / sample.pdf_solid_angle);
        if task.context.scene.has_panes() {
            self.straight = self.straight_on(vertex, &sample, task.context.scene);
        }
        self.walk.is_split = vertex.is_split();
        self.walk.follow(task.context.scene, at, *wo, media, &sample, self.mode);
        self.walk.survives(roulette_depth, self.full, || u_survival)
    }

    /// Origin that the subpath comes straight from after this event.
    fn straight_on(&self, from: &Vertex<N>, sample: &BsdfSample, scene: &Scene) -> Option<BehindPanes> {
        let Vertex { at, wo, .. } = from;
        if sample.is_delta {
            let is_straight = sample.transmits && passes_straight(scene, at, *wo);
            return self.straight.filter(|_| is_straight).map(BehindPanes::beyond);
        }
        let samples_lights = self.mode == TransportMode::Radiance && !at.is_in_medium();
        samples_lights.then(|| BehindPanes::vertex(at.p(), sample.pdf_solid_angle))
    }

    /// Frequency with which a vertex samples through panes what the subpath sees of a light, at a surface or where it leaves the
    /// scene, for each time that it comes there.
    pub(super) fn sampled_through_panes(
        &self,
        context: &Context,
        light: Option<usize>,
        surface: Option<&Surface>,
    ) -> f32 {
        let (Some(straight), Some(light)) = (&self.straight, light) else { return 0.0 };
        straight.samples(context, (light, surface), self.walk.ray.direction.into())
    }

    /// State of the walk before its last ray, if that ray has equiangular points.
    pub(super) fn equiangular_walk(&self) -> Option<Walk> {
        self.before.as_deref().map(|before| before.walk)
    }

    /// The vertex that an equiangular point at this distance along the last ray, in metres, would be; `None` where there are none, or
    /// where the ray does not come so far.
    pub(super) fn equiangular_vertex(&self, distance: f32, task: &mut Task) -> Option<Vertex<N>> {
        let Before { walk, partial, first } = self.before.as_deref()?;
        let (walk, travelled) = walk.in_fog(*first, distance, task.tracer, task.sample)?;
        let mut alike = Subpath {
            walk,
            partial: *partial,
            start: None,
            beams: Vec::new(),
            has_beams: false,
            ahead: None,
            before: None,
            ..*self
        };
        alike.arrived(&travelled, task)
    }

    /// Approach to the last vertex, if that may be an equiangular point.
    pub(super) fn approach(&self) -> Option<Approach> {
        self.approach
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
    fn light_sampling_ratio(&self, context: &Context, at: &Interaction) -> f32 {
        let Some(start) = self.start.filter(|_| self.walk.depth == 0) else { return 1.0 };
        let ratio = start.light_sampling_ratio(context.scene, at.p());
        let Some(p) = at.lit_at().filter(|_| !context.lights.takes_all()) else { return ratio };
        let [there, assumed] = [Some(p), None].map(|at| context.lights.probability(start.light, at));
        // No vertex samples a light that is never chosen.
        if assumed > 0.0 { ratio * (there / assumed) } else { ratio }
    }

    fn whose(&self) -> &'static str {
        if self.mode == TransportMode::Radiance { "the camera's path" } else { "the light's path" }
    }
}

//! Subpaths while they grow, from either end, and their vertices.

use crate::beam::{Beam, Leaving};
use crate::emission::Start;
use crate::interaction::Interaction;
use crate::limits::Events;
use crate::media::{Media, MediumPart, Travelled};
use crate::mis::{Edge, Partial};
use crate::photons::{Photon, PhotonPosition};
use crate::task::{PathVertex, SampleState, Task, VertexKind};
use crate::techniques::{DirectLight, PerSet, TechniqueCounts};
use crate::walk::Walk;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Ray, Scene, Surface, TransportMode};

/// A vertex of a subpath.
pub(crate) struct Vertex<const N: usize = 1> {
    pub(crate) at: Interaction,
    /// The direction that the subpath came from, a unit vector.
    pub(crate) wo: Vec3,
    /// Throughput: what arrives, over the density of having come here.
    pub(crate) beta: Rgb,
    /// The densities of walks in each channel over their mean.
    pub(crate) odds: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events before this vertex.
    pub(crate) depth: u32,
    /// The same and this one, as far as they limit paths.
    events: Events,
    /// Whether it is among those that are connected at all.
    is_kept: bool,
    /// The cell in which its light subpath began: [`crate::emission::Start::cell`].
    pub(crate) origin: u16,
    /// The subpath carries a single wavelength, whatever is here.
    pub(super) came_split: bool,
    /// The media on the side of `wo`.
    media: Media,
    /// The density of arriving, per area or volume, over that over solid angle over the squared distance.
    pub(super) arriving: f32,
}

impl<const N: usize> Vertex<N> {
    /// The number of vertices of the subpath up to here, including the one on the light or at the camera.
    pub(crate) fn count(&self) -> u32 {
        count(self.depth)
    }

    /// Events up to and including this one, as far as they limit paths.
    pub(crate) fn events(&self) -> Events {
        self.events
    }

    /// True where it can be connected.
    pub(crate) fn is_open(&self) -> bool {
        self.is_kept && !self.at.is_delta()
    }

    /// True where a path through here carries a single wavelength.
    pub(super) fn is_split(&self) -> bool {
        self.came_split || self.at.splits()
    }

    /// The photon that is stored for merging; `None` in a medium.
    pub(crate) fn photon(&self) -> Option<(PhotonPosition, Photon<N>)> {
        let surface = self.at.surface()?;
        let counted = self.events.counted - 1;
        let uncounted = self.depth - counted;
        let position = PhotonPosition::new(surface.p, counted, uncounted, self.came_split, self.origin);
        let (wo, n_geom, beta) = (self.wo, surface.n_geom, self.beta);
        Some((
            position,
            Photon { wo, n_geom, beta, connected: self.partial.connected, d_vc: self.partial.d_vc },
        ))
    }

    /// The media in which light travels on along `direction`.
    pub(crate) fn media_towards(&self, scene: &Scene, direction: Vec3) -> Media {
        self.media.towards(scene, &self.at, self.wo, direction)
    }
}

/// The number of vertices of a subpath up to the one after `depth` scattering events: this one, one per event, and
/// the one on the light or at the camera.
pub(crate) fn count(depth: u32) -> u32 {
    depth + 2
}

/// The fraction of the vertices of light subpaths that are kept for connections, at this number of an event in a row in media: all of
/// the first, then fewer and fewer, which count for more. Some walks through milk have ten thousand events.
fn kept_share(number: u32) -> f32 {
    const ALL: u32 = 64;
    if number <= ALL { 1.0 } else { ALL as f32 / number as f32 }
}

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
    /// The techniques by which its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
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
            techniques,
        }
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
        // Light sampling connects the first surface of a light subpath with the light.
        let is_at_light = walk.depth == 0 && self.mode == TransportMode::Importance;
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
        let Travelled { arrival, passage, emitted, .. } =
            walk.travel(Some(first), tracer, sample, self.mode, keep);
        self.glow = emitted;
        let media = walk.media;
        let back = passage.returning(self.leaves_medium);
        let Some(at) = media.interaction(context.scene, &arrival, &sample.wavelength) else {
            self.partial.pass(1.0, Edge { forward: passage.survival, back });
            return None;
        };
        let (wo, t) = (walk.wo(), at.t());
        let edge = Edge { forward: passage.arriving(at.cos(wo)), back };
        let distance2 = if self.by_area { 1.0 } else { t * t };
        let connections = if is_at_light { PerSet::ONE } else { self.techniques.connections };
        let is_left = is_at_light && at.direct_light(self.techniques) == DirectLight::Left;
        let merged = if is_left { PerSet::ZERO } else { at.merged(self.techniques, sample.channel) };
        let distance2 = distance2 * self.light_sampling_ratio(context.scene, at.p());
        self.partial.arrive(distance2, edge, connections, merged);
        let events = self.walk.events().and(at.is_inside());
        self.partial.in_row(events.in_row);
        self.by_area = false;
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
            TransportMode::Importance => DirectLight::Found,
            TransportMode::Radiance => at.direct_light(self.techniques),
        };
        self.partial.leave(cos, at.sine(*wo, sample.wi), pdfs, direct, vertex.events.in_row);
        self.walk.is_split = vertex.is_split();
        self.walk.follow(task.context.scene, at, *wo, media, &sample, self.mode);
        self.walk.survives(roulette_depth, self.full, || u_survival)
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

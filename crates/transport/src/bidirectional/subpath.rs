//! Subpaths while they grow, from either end, and their vertices.

use super::Partial;
use crate::emission::Start;
use crate::media::Media;
use crate::photons::{Photon, PhotonPosition};
use crate::task::{PathVertex, Task, VertexKind};
use crate::techniques::{PerSet, TechniqueCounts};
use crate::walk::Walk;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, Ray, Scene, Surface, TransportMode};

/// A surface that a subpath has hit.
pub(crate) struct Vertex<const N: usize = 1> {
    pub(crate) surface: Surface,
    pub(crate) bsdf: Bsdf,
    /// The direction that the subpath came from, a unit vector.
    pub(crate) wo: Vec3,
    /// Throughput: what arrives, over the density of having come here.
    pub(crate) beta: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events before this vertex.
    pub(crate) depth: u32,
    /// The cell in which its light subpath began: [`crate::emission::Start::cell`].
    pub(crate) origin: u16,
    /// The subpath carries a single wavelength, whatever the surface here does.
    pub(super) came_split: bool,
    /// The media on the side of `wo`.
    media: Media,
}

impl<const N: usize> Vertex<N> {
    /// The number of vertices of the subpath up to here, including the one on the light or at the camera.
    pub(crate) fn count(&self) -> u32 {
        count(self.depth)
    }

    /// True where a path through here carries a single wavelength.
    pub(super) fn is_split(&self) -> bool {
        self.came_split || self.bsdf.splits()
    }

    /// The photon that is stored for merging.
    pub(crate) fn photon(&self) -> (PhotonPosition, Photon<N>) {
        let position = PhotonPosition::new(self.surface.p, self.depth, self.came_split, self.origin);
        let (wo, n_geom, beta) = (self.wo, self.surface.n_geom, self.beta);
        (position, Photon { wo, n_geom, beta, connected: self.partial.connected, d_vc: self.partial.d_vc })
    }

    /// The media in which light travels on along `direction`.
    pub(crate) fn media_towards(&self, scene: &Scene, direction: Vec3) -> Media {
        self.media.towards(scene, &self.surface, self.wo, direction)
    }
}

/// The number of vertices of a subpath up to the surface after `depth` scattering events: this one, one per event, and
/// the one on the light or at the camera.
pub(crate) fn count(depth: u32) -> u32 {
    depth + 2
}

/// A subpath on its way to the next vertex.
pub(crate) struct Subpath<'w, const N: usize = 1> {
    pub(crate) walk: Walk,
    /// What it carries: radiance on a camera subpath, importance on a light subpath.
    mode: TransportMode,
    pub(crate) partial: Partial<N>,
    /// The density of arriving is over area already: at the first surface that light from infinity hits.
    by_area: bool,
    /// The maximum channel at the start; Russian roulette measures the survival of light subpaths against it.
    full: f32,
    /// The light that it comes from and how it left, until it hits a surface.
    start: Option<Start>,
    origin: u16,
    /// The techniques by which its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
}

impl<'w, const N: usize> Subpath<'w, N> {
    /// A subpath with only its first ray. The media that this starts in are looked for when it hits a surface.
    pub(crate) fn new(
        mode: TransportMode,
        ray: Ray,
        beta: Rgb,
        partial: Partial<N>,
        by_area: bool,
        techniques: &'w TechniqueCounts<N>,
    ) -> Subpath<'w, N> {
        let (walk, full) = (Walk::new(&ray, beta, Media::AIR), beta.max_channel());
        Subpath { walk, mode, partial, by_area, full, start: None, origin: 0, techniques }
    }

    /// The same from a light of the scene.
    pub(crate) fn leaving(self, start: Start) -> Subpath<'w, N> {
        Subpath { origin: start.cell, start: Some(start), ..self }
    }

    /// The light that it comes from.
    #[cfg(test)]
    pub(super) fn light(&self) -> Option<usize> {
        self.start.map(|start| start.light)
    }

    /// Traces to the next surface; `None` where the ray leaves the scene.
    pub(crate) fn next_vertex(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let hit = task.tracer.closest(&self.walk.ray);
        let vertex = hit.and_then(|surface| self.vertex_at(surface, task));
        let sample = &mut *task.sample;
        sample.vertices += u32::from(vertex.is_some());
        let is_light = self.mode == TransportMode::Importance;
        let kind = if is_light { VertexKind::LightPath } else { VertexKind::Surface };
        match &vertex {
            None => sample.note(self.walk.depth, || {
                format!("{} leaves the scene towards {:?}", self.whose(), self.walk.ray.direction)
            }),
            Some(Vertex { surface, .. }) => sample.note_vertex(self.walk.depth, || {
                let what = format!("{} hits object {} at {}", self.whose(), surface.object, surface.p);
                (PathVertex::new(kind, surface.p), what)
            }),
        }
        vertex
    }

    /// The same where the first surface along the ray is known.
    #[inline]
    pub(crate) fn vertex_at(&mut self, surface: Surface, task: &mut Task) -> Option<Vertex<N>> {
        let Task { context, tracer, sample } = task;
        let walk = &mut self.walk;
        if walk.depth == 0 {
            walk.media = Media::at_start(tracer, &walk.ray);
        }
        let mut media = walk.media;
        let (surface, passed) = media.closest_from(tracer, &walk.ray, surface)?;
        let wo = walk.wo();
        walk.beta *= passed;
        let distance2 = if self.by_area { 1.0 } else { surface.t * surface.t };
        // Light sampling connects the first surface of a light subpath with the light.
        let is_at_light = walk.depth == 0 && self.mode == TransportMode::Importance;
        let connections = if is_at_light { PerSet::ONE } else { self.techniques.connections };
        let merged = if is_at_light && !self.techniques.direct { PerSet::ZERO } else { self.techniques.eta };
        let distance2 = distance2 * self.light_sampling_ratio(context.scene, surface.p);
        self.partial.arrive(distance2, surface.n_geom.dot(wo).abs(), connections, merged);
        self.by_area = false;
        let bsdf = media.bsdf(context.scene, &surface, &sample.wavelength);
        let Subpath { walk: Walk { beta, depth, is_split, .. }, partial, origin, .. } = *self;
        Some(Vertex { surface, bsdf, wo, beta, partial, depth, origin, came_split: is_split, media })
    }

    /// Continues from a vertex; false when the subpath ends there.
    pub(crate) fn scatter(&mut self, vertex: &Vertex<N>, roulette_depth: u32, task: &mut Task) -> bool {
        let sampler = &mut task.sample.sampler;
        let (u_choice, u) = (sampler.next_1d(), sampler.next_2d());
        let u_survival = sampler.next_1d();
        let Vertex { surface, bsdf, wo, media, .. } = vertex;
        let Some(sample) = bsdf.sample(*wo, u_choice, u, self.mode) else { return false };
        let cos = surface.n_geom.dot(sample.wi).abs();
        let back = || bsdf.pdf_solid_angle(sample.wi, *wo, self.mode.reversed());
        let pdfs = (!sample.is_delta).then(|| (sample.pdf_solid_angle, back()));
        let counts = self.techniques.direct || self.mode == TransportMode::Importance;
        self.partial.leave(cos, pdfs, counts);
        self.walk.is_split = vertex.is_split();
        self.walk.follow(task.context.scene, surface, *wo, media, &sample, self.mode);
        self.walk.survives(roulette_depth, self.full, || u_survival)
    }

    /// The number of its vertices if it hits an emitter next.
    pub(crate) fn count(&self) -> u32 {
        count(self.walk.depth)
    }

    /// The factor by which the first surface of a light subpath would sample its start more often than assumed so far.
    fn light_sampling_ratio(&mut self, scene: &Scene, from: Vec3) -> f32 {
        self.start.take().map_or(1.0, |Start { light, ray, .. }| {
            let light = &scene.lights()[light].light;
            // No surface samples what light sampling leaves out.
            if ray.pdf_direct > 0.0 { light.direct_pdf(&ray, from) / ray.pdf_direct } else { 1.0 }
        })
    }

    fn whose(&self) -> &'static str {
        if self.mode == TransportMode::Radiance { "the camera's path" } else { "the light's path" }
    }
}

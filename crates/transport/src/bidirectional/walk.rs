//! A random walk: a subpath while it grows, from either end.

use super::Partial;
use crate::emission::Start;
use crate::media::Media;
use crate::photons::{Photon, PhotonPosition};
use crate::task::{PathVertex, Task, VertexKind};
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, BsdfSample, Ray, Scene, Surface, TransportMode};

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
pub(crate) struct Walk<'w, const N: usize = 1> {
    /// What it carries: radiance on a camera subpath, importance on a light subpath.
    mode: TransportMode,
    pub(crate) ray: Ray,
    pub(crate) beta: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events so far.
    pub(crate) depth: u32,
    /// True while all events have been delta events: what only the camera sees may still be visible.
    pub(crate) specular: bool,
    /// It carries a single wavelength.
    pub(crate) is_split: bool,
    /// The density of arriving is over area already: at the first surface that light from infinity hits.
    by_area: bool,
    /// The factor (η²) by which refraction has divided radiance so far; Russian roulette must not depend on it.
    eta_scale: f32,
    /// The maximum channel at the start of a light subpath; Russian roulette measures survival against it.
    full: f32,
    /// The light that it comes from and how it left, until it hits a surface.
    start: Option<Start>,
    /// The media that the ray travels in; known once it has hit a surface.
    media: Option<Media>,
    origin: u16,
    /// The techniques by which its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
}

impl<'w, const N: usize> Walk<'w, N> {
    /// A subpath with only its first ray.
    pub(crate) fn new(
        mode: TransportMode,
        ray: Ray,
        beta: Rgb,
        partial: Partial<N>,
        by_area: bool,
        techniques: &'w TechniqueCounts<N>,
    ) -> Walk<'w, N> {
        let full = beta.max_channel();
        Walk {
            ray,
            beta,
            partial,
            depth: 0,
            specular: true,
            is_split: false,
            by_area,
            eta_scale: 1.0,
            full,
            start: None,
            media: None,
            mode,
            origin: 0,
            techniques,
        }
    }

    /// The same from a light of the scene.
    pub(crate) fn leaving(self, start: Start) -> Walk<'w, N> {
        Walk { origin: start.cell, start: Some(start), ..self }
    }

    /// The light that it comes from.
    #[cfg(test)]
    pub(super) fn light(&self) -> Option<usize> {
        self.start.map(|start| start.light)
    }

    /// Traces to the next surface; `None` where the ray leaves the scene.
    pub(crate) fn next_vertex(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let hit = task.tracer.closest(&self.ray);
        let vertex = hit.and_then(|surface| self.vertex_at(surface, task));
        task.vertices += u32::from(vertex.is_some());
        let is_light = self.mode == TransportMode::Importance;
        let kind = if is_light { VertexKind::LightPath } else { VertexKind::Surface };
        match &vertex {
            None => task.note(self.depth, || {
                format!("{} leaves the scene towards {:?}", self.whose(), self.ray.direction)
            }),
            Some(Vertex { surface, .. }) => task.note_vertex(self.depth, || {
                let what = format!("{} hits object {} at {}", self.whose(), surface.object, surface.p);
                (PathVertex::new(kind, surface.p), what)
            }),
        }
        vertex
    }

    /// The same where the first surface along the ray is known.
    #[inline]
    pub(crate) fn vertex_at(&mut self, surface: Surface, task: &mut Task) -> Option<Vertex<N>> {
        let mut media = self.media.unwrap_or_else(|| Media::at_start(task.tracer, &self.ray));
        let (surface, passed) = media.closest_from(task.tracer, &self.ray, surface)?;
        let wo = -Vec3::from(self.ray.direction);
        self.beta *= passed;
        let distance2 = if self.by_area { 1.0 } else { surface.t * surface.t };
        // Light sampling connects the first surface of a light subpath with the light.
        let is_at_light = self.depth == 0 && self.mode == TransportMode::Importance;
        let connections = if is_at_light { PerSet::ONE } else { self.techniques.connections };
        let merged = if is_at_light && !self.techniques.direct { PerSet::ZERO } else { self.techniques.eta };
        let distance2 = distance2 * self.light_sampling_ratio(task.scene(), surface.p);
        self.partial.arrive(distance2, surface.n_geom.dot(wo).abs(), connections, merged);
        self.by_area = false;
        let bsdf = media.bsdf(task.scene(), &surface, &task.wavelength);
        let (beta, partial, depth, origin) = (self.beta, self.partial, self.depth, self.origin);
        Some(Vertex { surface, bsdf, wo, beta, partial, depth, origin, came_split: self.is_split, media })
    }

    /// Continues from a vertex; false when the subpath ends there.
    pub(crate) fn scatter(&mut self, vertex: &Vertex<N>, roulette_depth: u32, task: &mut Task) -> bool {
        let (u_choice, u) = (task.sampler.next_1d(), task.sampler.next_2d());
        let u_survival = task.sampler.next_1d();
        let Some(sample) = vertex.bsdf.sample(vertex.wo, u_choice, u, self.mode) else { return false };
        let cos = vertex.surface.n_geom.dot(sample.wi).abs();
        let back = || vertex.bsdf.pdf_solid_angle(sample.wi, vertex.wo, self.mode.reversed());
        let pdfs = (!sample.is_delta).then(|| (sample.pdf_solid_angle, back()));
        let counts = self.techniques.direct || self.mode == TransportMode::Importance;
        self.partial.leave(cos, pdfs, counts);
        self.follow(vertex, &sample, task);
        self.survives(u_survival, roulette_depth)
    }

    /// The number of its vertices if it hits an emitter next.
    pub(crate) fn count(&self) -> u32 {
        count(self.depth)
    }

    /// Its throughput as the colour channels see it, if it hits an emitter next.
    pub(crate) fn seen(&self, task: &Task) -> Rgb {
        task.seen(self.beta, self.is_split)
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

    fn follow(&mut self, vertex: &Vertex<N>, sample: &BsdfSample, task: &Task) {
        self.beta *= sample.weight;
        self.depth += 1;
        self.specular &= sample.is_delta;
        self.is_split = vertex.is_split();
        self.eta_scale *= sample.eta * sample.eta;
        self.media = Some(vertex.media_towards(task.scene(), sample.wi));
        self.ray = vertex.surface.spawn(sample.wi);
    }

    /// Russian roulette by the subpath's throughput. [Arvo 1990]
    fn survives(&mut self, u: f32, roulette_depth: u32) -> bool {
        if self.beta.is_black() {
            return false;
        }
        if self.depth <= roulette_depth {
            return true;
        }
        let eta_scale = if self.mode == TransportMode::Radiance { self.eta_scale } else { 1.0 };
        let survival = (self.beta.max_channel() / self.full * eta_scale).min(0.95);
        if u < survival {
            self.beta = self.beta / survival;
            return true;
        }
        // NaN must reach the film, which reports it.
        survival.is_nan()
    }
}

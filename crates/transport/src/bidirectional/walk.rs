//! A subpath while it grows, from whichever end.

use super::photons::{Photon, Spot};
use super::{Lanes, Partial, TechniqueCounts};
use crate::emission::Start;
use crate::media::Media;
use crate::task::Task;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, BsdfSample, Ray, Scene, Surface, TransportMode};

/// A surface that a subpath has met.
pub(crate) struct Vertex<const N: usize = 1> {
    pub(crate) surface: Surface,
    pub(crate) bsdf: Bsdf,
    /// Where the subpath came from, a unit vector.
    pub(crate) wo: Vec3,
    /// What arrives, over the density of having come here.
    pub(crate) beta: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events before this vertex.
    pub(crate) depth: u32,
    /// Where its light path began: [`crate::emission::Start::cell`].
    pub(crate) origin: u16,
    /// The subpath is of one wavelength, whatever the surface here does.
    pub(super) came_split: bool,
    /// On the side of `wo`.
    media: Media,
}

impl<const N: usize> Vertex<N> {
    /// Vertices of the subpath up to here, with that on the light or at the camera.
    pub(crate) fn count(&self) -> u32 {
        count(self.depth)
    }

    /// True where a path through here is of one wavelength.
    pub(super) fn is_split(&self) -> bool {
        self.came_split || self.bsdf.splits()
    }

    /// What is kept of it to merge with.
    pub(super) fn photon(&self) -> (Spot, Photon<N>) {
        let spot = Spot::new(self.surface.p, self.depth, self.came_split, self.origin);
        let (wo, n_geom, beta) = (self.wo, self.surface.n_geom, self.beta);
        (spot, Photon { wo, n_geom, beta, joined: self.partial.joined, d_vc: self.partial.d_vc })
    }

    /// The media in which light goes on along `direction`.
    pub(crate) fn media_towards(&self, scene: &Scene, direction: Vec3) -> Media {
        self.media.towards(scene, &self.surface, self.wo, direction)
    }
}

/// Vertices of a subpath up to the surface that comes after `depth` scattering events: that one, those of the events, and
/// that on the light or at the camera.
pub(crate) fn count(depth: u32) -> u32 {
    depth + 2
}

/// A subpath on its way to the next vertex.
pub(crate) struct Walk<'w, const N: usize = 1> {
    /// What it carries: radiance from the camera on, importance from a light.
    mode: TransportMode,
    pub(crate) ray: Ray,
    pub(crate) beta: Rgb,
    pub(crate) partial: Partial<N>,
    /// Scattering events so far.
    pub(crate) depth: u32,
    /// True while all events have been without width: what only the camera sees may still be seen.
    pub(crate) specular: bool,
    /// It is of one wavelength.
    pub(crate) is_split: bool,
    /// The density of arriving is over area as it is: at the first surface that light from infinity meets.
    by_area: bool,
    /// What refraction has divided radiance by so far (η²), which survival must not depend on.
    eta_scale: f32,
    /// The greatest channel at the beginning, for light paths; survival is measured against it.
    full: f32,
    /// The light that it comes from and how it left, until it has met something.
    start: Option<Start>,
    /// Where the ray goes; known once it has met something.
    media: Option<Media>,
    origin: u16,
    /// How its vertices may be found otherwise.
    techniques: &'w TechniqueCounts<N>,
}

impl<'w, const N: usize> Walk<'w, N> {
    /// A subpath with nothing but its first ray.
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

    /// The next surface; `None` where the ray leaves the scene.
    pub(crate) fn meet(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let mut media = self.media.unwrap_or_else(|| Media::at_start(task.tracer, &self.ray));
        let Some((surface, passed)) = media.closest(task.tracer, &self.ray) else {
            task.note(self.depth, || {
                format!("{} leaves the scene towards {:?}", self.whose(), self.ray.direction)
            });
            return None;
        };
        task.note(self.depth, || {
            format!("{} meets object {} at {}", self.whose(), surface.object, surface.p)
        });
        let wo = -Vec3::from(self.ray.direction);
        self.beta *= passed;
        let distance2 = if self.by_area { 1.0 } else { surface.t * surface.t };
        // The first surface of a light path is joined with the light by picking a point there.
        let is_at_light = self.depth == 0 && self.mode == TransportMode::Importance;
        let joins = if is_at_light { Lanes::ONE } else { self.techniques.joins };
        let merged = if is_at_light && !self.techniques.direct { Lanes::ZERO } else { self.techniques.eta };
        let distance2 = distance2 * self.picked_more(task.scene(), surface.p);
        self.partial.arrive(distance2, surface.n_geom.dot(wo).abs(), joins, merged);
        self.by_area = false;
        let bsdf = media.bsdf(task.scene(), &surface, &task.wavelength);
        let (beta, partial, depth, origin) = (self.beta, self.partial, self.depth, self.origin);
        Some(Vertex { surface, bsdf, wo, beta, partial, depth, origin, came_split: self.is_split, media })
    }

    /// Goes on from a vertex; false when the subpath ends there.
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

    /// What the channels see of what it brings, if light is met next.
    pub(crate) fn seen(&self, task: &Task) -> Rgb {
        task.seen(self.beta, self.is_split)
    }

    /// How much more often than its start has counted on so far, the first surface of a light path would pick that start.
    fn picked_more(&mut self, scene: &Scene, from: Vec3) -> f32 {
        self.start.take().map_or(1.0, |Start { light, ray, .. }| {
            let light = &scene.lights()[light].light;
            // What picking leaves out, no surface would pick.
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

    /// Russian roulette by what the path could still carry. [Arvo 1990]
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
        // What is not a number must reach the film, which reports it.
        survival.is_nan()
    }
}

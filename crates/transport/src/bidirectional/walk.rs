//! A subpath while it grows, from whichever end.

use super::{Lanes, Partial, Ways};
use crate::medium::transmittance;
use crate::task::Task;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, BsdfSample, Ray, Surface, TransportMode};

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
    /// Absorption on the side of `wo`.
    pub(crate) sigma_a: Rgb,
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
    /// The density of arriving is over area as it is: at the first surface that light from infinity meets.
    by_area: bool,
    /// What refraction has divided radiance by so far (η²), which survival must not depend on.
    eta_scale: f32,
    /// The greatest channel at the beginning, for light paths; survival is measured against it.
    full: f32,
    /// Absorption where the ray goes, as far as is known.
    sigma_a: Rgb,
    /// How its vertices may be found otherwise.
    ways: &'w Ways<N>,
}

impl<'w, const N: usize> Walk<'w, N> {
    /// A subpath with nothing but its first ray.
    pub(crate) fn new(
        mode: TransportMode,
        ray: Ray,
        beta: Rgb,
        partial: Partial<N>,
        by_area: bool,
        ways: &'w Ways<N>,
    ) -> Walk<'w, N> {
        let full = beta.max_channel();
        Walk {
            ray,
            beta,
            partial,
            depth: 0,
            specular: true,
            by_area,
            eta_scale: 1.0,
            full,
            sigma_a: Rgb::BLACK,
            mode,
            ways,
        }
    }

    /// The next surface; `None` where the ray leaves the scene.
    pub(crate) fn meet(&mut self, task: &mut Task) -> Option<Vertex<N>> {
        let Some(surface) = task.tracer.closest(&self.ray) else {
            task.note(self.depth, || {
                format!("{} leaves the scene towards {:?}", self.whose(), self.ray.direction)
            });
            return None;
        };
        task.note(self.depth, || {
            format!("{} meets object {} at {}", self.whose(), surface.object, surface.p)
        });
        let wo = -Vec3::from(self.ray.direction);
        let material = task.scene().material(&surface);
        let outside = surface.n_geom.dot(wo) >= 0.0;
        let sigma_a = if outside { self.sigma_a } else { material.sigma_a() };
        self.sigma_a = sigma_a;
        self.beta *= transmittance(sigma_a, surface.t);
        let distance2 = if self.by_area { 1.0 } else { surface.t * surface.t };
        // The first surface of a light path is joined with the light by picking a point there.
        let is_at_light = self.depth == 0 && self.mode == TransportMode::Importance;
        let joins = if is_at_light { Lanes::ONE } else { self.ways.joins };
        self.partial.arrive(distance2, surface.n_geom.dot(wo).abs(), joins);
        self.by_area = false;
        let bsdf = material.bsdf(&surface);
        Some(Vertex { surface, bsdf, wo, beta: self.beta, partial: self.partial, depth: self.depth, sigma_a })
    }

    /// Goes on from a vertex; false when the subpath ends there.
    pub(crate) fn scatter(&mut self, vertex: &Vertex<N>, roulette_depth: u32, task: &mut Task) -> bool {
        let (u_choice, u) = (task.sampler.next_1d(), task.sampler.next_2d());
        let u_survival = task.sampler.next_1d();
        let Some(sample) = vertex.bsdf.sample(vertex.wo, u_choice, u, self.mode) else { return false };
        let cos = vertex.surface.n_geom.dot(sample.wi).abs();
        let back = || vertex.bsdf.pdf_solid_angle(sample.wi, vertex.wo, self.mode.reversed());
        let pdfs = (!sample.is_delta).then(|| (sample.pdf_solid_angle, back()));
        self.partial.leave(cos, pdfs, self.ways);
        self.follow(vertex, &sample, task);
        self.survives(u_survival, roulette_depth)
    }

    fn whose(&self) -> &'static str {
        if self.mode == TransportMode::Radiance { "the camera's path" } else { "the light's path" }
    }

    fn follow(&mut self, vertex: &Vertex<N>, sample: &BsdfSample, task: &Task) {
        self.beta *= sample.weight;
        self.depth += 1;
        self.specular &= sample.is_delta;
        self.eta_scale *= sample.eta * sample.eta;
        let goes_in = sample.wi.dot(vertex.surface.n_geom) < 0.0;
        self.sigma_a = match (sample.transmits, goes_in) {
            (false, _) => vertex.sigma_a,
            (true, true) => task.scene().material(&vertex.surface).sigma_a(),
            (true, false) => Rgb::BLACK,
        };
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

//! Rays on which paths leave surfaces, [`LANES`] of them at a time: throughput, Russian roulette, the next ray.
//!
//! Every expression is the one that a single path evaluates ([`PathTracing::interact`]), in the same order, so that the bits are
//! the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, rgb, run_at, vec3};
use super::paths::{Paths, QueuedPath};
use super::vertices::{NO_PATH, Vertices};
use crate::path_tracing::{LastEvent, Path, PathTracing};
use crate::walk::{MOST, survival};
use bilux_math::Vec3;
use bilux_scene::CpuLevel;
use bilux_scene::surface::offset_origin;

/// The next ray of each path.
pub(super) struct NextRays {
    /// Throughput: before the vertex, then after it.
    pub(super) beta: Columns3,
    pub(super) eta_scale: Column,
    origin: Columns3,
    pub(super) direction: Columns3,
    pdf: Column,
    /// 1 where Russian roulette is played, otherwise 0.
    plays: Column,
    /// 1 where the path goes on, otherwise 0.
    pub(super) goes_on: Column,
}

impl Default for NextRays {
    fn default() -> NextRays {
        NextRays {
            beta: ZERO3,
            eta_scale: Column::ZERO,
            origin: ZERO3,
            direction: ZERO3,
            pdf: Column::ZERO,
            plays: Column::ZERO,
            goes_on: Column::ZERO,
        }
    }
}

impl NextRays {
    /// A lane's path as it arrives.
    #[inline]
    pub(super) fn put_path(&mut self, i: usize, one: &QueuedPath) {
        put(&mut self.beta, i, one.path.walk.beta.to_array());
        self.eta_scale.0[i] = one.path.walk.eta_scale;
    }

    /// Sets where the rays start.
    #[inline(always)]
    pub(super) fn leave_surface(&mut self, v: &Vertices) {
        let Vertices { p, p_error, n_geom, .. } = v;
        let NextRays { origin, direction, .. } = self;
        for i in 0..LANES {
            let (from, n, wi) = (vec3(p, i), vec3(n_geom, i), vec3(direction, i));
            put(origin, i, offset_origin(from, vec3(p_error, i), n, wi).to_array());
        }
    }
}

impl Paths {
    /// Sends every path on in the direction that was sampled for it, and lists those that survive.
    ///
    /// `direction` and `goes_on` have the directions, and `scattered` and `pdf` of the vertices their BSDFs.
    pub(super) fn send_on(
        &mut self,
        v: &mut Vertices,
        next: &mut NextRays,
        tracing: &PathTracing,
        level: CpuLevel,
    ) {
        run_at(level, Leave { v, next });
        self.play_roulette(v, next, tracing, level);
        let NextRays { pdf, .. } = &*next;
        self.set_rays(v, next, |path, i| {
            path.walk.specular = false;
            let (p, pdf) = (vec3(&v.p, i), pdf.0[i]);
            path.last = Some(LastEvent { p, pdf, is_in_medium: false, approach: None });
        });
    }

    /// Russian roulette for every path.
    pub(super) fn play_roulette(
        &self,
        v: &mut Vertices,
        next: &mut NextRays,
        tracing: &PathTracing,
        level: CpuLevel,
    ) {
        let mut plays = false;
        for i in (0..v.count).filter(|&i| v.paths[i] != NO_PATH) {
            let depth = self.paths[v.paths[i] as usize].path.walk.depth + 1;
            next.plays.0[i] = if depth > tracing.roulette_depth { 1.0 } else { 0.0 };
            plays |= depth > tracing.roulette_depth;
        }
        if plays {
            v.draw_numbers(level, v.dimension + 1);
            run_at(level, Survive { v, next });
        }
    }

    /// Sets the rays of the paths that go on, and lists these; `set` does what else depends on the kind of surface.
    pub(super) fn set_rays(&mut self, v: &Vertices, next: &NextRays, mut set: impl FnMut(&mut Path, usize)) {
        for i in (0..v.count).filter(|&i| next.goes_on.0[i] != 0.0 && v.paths[i] != NO_PATH) {
            let path = &mut self.paths[v.paths[i] as usize].path;
            path.walk.ray = v.leaving(i, vec3(&next.origin, i), vec3(&next.direction, i));
            path.walk.beta = rgb(&next.beta, i);
            path.walk.depth += 1;
            set(path, i);
            self.next.push(v.paths[i]);
        }
    }
}

/// The weight for choosing the only lobe, by which its density is multiplied and divided again.
#[inline(always)]
pub(super) fn density(strength: f32, pdf: f32) -> f32 {
    let weighted = strength * pdf;
    if strength > 0.0 { weighted / strength } else { 0.0 }
}

/// Rest of a random number after it has chosen the only lobe, which has this strength.
#[inline(always)]
pub(super) fn rest_of_number(u_choice: f32, strength: f32) -> f32 {
    let rest = u_choice * strength;
    let left = (rest / strength).clamp(0.0, 1.0 - f32::EPSILON);
    if rest < strength { left } else { 1.0 - f32::EPSILON }
}

/// True when two directions are on the same sides of the triangle and of the interpolated surface.
#[inline(always)]
pub(super) fn sides_agree([n_geom, n_shade]: [Vec3; 2], wo: Vec3, wi: Vec3) -> bool {
    (wo.dot(n_geom) * wi.dot(n_geom)) * (wo.dot(n_shade) * wi.dot(n_shade)) > 0.0
}

/// Throughput after the vertex, and the ray.
struct Leave<'a> {
    v: &'a Vertices,
    next: &'a mut NextRays,
}

impl Stage for Leave<'_> {
    #[inline(always)]
    fn run(self) {
        let Leave { v, next } = self;
        let Vertices { n_geom, wo, scattered, pdf, .. } = v;
        for i in 0..LANES {
            let (wo, wi, n_geom) = (vec3(wo, i), vec3(&next.direction, i), vec3(n_geom, i));
            let changes_side = wo.dot(n_geom) * wi.dot(n_geom) < 0.0;
            let beta = rgb(&next.beta, i) * (rgb(scattered, i) / pdf.0[i]);
            let is_black = (beta.r == 0.0) & (beta.g == 0.0) & (beta.b == 0.0);
            let goes_on = !changes_side & (pdf.0[i] > 0.0) & !is_black;
            next.goes_on.0[i] = if goes_on { next.goes_on.0[i] } else { 0.0 };
            next.pdf.0[i] = pdf.0[i];
            put(&mut next.beta, i, beta.to_array());
        }
        next.leave_surface(v);
    }
}

/// Russian roulette, as in [`PathTracing::interact`].
struct Survive<'a> {
    v: &'a Vertices,
    next: &'a mut NextRays,
}

impl Stage for Survive<'_> {
    #[inline(always)]
    fn run(self) {
        let Survive { v: Vertices { u, .. }, next } = self;
        for i in 0..LANES {
            let beta = rgb(&next.beta, i);
            let survival = survival(beta, 1.0, next.eta_scale.0[i], MOST);
            let (plays, survives) = (next.plays.0[i] != 0.0, u[0].0[i] < survival);
            let scaled = beta / survival;
            let of = |c: f32, scaled: f32| if plays & survives { scaled } else { c };
            put(&mut next.beta, i, [of(beta.r, scaled.r), of(beta.g, scaled.g), of(beta.b, scaled.b)]);
            // NaN must reach the film, which reports it.
            let goes_on = !plays | survives | survival.is_nan();
            next.goes_on.0[i] = if goes_on { next.goes_on.0[i] } else { 0.0 };
        }
    }
}

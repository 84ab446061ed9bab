//! Mirrors and smooth glass, [`LANES`] of them at a time: no light sample reaches them, so paths only change direction.
//!
//! Every expression is the one that a single path evaluates ([`PathTracing::interact`] with a [`bilux_scene::Bsdf`] of one delta
//! lobe), in the same order, so that the bits are the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, numbers_at, put, put_numbers, rgb, run_at, vec3};
use super::next_rays::{NextRays, rest_of_number};
use super::paths::Paths;
use super::triangles::Triangles;
use super::vertices::{NO_PATH, Vertices};
use crate::path_tracing::PathTracing;
use crate::sampling::task::Context;
use bilux_accel::Hit;
use bilux_math::Frame;
use bilux_math::frame::reflect;
use bilux_scene::TransportMode;
use bilux_scene::bsdf::SmoothLobe;

/// Data of these vertices, beyond those of all vertices.
pub(super) struct Smooth {
    triangles: Triangles,
    n_shade: Columns3,
    lobes: [Column; SmoothLobe::NUMBERS],
    /// 1 where a direction about the shading normal does not work, otherwise 0.
    fails: Column,
    /// 1 where light passes a pane straight, as [`bilux_scene::Bsdf::straight`] says, otherwise 0.
    straight: Column,
    /// The place of each lane's hit in its chunk.
    hits: [usize; LANES],
    next: NextRays,
}

impl Default for Smooth {
    fn default() -> Smooth {
        Smooth {
            triangles: Triangles::default(),
            n_shade: ZERO3,
            lobes: [Column::ZERO; SmoothLobe::NUMBERS],
            fails: Column::ZERO,
            straight: Column::ZERO,
            hits: [0; LANES],
            next: NextRays::default(),
        }
    }
}

impl Paths {
    /// Sends the paths of these hits on, and lists those that survive.
    pub(super) fn shade_smooth(
        &mut self,
        v: &mut Vertices,
        s: &mut Smooth,
        tracing: &PathTracing,
        context: &Context,
    ) {
        let hits = std::mem::take(&mut self.smooth_hits);
        let level = context.scene.cpu_level();
        for chunk in hits.chunks(LANES) {
            self.gather_smooth(v, s, chunk, context);
            if v.count == 0 {
                continue;
            }
            v.dimension = context.lights.draws() + 1;
            v.draw_numbers(level, v.dimension);
            run_at(level, Bounce { v, s });
            self.leave_failed(v, s, chunk);
            // A point follows that delta lobes do not use.
            v.dimension += 1;
            self.play_roulette(v, &mut s.next, tracing, level);
            self.set_rays(v, &s.next, |path, i| {
                path.walk.eta_scale = s.next.eta_scale.0[i];
                path.last = path.last.filter(|_| s.straight.0[i] != 0.0);
            });
        }
        self.smooth_hits = hits;
    }

    /// Fills the columns with a chunk of hits; paths that have reached their maximum depth end.
    fn gather_smooth(
        &mut self,
        v: &mut Vertices,
        s: &mut Smooth,
        chunk: &[(u32, u32, Hit)],
        context: &Context,
    ) {
        v.count = 0;
        for (number, (index, object, hit)) in chunk.iter().enumerate() {
            let one = &mut self.paths[*index as usize];
            if one.path.walk.depth >= context.max_depth {
                continue;
            }
            let Some(lobe) = context.scene.smooth_triangle(*object, hit) else {
                self.general_hits.push((*index, *hit));
                continue;
            };
            one.state.sampler.enter(u64::from(one.path.walk.depth) + 1);
            let wo = one.path.walk.wo();
            let i = v.push_path(*index, (hit.primitive(), one.path.walk.ray.time), wo, &one.state.sampler);
            s.triangles.put(i, *object, hit);
            put_numbers(&mut s.lobes, i, lobe.to_numbers());
            s.next.put_path(i, one);
            s.hits[i] = number;
        }
        let points = s.triangles.points(context.scene);
        (v.p, v.p_error, v.n_geom, s.n_shade) = (points.p, points.p_error, points.n_geom, points.n_shade);
    }

    /// Leaves paths to be shaded one by one where no direction about the shading normal works: few do not.
    fn leave_failed(&mut self, v: &mut Vertices, s: &Smooth, chunk: &[(u32, u32, Hit)]) {
        for i in (0..v.count).filter(|&i| s.fails.0[i] != 0.0) {
            let (index, _, hit) = chunk[s.hits[i]];
            self.general_hits.push((index, hit));
            v.paths[i] = NO_PATH;
        }
    }
}

/// The next directions and rays.
struct Bounce<'a> {
    v: &'a Vertices,
    s: &'a mut Smooth,
}

impl Stage for Bounce<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { n_geom, wo, u, .. } = self.v;
        let Smooth { n_shade, lobes, fails, straight, next, .. } = self.s;
        for i in 0..LANES {
            let (wo, n_geom) = (vec3(wo, i), vec3(n_geom, i));
            let frame = Frame::from_normal(vec3(n_shade, i));
            let lobe = SmoothLobe::from_numbers(numbers_at(lobes, i));
            let strength = lobe.tint.luminance();
            let sample = lobe.sample(frame.to_local(wo), rest_of_number(u[0].0[i], strength));
            let wi = frame.to_world(sample.wi);
            let wi = wi * (1.0 / wi.length_squared().sqrt());
            let sees_side = wo.dot(frame.n) * wo.dot(n_geom) > 0.0;
            let keeps_side = (wo.dot(n_geom) * wi.dot(n_geom) < 0.0) == sample.transmits;
            let beta = rgb(&next.beta, i) * lobe.weight(&sample, TransportMode::Radiance);
            let is_black = (beta.r == 0.0) & (beta.g == 0.0) & (beta.b == 0.0);
            fails.0[i] = if (strength > 0.0) & !(sees_side & keeps_side) { 1.0 } else { 0.0 };
            let works = reflect(wo, frame.n).dot(n_geom) * wo.dot(n_geom) > 0.0;
            straight.0[i] = if lobe.thin & sample.transmits & works { 1.0 } else { 0.0 };
            next.goes_on.0[i] = if (strength > 0.0) & !is_black { 1.0 } else { 0.0 };
            next.eta_scale.0[i] *= sample.eta * sample.eta;
            put(&mut next.beta, i, beta.to_array());
            put(&mut next.direction, i, wi.to_array());
        }
        self.s.next.leave_surface(self.v);
    }
}

//! Surfaces of every other kind: their BSDFs are evaluated and sampled one by one, and all else in columns.

use super::lanes::{LANES, put, vec3};
use super::paths::Paths;
use super::vertices::{Point, Vertices};
use crate::media::Arrival;
use crate::media::interaction::Interaction;
use crate::path_tracing::{Path, PathTracing};
use crate::sampling::task::Context;
use bilux_accel::Hit;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{CpuLevel, Tracer, TransportMode};

/// Data of these vertices, beyond those of all vertices.
#[derive(Default)]
pub(super) struct General {
    interactions: Vec<Interaction>,
}

impl Paths {
    /// Shades these hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_general<'a>(
        &mut self,
        v: &mut Vertices,
        g: &mut General,
        tracing: &PathTracing,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let hits = std::mem::take(&mut self.general_hits);
        let mut begin = 0;
        while begin < hits.len() {
            begin += self.arrive(v, g, &hits[begin..], tracing, context, tracer);
            if v.count > 0 {
                let scene = context.scene;
                let media = |path: &Path, i: usize, wi: Vec3| {
                    path.walk.media.towards(scene, &g.interactions[i], path.walk.wo(), wi)
                };
                self.connect(v, context, |v, _: CpuLevel| g.eval(v), media);
                self.leave(v, g, tracing, context, tracer);
            }
        }
        self.general_hits = hits;
    }

    /// Fills the columns with vertices; returns the number of hits used. Paths that end here are done, and those that
    /// meet only delta lobes, which no light sample finds, go on at once.
    fn arrive<'a>(
        &mut self,
        v: &mut Vertices,
        g: &mut General,
        hits: &[(u32, Hit)],
        tracing: &PathTracing,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) -> usize {
        let is_clear = context.scene.has_clear_media();
        v.count = 0;
        g.interactions.clear();
        for (used, (index, hit)) in hits.iter().enumerate() {
            if v.count == LANES {
                return used;
            }
            let one = &mut self.paths[*index as usize];
            let mut surface = tracer.surface(&one.path.walk.ray, hit);
            if !is_clear {
                let walk = &mut one.path.walk;
                let (next, passed) = walk.media.closest_from(tracer, &walk.ray, surface, 0);
                walk.beta *= passed;
                let Some(next) = next else {
                    let (path, mut task) = one.parts(context, tracer);
                    tracing.escape(path, &mut task);
                    continue;
                };
                surface = next;
            }
            let wo = one.path.walk.wo();
            let (path, mut task) = one.parts(context, tracer);
            g.interactions.extend(tracing.arrive(path, &Arrival::Surface(surface), &mut task));
            if g.interactions.len() == v.count {
                continue;
            }
            one.begin_event();
            let at = &g.interactions[v.count];
            if at.is_delta() {
                let (path, mut task) = one.parts(context, tracer);
                tracing.skip_lights(&mut task);
                if tracing.scatter(path, at, None, &mut task) {
                    self.next.push(*index);
                }
                g.interactions.truncate(v.count);
                continue;
            }
            v.push(*index, &Point::from(&surface), wo, &one.state.sampler);
            self.shaded.push(*index);
        }
        hits.len()
    }

    /// Sends every path on in a new direction, and lists those that survive.
    fn leave<'a>(
        &mut self,
        v: &mut Vertices,
        g: &General,
        tracing: &PathTracing,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let level = context.scene.cpu_level();
        let dimension = v.dimension;
        v.draw_numbers(level, dimension + 1);
        let u_choice = v.u[0];
        v.draw_points(level, dimension + 2);
        let u = v.u;
        v.draw_numbers(level, dimension + 3);
        for (i, at) in g.interactions.iter().enumerate() {
            let (path, mut task) = self.paths[v.paths[i] as usize].parts(context, tracer);
            let point = Vec2::new(u[0].0[i], u[1].0[i]);
            let goes_on = tracing.scatter_by(path, (at, None), &mut task, (u_choice.0[i], point))
                && tracing.survives(path, || v.u[0].0[i]);
            if goes_on {
                self.next.push(v.paths[i]);
            }
        }
    }
}

impl General {
    /// The BSDFs for the light samples.
    fn eval(&self, v: &mut Vertices) {
        let Vertices { wo, light, scattered, pdf, .. } = v;
        for (i, at) in self.interactions.iter().enumerate() {
            let is_wanted = light.pdf.0[i] > 0.0 && !super::lanes::rgb(&light.li, i).is_black();
            let (found, density) = match is_wanted {
                true => at.eval_and_pdf(vec3(wo, i), vec3(&light.wi, i), TransportMode::Radiance),
                false => (Rgb::BLACK, 0.0),
            };
            put(scattered, i, found.to_array());
            pdf.0[i] = density;
        }
    }
}

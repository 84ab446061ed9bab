//! Surfaces of every other kind: their BSDFs are evaluated and sampled one by one, and all else in columns.

use super::lanes::{LANES, put, vec3};
use super::paths::Paths;
use super::vertices::{Point, Vertices};
use crate::integrators::path::{Path, Walk};
use crate::task::Task;
use bilux_accel::Hit;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Bsdf, CpuLevel, Surface, TransportMode};

/// What these vertices have beyond the others.
#[derive(Default)]
pub(super) struct General {
    surfaces: Vec<Surface>,
    bsdfs: Vec<Bsdf>,
}

impl Paths {
    /// Shades these hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_general(
        &mut self,
        (v, g): (&mut Vertices, &mut General),
        path: &Path,
        task: &mut Task,
    ) {
        let hits = std::mem::take(&mut self.general_hits);
        let mut begin = 0;
        while begin < hits.len() {
            begin += self.arrive(v, g, &hits[begin..], path, task);
            if v.count > 0 {
                let scene = task.scene();
                let media = |walk: &Walk, i: usize, wi: Vec3| {
                    walk.media.towards(scene, &g.surfaces[i], -Vec3::from(walk.ray.direction), wi)
                };
                self.connect(v, task, |v, _: CpuLevel| g.eval(v), media);
                self.leave(v, g, path, task);
            }
        }
        self.general_hits = hits;
    }

    /// Fills the columns with vertices; returns the number of hits used. Paths that end here are done, and those that
    /// meet only delta lobes, which no light sample finds, go on at once.
    fn arrive(
        &mut self,
        v: &mut Vertices,
        g: &mut General,
        hits: &[(u32, Hit)],
        path: &Path,
        task: &mut Task,
    ) -> usize {
        let is_clear = task.scene().has_clear_media();
        v.count = 0;
        g.surfaces.clear();
        g.bsdfs.clear();
        for (used, (index, hit)) in hits.iter().enumerate() {
            if v.count == LANES {
                return used;
            }
            let one = &mut self.paths[*index as usize];
            let mut surface = task.tracer.surface(&one.walk.ray, hit);
            if !is_clear {
                let walk = &mut one.walk;
                let Some((next, passed)) = walk.media.closest_from(task.tracer, &walk.ray, surface) else {
                    one.escape(path, task);
                    continue;
                };
                surface = next;
                walk.beta *= passed;
            }
            (task.sampler, task.wavelength) = (one.sampler.clone(), one.wavelength);
            let wo = -Vec3::from(one.walk.ray.direction);
            g.bsdfs.extend(path.arrive(&mut one.walk, &surface, task));
            if g.bsdfs.len() == v.count {
                continue;
            }
            one.begin_event(task);
            let bsdf = &g.bsdfs[v.count];
            if bsdf.is_delta() {
                path.skip_lights(task);
                if path.scatter(&mut one.walk, &surface, bsdf, task) {
                    self.next.push(*index);
                }
                g.bsdfs.truncate(v.count);
                continue;
            }
            v.push(*index, &Point::from(&surface), wo, &task.sampler);
            g.surfaces.push(surface);
            self.shaded.push(*index);
        }
        hits.len()
    }

    /// Sends every path on in a new direction, and lists those that survive.
    fn leave(&mut self, v: &mut Vertices, g: &General, path: &Path, task: &mut Task) {
        let level = task.scene().cpu_level();
        let dimension = v.dimension;
        v.draw_numbers(level, dimension + 1);
        let u_choice = v.u[0];
        v.draw_points(level, dimension + 2);
        let u = v.u;
        v.draw_numbers(level, dimension + 3);
        for (i, (surface, bsdf)) in g.surfaces.iter().zip(&g.bsdfs).enumerate() {
            let walk = &mut self.paths[v.paths[i] as usize].walk;
            let point = Vec2::new(u[0].0[i], u[1].0[i]);
            let goes_on = path.scatter_by(walk, surface, bsdf, task, (u_choice.0[i], point))
                && path.survives(walk, || v.u[0].0[i]);
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
        for (i, bsdf) in self.bsdfs.iter().enumerate() {
            let is_wanted = light.pdf.0[i] > 0.0 && !super::lanes::rgb(&light.li, i).is_black();
            let (found, density) = match is_wanted {
                true => bsdf.eval_and_pdf(vec3(wo, i), vec3(&light.wi, i), TransportMode::Radiance),
                false => (Rgb::BLACK, 0.0),
            };
            put(scattered, i, found.to_array());
            pdf.0[i] = density;
        }
    }
}

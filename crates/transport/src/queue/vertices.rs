//! Vertices of up to [`LANES`] paths, in columns: what all kinds of surface have in common.
//!
//! Every expression is the one that a single path evaluates ([`crate::path_tracing::PathTracing::interact`]), in the same
//! order, so that the bits are the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, rgb, run_at, vec3};
use super::light_samples::{LightSamples, Points};
use super::paths::{Paths, Unoccluded};
use crate::media::Media;
use crate::path_tracing::{Path, power_heuristic};
use crate::sampling::sampler::{self, PixelSampler};
use crate::sampling::task::Context;
use crate::walk::through::Through;
use bilux_math::Vec3;
use bilux_scene::surface::{leaving, offset_origin};
use bilux_scene::{CpuLevel, Primitive, Ray, Surface};

/// Stands for a lane whose path is shaded elsewhere.
pub(super) const NO_PATH: u32 = u32::MAX;

/// The vertices, and what light samples bring them.
pub(super) struct Vertices {
    pub(super) count: usize,
    /// The dimension of the sampler that was drawn last.
    pub(super) dimension: u32,
    /// Indices of the paths.
    pub(super) paths: [u32; LANES],
    pub(super) primitives: [Primitive; LANES],
    pub(super) times: [f32; LANES],
    streams: [u64; LANES],
    reversed_indices: [u32; LANES],
    pub(super) p: Columns3,
    pub(super) p_error: Columns3,
    pub(super) n_geom: Columns3,
    pub(super) wo: Columns3,
    /// The sampler's current numbers.
    pub(super) u: [Column; 2],
    pub(super) light: LightSamples,
    /// f·|cosθ| and density of the BSDF for the light samples.
    pub(super) scattered: Columns3,
    pub(super) pdf: Column,
    shadow: ShadowRays,
}

/// Point of a surface, as the columns hold it; see [`Surface`] for the fields.
pub(super) struct Point {
    pub(super) p: Vec3,
    pub(super) p_error: Vec3,
    pub(super) n_geom: Vec3,
    pub(super) primitive: Primitive,
    pub(super) time: f32,
}

impl From<&Surface> for Point {
    #[inline]
    fn from(surface: &Surface) -> Point {
        let Surface { p, p_error, n_geom, primitive, time, .. } = *surface;
        Point { p, p_error, n_geom, primitive, time }
    }
}

/// The ray to the light sample, and the light that it brings; black where there is none.
struct ShadowRays {
    origin: Columns3,
    direction: Columns3,
    t_max: Column,
    light: Columns3,
}

impl Default for Vertices {
    fn default() -> Vertices {
        Vertices {
            count: 0,
            dimension: 0,
            paths: [0; LANES],
            primitives: [Primitive::NONE; LANES],
            times: [0.0; LANES],
            streams: [0; LANES],
            reversed_indices: [0; LANES],
            p: ZERO3,
            p_error: ZERO3,
            n_geom: ZERO3,
            wo: ZERO3,
            u: [Column::ZERO; 2],
            light: LightSamples::default(),
            scattered: ZERO3,
            pdf: Column::ZERO,
            shadow: ShadowRays { origin: ZERO3, direction: ZERO3, t_max: Column::ZERO, light: ZERO3 },
        }
    }
}

impl Vertices {
    /// Adds the vertex of a path whose sampler has entered it; returns its lane.
    pub(super) fn push(&mut self, path: u32, point: &Point, wo: Vec3, sampler: &PixelSampler) -> usize {
        let i = self.push_path(path, (point.primitive, point.time), wo, sampler);
        self.put_point(i, [point.p, point.p_error, point.n_geom]);
        i
    }

    /// Adds the vertex of a path as [`Vertices::push`] does, but without its point.
    #[inline]
    pub(super) fn push_path(
        &mut self,
        path: u32,
        (primitive, time): (Primitive, f32),
        wo: Vec3,
        sampler: &PixelSampler,
    ) -> usize {
        let i = self.count;
        self.paths[i] = path;
        (self.primitives[i], self.times[i]) = (primitive, time);
        (self.streams[i], self.reversed_indices[i]) = sampler.state();
        put(&mut self.wo, i, wo.to_array());
        self.count += 1;
        i
    }

    /// Sets a lane's point, the bound on its error, and its geometric normal.
    pub(super) fn put_point(&mut self, i: usize, [p, p_error, n_geom]: [Vec3; 3]) {
        put(&mut self.p, i, p.to_array());
        put(&mut self.p_error, i, p_error.to_array());
        put(&mut self.n_geom, i, n_geom.to_array());
    }

    /// Draws a number for each path, into the first column of `u`.
    pub(super) fn draw_numbers(&mut self, level: CpuLevel, dimension: u32) {
        run_at(level, Draw::<false> { v: self, dimension });
    }

    /// Draws a point for each path.
    pub(super) fn draw_points(&mut self, level: CpuLevel, dimension: u32) {
        run_at(level, Draw::<true> { v: self, dimension });
    }

    /// The distance of a lane's light sample in metres; `None` for light from infinity.
    fn distance(&self, i: usize) -> Option<f32> {
        let is_infinite = self.light.is_infinite.0[i] != 0.0;
        (!is_infinite).then(|| vec3(&self.light.towards, i).distance(vec3(&self.p, i)))
    }

    /// The ray that leaves a lane's surface.
    pub(super) fn leaving(&self, i: usize, origin: Vec3, direction: Vec3) -> Ray {
        leaving(origin, direction, self.primitives[i], self.times[i])
    }
}

impl Paths {
    /// Samples lights from every vertex, and lists the shadow rays to them. `eval` fills `scattered` and `pdf` for the
    /// directions of the light samples, and `media` gives the media of a path and lane on the side of a direction.
    pub(super) fn connect(
        &mut self,
        v: &mut Vertices,
        context: &Context,
        mut eval: impl FnMut(&mut Vertices, CpuLevel),
        media: impl Fn(&Path, usize, Vec3) -> Media,
    ) {
        let (choice, level) = (&context.lights, context.scene.cpu_level());
        let mut drawn = [(0, 0.0); LANES];
        if !choice.takes_all() {
            v.draw_numbers(level, 1);
            choice.pick_each((0..v.count).map(|i| (vec3(&v.p, i), v.u[0].0[i])), &mut drawn);
        }
        v.dimension = 1;
        for round in 0..choice.count() {
            v.dimension += 1;
            let by_all = choice.always().get(round);
            let picked = by_all.map_or(drawn, |light| [*light; LANES]);
            if picked.iter().take(v.count).all(|(_, probability)| *probability == 0.0) {
                continue;
            }
            v.draw_points(level, v.dimension);
            let lights = context.scene.lights();
            let Vertices { count, times, p, u, light: samples, .. } = &mut *v;
            let points = Points { count: *count, times, p, u };
            match lights[picked[0].0].light.as_mesh() {
                Some(mesh) if by_all.is_some() => samples.sample_mesh(points, mesh, picked[0].1, level),
                _ => samples.sample_lights(points, &picked, lights),
            }
            eval(v, level);
            run_at(level, Weigh { v });
            // The light of a vertex is summed in the order of the lists.
            let list_of = |light: usize| if choice.is_few() { round } else { light };
            self.list_shadow_rays(v, &picked, list_of, context, &media);
        }
    }

    fn list_shadow_rays(
        &mut self,
        v: &Vertices,
        picked: &[(usize, f32); LANES],
        list_of: impl Fn(usize) -> usize,
        context: &Context,
        media: impl Fn(&Path, usize, Vec3) -> Media,
    ) {
        let scene = context.scene;
        let is_plain = scene.has_plain_shadows();
        for (i, &(light, _)) in picked.iter().enumerate().take(v.count) {
            let contribution = rgb(&v.shadow.light, i);
            if contribution.is_black() || v.paths[i] == NO_PATH {
                continue;
            }
            let ray = v.leaving(i, vec3(&v.shadow.origin, i), vec3(&v.shadow.direction, i));
            let contribution = Unoccluded { path: v.paths[i], light: contribution };
            let ray = Ray { t_max: v.shadow.t_max.0[i], ..ray };
            let media = (!is_plain).then(|| {
                let path = &self.paths[v.paths[i] as usize].path;
                // Columns follow no walks through media that vary.
                let media = media(path, i, vec3(&v.light.wi, i));
                Through { media, distance: v.distance(i), panes: path.walk.panes(context, false), seed: 0 }
            });
            let n_light = vec3(&v.light.n_light, i);
            self.connections.with(list_of(light)).push(ray, n_light, media, contribution);
        }
    }
}

/// Draws a number for each path, or a point.
struct Draw<'a, const POINTS: bool> {
    v: &'a mut Vertices,
    dimension: u32,
}

impl<const POINTS: bool> Stage for Draw<'_, POINTS> {
    #[inline(always)]
    fn run(self) {
        let Vertices { streams, reversed_indices, u: [x, y], .. } = self.v;
        for i in 0..LANES {
            let key = sampler::key(streams[i], self.dimension);
            if POINTS {
                let u = sampler::point(key, reversed_indices[i]);
                (x.0[i], y.0[i]) = (u.x, u.y);
            } else {
                x.0[i] = sampler::number(key, reversed_indices[i]);
            }
        }
    }
}

/// From light samples to shadow rays and the light that they bring.
struct Weigh<'a> {
    v: &'a mut Vertices,
}

impl Stage for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { p, p_error, n_geom, light, scattered, pdf, shadow, .. } = self.v;
        for i in 0..LANES {
            let light_pdf = light.pdf.0[i];
            let weighted = power_heuristic(light_pdf, pdf.0[i]);
            let weight = if light.is_delta.0[i] != 0.0 { 1.0 } else { weighted };
            let contribution = rgb(scattered, i) * rgb(&light.li, i) * (weight / light_pdf);
            let of = |c: f32| if light_pdf > 0.0 { c } else { 0.0 };
            put(&mut shadow.light, i, [of(contribution.r), of(contribution.g), of(contribution.b)]);
        }
        for i in 0..LANES {
            let (from, towards) = (vec3(p, i), vec3(&light.towards, i));
            let is_infinite = light.is_infinite.0[i] != 0.0;
            let aside = if is_infinite { towards } else { towards - from };
            let origin = offset_origin(from, vec3(p_error, i), vec3(n_geom, i), aside);
            let direction = if is_infinite { towards } else { towards - origin };
            put(&mut shadow.origin, i, origin.to_array());
            put(&mut shadow.direction, i, direction.to_array());
            shadow.t_max.0[i] = if is_infinite { f32::INFINITY } else { 1.0 - light.clearance.0[i] };
        }
    }
}

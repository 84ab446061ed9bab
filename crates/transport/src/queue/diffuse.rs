//! Lambertian surfaces, [`LANES`] of them at a time: connections to lights, and the next direction.
//!
//! Every expression is the one that a single path evaluates ([`Path::interact`] with a [`bilux_scene::Bsdf`] of one
//! Lambertian lobe), in the same order, so that the bits are the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, rgb, run_at, vec3};
use super::{PathQueue, Unoccluded};
use crate::integrators::path::{Path, power_heuristic};
use crate::sampler;
use crate::task::Task;
use bilux_math::{Frame, Rgb, Vec2, Vec3, warp};
use bilux_scene::surface::{leaving, offset_origin};
use bilux_scene::{Primitive, Ray};
use std::f32::consts::FRAC_1_PI;

/// The vertices of up to [`LANES`] paths, in columns.
pub(super) struct DiffuseVertices {
    count: usize,
    /// The dimension of the sampler that was drawn last.
    dimension: u32,
    paths: [u32; LANES],
    primitives: [Primitive; LANES],
    times: [f32; LANES],
    streams: [u64; LANES],
    reversed_indices: [u32; LANES],
    p: Columns3,
    p_error: Columns3,
    n_geom: Columns3,
    n_shade: Columns3,
    wo: Columns3,
    reflectance: Columns3,
    /// The sampler's current numbers.
    u: [Column; 2],
    light: LightSamples,
    shadow: ShadowRays,
    next: NextRays,
}

/// A sample of a light for each vertex.
struct LightSamples {
    wi: Columns3,
    li: Columns3,
    /// Where the ray ends: the point on the light; `wi` for light from infinity.
    towards: Columns3,
    n_light: [Vec3; LANES],
    /// 1 for light from infinity, otherwise 0.
    is_infinite: Column,
    clearance: Column,
    /// Density over solid angle times the probability of the light; 0 where there is no sample.
    pdf: Column,
    /// 1 for delta lights, otherwise 0.
    is_delta: Column,
}

/// The ray to the light sample, and the light that it brings; black where there is none.
struct ShadowRays {
    origin: Columns3,
    direction: Columns3,
    t_max: Column,
    light: Columns3,
}

/// The next ray of each path.
struct NextRays {
    /// Throughput: before the vertex, then after it.
    beta: Columns3,
    eta_scale: Column,
    origin: Columns3,
    direction: Columns3,
    pdf: Column,
    /// 1 where the path goes on, otherwise 0.
    goes_on: Column,
}

impl Default for DiffuseVertices {
    fn default() -> DiffuseVertices {
        DiffuseVertices {
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
            n_shade: ZERO3,
            wo: ZERO3,
            reflectance: ZERO3,
            u: [Column::ZERO; 2],
            light: LightSamples {
                wi: ZERO3,
                li: ZERO3,
                towards: ZERO3,
                n_light: [Vec3::ZERO; LANES],
                is_infinite: Column::ZERO,
                clearance: Column::ZERO,
                pdf: Column::ZERO,
                is_delta: Column::ZERO,
            },
            shadow: ShadowRays { origin: ZERO3, direction: ZERO3, t_max: Column::ZERO, light: ZERO3 },
            next: NextRays {
                beta: ZERO3,
                eta_scale: Column::ZERO,
                origin: ZERO3,
                direction: ZERO3,
                pdf: Column::ZERO,
                goes_on: Column::ZERO,
            },
        }
    }
}

impl PathQueue {
    /// Shades the diffuse hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_diffuse(&mut self, path: &Path, task: &mut Task) {
        let mut vertices = self.diffuse.take().unwrap_or_default();
        let hits = std::mem::take(&mut self.diffuse_hits);
        for chunk in hits.chunks(LANES) {
            self.gather(&mut vertices, chunk, task);
            if vertices.count > 0 {
                self.connect(&mut vertices, task);
                self.scatter(&mut vertices, path, task);
            }
        }
        self.diffuse_hits = hits;
        self.diffuse = Some(vertices);
    }

    /// Fills the columns with a chunk of hits; paths that have reached their maximum depth end.
    fn gather(&mut self, v: &mut DiffuseVertices, chunk: &[(u32, bilux_accel::Hit)], task: &mut Task) {
        v.count = 0;
        for (index, hit) in chunk {
            let one = &mut self.paths[*index as usize];
            (one.direct, one.beta) = (Rgb::BLACK, one.walk.beta);
            if one.walk.depth >= task.max_depth {
                continue;
            }
            let surface = task.tracer.surface(&one.walk.ray, hit);
            let i = v.count;
            v.paths[i] = *index;
            (v.primitives[i], v.times[i]) = (surface.primitive, surface.time);
            one.sampler.enter(u64::from(one.walk.depth) + 1);
            (v.streams[i], v.reversed_indices[i]) = one.sampler.state();
            put(&mut v.p, i, surface.p.to_array());
            put(&mut v.p_error, i, surface.p_error.to_array());
            put(&mut v.n_geom, i, surface.n_geom.to_array());
            put(&mut v.n_shade, i, surface.n_shade.to_array());
            put(&mut v.wo, i, (-Vec3::from(one.walk.ray.direction)).to_array());
            let reflectance = task.scene().material(&surface).lambertian_reflectance(&surface);
            put(&mut v.reflectance, i, reflectance.to_array());
            put(&mut v.next.beta, i, one.walk.beta.to_array());
            v.next.eta_scale.0[i] = one.walk.eta_scale;
            self.shaded.push(*index);
            v.count += 1;
        }
    }

    /// Samples lights from every vertex, and lists the shadow rays to them.
    fn connect(&mut self, v: &mut DiffuseVertices, task: &mut Task) {
        let (lights, level) = (task.lights, task.scene().cpu_level());
        let mut picked = [0; LANES];
        let rounds = if lights.takes_all() {
            lights.sample(0.0)
        } else {
            run_at(level, Numbers { v, dimension: 1 });
            for (picked, u) in picked.iter_mut().zip(&v.u[0].0).take(v.count) {
                *picked = lights.sample(*u).start;
            }
            0..1
        };
        v.dimension = 1;
        for round in rounds {
            v.dimension += 1;
            if lights.takes_all() {
                if lights.probability(round) == 0.0 {
                    continue;
                }
                picked = [round; LANES];
            }
            let dimension = v.dimension;
            run_at(level, Points { v, dimension });
            self.sample_lights(v, &picked, task);
            run_at(level, Connect { v });
            for i in 0..v.count {
                let light = rgb(&v.shadow.light, i);
                if light.is_black() {
                    continue;
                }
                let (origin, direction) = (vec3(&v.shadow.origin, i), vec3(&v.shadow.direction, i));
                let ray = leaving(origin, direction, v.primitives[i], v.times[i]);
                let brought = Unoccluded { path: v.paths[i], light, n_light: v.light.n_light[i] };
                self.connections.push(picked[i], Ray { t_max: v.shadow.t_max.0[i], ..ray }, brought);
            }
        }
    }

    /// Samples one light for each vertex.
    fn sample_lights(&self, v: &mut DiffuseVertices, picked: &[usize; LANES], task: &Task) {
        let lights = task.scene().lights();
        for i in 0..v.count {
            let (light, probability) = (&lights[picked[i]].light, task.lights.probability(picked[i]));
            let u = Vec2::new(v.u[0].0[i], v.u[1].0[i]);
            let sample = light.sample_li(vec3(&v.p, i), v.times[i], u).filter(|_| probability > 0.0);
            let Some(sample) = sample else {
                v.light.pdf.0[i] = 0.0;
                continue;
            };
            put(&mut v.light.wi, i, sample.wi.to_array());
            put(&mut v.light.li, i, sample.li.to_array());
            put(&mut v.light.towards, i, sample.point.unwrap_or(sample.wi).to_array());
            v.light.n_light[i] = sample.n_light;
            v.light.is_infinite.0[i] = if sample.point.is_none() { 1.0 } else { 0.0 };
            v.light.clearance.0[i] = sample.clearance;
            v.light.pdf.0[i] = sample.pdf_solid_angle * probability;
            v.light.is_delta.0[i] = if light.is_delta() { 1.0 } else { 0.0 };
        }
    }

    /// Sends every path on in a new direction, and lists those that survive.
    fn scatter(&mut self, v: &mut DiffuseVertices, path: &Path, task: &Task) {
        let level = task.scene().cpu_level();
        // The first number would choose among lobes.
        v.dimension += 2;
        let dimension = v.dimension;
        run_at(level, Points { v, dimension });
        run_at(level, Scatter { v });
        let plays = self.paths[v.paths[0] as usize].walk.depth + 1 > path.roulette_depth();
        if plays {
            run_at(level, Numbers { v, dimension: dimension + 1 });
            run_at(level, Survive { v });
        }
        for i in (0..v.count).filter(|&i| v.next.goes_on.0[i] != 0.0) {
            let walk = &mut self.paths[v.paths[i] as usize].walk;
            let (origin, direction) = (vec3(&v.next.origin, i), vec3(&v.next.direction, i));
            walk.ray = leaving(origin, direction, v.primitives[i], v.times[i]);
            walk.beta = rgb(&v.next.beta, i);
            walk.depth += 1;
            walk.specular = false;
            walk.last = Some((vec3(&v.p, i), v.next.pdf.0[i]));
            self.next.push(v.paths[i]);
        }
    }
}

/// Draws a number for each path.
struct Numbers<'a> {
    v: &'a mut DiffuseVertices,
    dimension: u32,
}

impl Stage for Numbers<'_> {
    #[inline(always)]
    fn run(self) {
        for i in 0..LANES {
            let key = sampler::key(self.v.streams[i], self.dimension);
            self.v.u[0].0[i] = sampler::number(key, self.v.reversed_indices[i]);
        }
    }
}

/// Draws a point for each path.
struct Points<'a> {
    v: &'a mut DiffuseVertices,
    dimension: u32,
}

impl Stage for Points<'_> {
    #[inline(always)]
    fn run(self) {
        for i in 0..LANES {
            let key = sampler::key(self.v.streams[i], self.dimension);
            let u = sampler::point(key, self.v.reversed_indices[i]);
            (self.v.u[0].0[i], self.v.u[1].0[i]) = (u.x, u.y);
        }
    }
}

/// The strength of the only lobe, by which its density is multiplied and divided again.
#[inline(always)]
fn density(strength: f32, pdf: f32) -> f32 {
    let weighted = strength * pdf;
    if strength > 0.0 { weighted / strength } else { 0.0 }
}

/// f·|cosθi| and the density of a Lambertian lobe, as [`bilux_scene::Bsdf::eval_and_pdf`] computes them.
#[inline(always)]
fn eval_and_pdf(reflectance: Rgb, [n_geom, n]: [Vec3; 2], wo: Vec3, wi: Vec3) -> (Rgb, f32) {
    let (cos_o, cos_i) = (wo.dot(n), wi.dot(n));
    let on_one_side = cos_o * cos_i > 0.0;
    let scale = FRAC_1_PI * cos_i.abs();
    let pdf = if on_one_side { warp::cosine_hemisphere_pdf_solid_angle(cos_i.abs()) } else { 0.0 };
    let agrees = (wo.dot(n_geom) * wi.dot(n_geom)) * (cos_o * cos_i) > 0.0;
    let is_lit = on_one_side & agrees;
    let of = |c: f32| if is_lit { c * scale } else { 0.0 };
    let scattered = Rgb::new(of(reflectance.r), of(reflectance.g), of(reflectance.b));
    (scattered, density(reflectance.luminance(), pdf))
}

/// From light samples to shadow rays and the light that they bring.
struct Connect<'a> {
    v: &'a mut DiffuseVertices,
}

impl Stage for Connect<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseVertices { p, p_error, n_geom, n_shade, wo, reflectance, light, shadow, .. } = self.v;
        for i in 0..LANES {
            let normals = [vec3(n_geom, i), vec3(n_shade, i)];
            let (scattered, pdf) =
                eval_and_pdf(rgb(reflectance, i), normals, vec3(wo, i), vec3(&light.wi, i));
            let light_pdf = light.pdf.0[i];
            let weighted = power_heuristic(light_pdf, pdf);
            let weight = if light.is_delta.0[i] != 0.0 { 1.0 } else { weighted };
            let brought = scattered * rgb(&light.li, i) * (weight / light_pdf);
            let of = |c: f32| if light_pdf > 0.0 { c } else { 0.0 };
            put(&mut shadow.light, i, [of(brought.r), of(brought.g), of(brought.b)]);
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

/// A cosine-weighted direction about the shading normal.
struct Scatter<'a> {
    v: &'a mut DiffuseVertices,
}

impl Stage for Scatter<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseVertices { p, p_error, n_geom, n_shade, wo, reflectance, u, next, .. } = self.v;
        for i in 0..LANES {
            let frame = Frame::from_normal(vec3(n_shade, i));
            let cos_o = vec3(wo, i).dot(frame.n);
            let local = warp::sample_cosine_hemisphere(Vec2::new(u[0].0[i], u[1].0[i]));
            let z = local.z * 1f32.copysign(cos_o);
            let is_sampled = cos_o * z > 0.0;
            let wi = frame.to_world(Vec3::new(local.x, local.y, z));
            let wi = wi * (1.0 / wi.length_squared().sqrt());
            put(&mut next.direction, i, wi.to_array());
            next.goes_on.0[i] = if is_sampled { 1.0 } else { 0.0 };
        }
        for i in 0..LANES {
            let (wo, wi, colour) = (vec3(wo, i), vec3(&next.direction, i), rgb(reflectance, i));
            let (scattered, pdf) = eval_and_pdf(colour, [vec3(n_geom, i), vec3(n_shade, i)], wo, wi);
            let changes_side = wo.dot(vec3(n_geom, i)) * wi.dot(vec3(n_geom, i)) < 0.0;
            let beta = rgb(&next.beta, i) * (scattered / pdf);
            let is_black = (beta.r == 0.0) & (beta.g == 0.0) & (beta.b == 0.0);
            let goes_on = !changes_side & (pdf > 0.0) & !is_black & (colour.luminance() > 0.0);
            next.goes_on.0[i] = if goes_on { next.goes_on.0[i] } else { 0.0 };
            next.pdf.0[i] = pdf;
            put(&mut next.beta, i, beta.to_array());
        }
        for i in 0..LANES {
            let (from, n, wi) = (vec3(p, i), vec3(n_geom, i), vec3(&next.direction, i));
            put(&mut next.origin, i, offset_origin(from, vec3(p_error, i), n, wi).to_array());
        }
    }
}

/// Russian roulette, as in [`Path::interact`].
struct Survive<'a> {
    v: &'a mut DiffuseVertices,
}

impl Stage for Survive<'_> {
    #[inline(always)]
    fn run(self) {
        let DiffuseVertices { u, next, .. } = self.v;
        for i in 0..LANES {
            let beta = rgb(&next.beta, i);
            let survival = (beta.max_channel() * next.eta_scale.0[i]).min(0.95);
            let survives = u[0].0[i] < survival;
            let scaled = beta / survival;
            let of = |c: f32, scaled: f32| if survives { scaled } else { c };
            put(&mut next.beta, i, [of(beta.r, scaled.r), of(beta.g, scaled.g), of(beta.b, scaled.b)]);
            // NaN must reach the film, which reports it.
            let goes_on = survives | survival.is_nan();
            next.goes_on.0[i] = if goes_on { next.goes_on.0[i] } else { 0.0 };
        }
    }
}

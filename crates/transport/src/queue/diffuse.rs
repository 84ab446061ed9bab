//! Lambertian surfaces, [`LANES`] of them at a time: their BSDF, and the next direction.
//!
//! Every expression is the one that a single path evaluates ([`Path::interact`] with a [`bilux_scene::Bsdf`] of one
//! Lambertian lobe), in the same order, so that the bits are the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, rgb, run_at, vec3};
use super::paths::Paths;
use super::triangles::Triangles;
use super::vertices::{NO_PATH, Vertices};
use crate::integrators::path::Path;
use crate::task::Task;
use bilux_accel::Hit;
use bilux_math::{Frame, Rgb, Vec2, Vec3, warp};
use bilux_scene::bsdf::faces_away;
use bilux_scene::surface::offset_origin;
use std::f32::consts::FRAC_1_PI;

/// What Lambertian vertices have beyond the others.
pub(super) struct Diffuse {
    triangles: Triangles,
    /// The lanes of other shapes, each with its point, the bound on its error, its geometric normal, and its shading
    /// normal.
    others: Vec<(usize, [Vec3; 3], Vec3)>,
    n_shade: Columns3,
    reflectance: Columns3,
    next: NextRays,
}

/// The next ray of each path.
struct NextRays {
    /// Throughput: before the vertex, then after it.
    beta: Columns3,
    eta_scale: Column,
    origin: Columns3,
    direction: Columns3,
    pdf: Column,
    /// 1 where Russian roulette is played, otherwise 0.
    plays: Column,
    /// 1 where the path goes on, otherwise 0.
    goes_on: Column,
}

impl Default for Diffuse {
    fn default() -> Diffuse {
        Diffuse {
            triangles: Triangles::default(),
            others: Vec::new(),
            n_shade: ZERO3,
            reflectance: ZERO3,
            next: NextRays {
                beta: ZERO3,
                eta_scale: Column::ZERO,
                origin: ZERO3,
                direction: ZERO3,
                pdf: Column::ZERO,
                plays: Column::ZERO,
                goes_on: Column::ZERO,
            },
        }
    }
}

impl Paths {
    /// Shades the diffuse hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_diffuse(
        &mut self,
        (v, d): (&mut Vertices, &mut Diffuse),
        path: &Path,
        task: &mut Task,
    ) {
        let hits = std::mem::take(&mut self.diffuse_hits);
        for chunk in hits.chunks(LANES) {
            self.gather(v, d, chunk, task);
            if v.count > 0 {
                let eval = |v: &mut Vertices, level| run_at(level, Eval { v, d });
                // Light samples bring something only on the side that the path comes from.
                self.connect(v, task, eval, |walk, _, _| walk.media);
                self.scatter(v, d, path, task);
            }
        }
        self.diffuse_hits = hits;
    }

    /// Fills the columns with a chunk of hits; paths that have reached their maximum depth end.
    fn gather(&mut self, v: &mut Vertices, d: &mut Diffuse, chunk: &[(u32, u32, Hit)], task: &mut Task) {
        v.count = 0;
        d.others.clear();
        let is_clear = task.scene().has_clear_media();
        let mut hits = [0; LANES];
        for (number, (index, object, hit)) in chunk.iter().enumerate() {
            let one = &mut self.paths[*index as usize];
            if one.walk.depth >= task.max_depth {
                continue;
            }
            let (i, wo) = (v.count, -Vec3::from(one.walk.ray.direction));
            let plain = if is_clear { task.tracer.lambertian_triangle(*object, hit) } else { None };
            let reflectance = match plain {
                Some((triangle, reflectance)) => {
                    d.triangles.put(i, &triangle, hit);
                    reflectance
                }
                None => {
                    let surface = task.tracer.surface(&one.walk.ray, hit);
                    let reflectance = task.scene().material(&surface).lambertian_reflectance(&surface);
                    if !is_clear && !faces_away(surface.n_shade, surface.n_geom, wo) {
                        let walk = &mut one.walk;
                        let arrived = walk.media.closest_from(task.tracer, &walk.ray, surface);
                        walk.beta *= arrived.map_or(Rgb::BLACK, |(_, passed)| passed);
                    }
                    d.others.push((i, [surface.p, surface.p_error, surface.n_geom], surface.n_shade));
                    reflectance
                }
            };
            one.begin_event(task);
            one.sampler.enter(u64::from(one.walk.depth) + 1);
            v.push_path(*index, (hit.primitive(), one.walk.ray.time), wo, &one.sampler);
            put(&mut d.reflectance, i, reflectance.to_array());
            put(&mut d.next.beta, i, one.walk.beta.to_array());
            d.next.eta_scale.0[i] = one.walk.eta_scale;
            hits[i] = number;
        }
        d.triangles.points(
            task.scene().cpu_level(),
            [&mut v.p, &mut v.p_error, &mut v.n_geom],
            &mut d.n_shade,
        );
        for &(i, point, n_shade) in &d.others {
            v.put_point(i, point);
            put(&mut d.n_shade, i, n_shade.to_array());
        }
        for i in 0..v.count {
            if faces_away(vec3(&d.n_shade, i), vec3(&v.n_geom, i), vec3(&v.wo, i)) {
                // Few normals do, and are bent.
                let (index, _, hit) = chunk[hits[i]];
                self.general_hits.push((index, hit));
                v.paths[i] = NO_PATH;
            } else {
                self.shaded.push(v.paths[i]);
            }
        }
    }

    /// Sends every path on in a new direction, and lists those that survive.
    fn scatter(&mut self, v: &mut Vertices, d: &mut Diffuse, path: &Path, task: &Task) {
        let level = task.scene().cpu_level();
        // The first number would choose among lobes.
        v.dimension += 2;
        v.draw_points(level, v.dimension);
        run_at(level, Scatter { v, d });
        let mut plays = false;
        for i in (0..v.count).filter(|&i| v.paths[i] != NO_PATH) {
            let depth = self.paths[v.paths[i] as usize].walk.depth + 1;
            d.next.plays.0[i] = if depth > path.roulette_depth() { 1.0 } else { 0.0 };
            plays |= depth > path.roulette_depth();
        }
        if plays {
            v.draw_numbers(level, v.dimension + 1);
            run_at(level, Survive { v, next: &mut d.next });
        }
        for i in (0..v.count).filter(|&i| d.next.goes_on.0[i] != 0.0 && v.paths[i] != NO_PATH) {
            let walk = &mut self.paths[v.paths[i] as usize].walk;
            walk.ray = v.leaving(i, vec3(&d.next.origin, i), vec3(&d.next.direction, i));
            walk.beta = rgb(&d.next.beta, i);
            walk.depth += 1;
            walk.specular = false;
            walk.last = Some((vec3(&v.p, i), d.next.pdf.0[i]));
            self.next.push(v.paths[i]);
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

/// The BSDF for the light samples.
struct Eval<'a> {
    v: &'a mut Vertices,
    d: &'a Diffuse,
}

impl Stage for Eval<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { n_geom, wo, light, scattered, pdf, .. } = self.v;
        let Diffuse { n_shade, reflectance, .. } = self.d;
        for i in 0..LANES {
            let normals = [vec3(n_geom, i), vec3(n_shade, i)];
            let (found, density) =
                eval_and_pdf(rgb(reflectance, i), normals, vec3(wo, i), vec3(&light.wi, i));
            put(scattered, i, found.to_array());
            pdf.0[i] = density;
        }
    }
}

/// A cosine-weighted direction about the shading normal.
struct Scatter<'a> {
    v: &'a Vertices,
    d: &'a mut Diffuse,
}

impl Stage for Scatter<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { p, p_error, n_geom, wo, u, .. } = self.v;
        let Diffuse { n_shade, reflectance, next, .. } = self.d;
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
    v: &'a Vertices,
    next: &'a mut NextRays,
}

impl Stage for Survive<'_> {
    #[inline(always)]
    fn run(self) {
        let Survive { v: Vertices { u, .. }, next } = self;
        for i in 0..LANES {
            let beta = rgb(&next.beta, i);
            let survival = (beta.max_channel() * next.eta_scale.0[i]).min(0.95);
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

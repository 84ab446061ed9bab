//! Lambertian surfaces, [`LANES`] of them at a time: their BSDF, and the next direction.
//!
//! Every expression is the one that a single path evaluates ([`PathTracing::interact`] with a [`bilux_scene::Bsdf`] of one
//! Lambertian lobe), in the same order, so that the bits are the same.

use super::lanes::{Columns3, LANES, Stage, ZERO3, put, rgb, run_at, vec3};
use super::next_rays::{NextRays, density, sides_agree};
use super::paths::Paths;
use super::triangles::Triangles;
use super::vertices::{NO_PATH, Vertices};
use crate::path_tracing::PathTracing;
use crate::sampling::task::Context;
use bilux_accel::Hit;
use bilux_math::{Frame, Rgb, Vec2, Vec3, warp};
use bilux_scene::bsdf::faces_away;
use bilux_scene::{CpuLevel, Tracer};
use std::f32::consts::FRAC_1_PI;

/// Data of Lambertian vertices, beyond those of all vertices.
pub(super) struct Diffuse {
    triangles: Triangles,
    /// The lanes of other shapes, each with its point, the bound on its error, its geometric normal, and its shading
    /// normal.
    others: Vec<(usize, [Vec3; 3], Vec3)>,
    n_shade: Columns3,
    reflectance: Columns3,
    next: NextRays,
}

impl Default for Diffuse {
    fn default() -> Diffuse {
        Diffuse {
            triangles: Triangles::default(),
            others: Vec::new(),
            n_shade: ZERO3,
            reflectance: ZERO3,
            next: NextRays::default(),
        }
    }
}

impl Paths {
    /// Shades the diffuse hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_diffuse(
        &mut self,
        v: &mut Vertices,
        d: &mut Diffuse,
        tracing: &PathTracing,
        context: &Context,
        tracer: &mut Tracer,
    ) {
        let hits = std::mem::take(&mut self.diffuse_hits);
        for chunk in hits.chunks(LANES) {
            self.gather(v, d, chunk, context, tracer);
            if v.count > 0 {
                let eval = |v: &mut Vertices, level| run_at(level, Eval { v, d });
                // Light samples bring something only on the side that the path comes from.
                self.connect(v, context, eval, |path, _, _| path.walk.media);
                self.scatter(v, d, tracing, context.scene.cpu_level());
            }
        }
        self.diffuse_hits = hits;
    }

    /// Fills the columns with a chunk of hits; paths that have reached their maximum depth end.
    fn gather(
        &mut self,
        v: &mut Vertices,
        d: &mut Diffuse,
        chunk: &[(u32, u32, Hit)],
        context: &Context,
        tracer: &mut Tracer,
    ) {
        v.count = 0;
        d.others.clear();
        let is_clear = context.scene.has_clear_media();
        let mut hits = [0; LANES];
        for (number, (index, object, hit)) in chunk.iter().enumerate() {
            let one = &mut self.paths[*index as usize];
            if one.path.walk.depth >= context.max_depth {
                continue;
            }
            let (i, wo) = (v.count, one.path.walk.wo());
            let plain = if is_clear { context.scene.lambertian_triangle(*object, hit) } else { None };
            let reflectance = match plain {
                Some(reflectance) => {
                    d.triangles.put(i, *object, hit);
                    reflectance
                }
                None => {
                    let surface = tracer.surface(&one.path.walk.ray, hit);
                    let reflectance = context.scene.material(&surface).lambertian_reflectance(&surface);
                    if !is_clear && !faces_away(surface.n_shade, surface.n_geom, wo) {
                        let walk = &mut one.path.walk;
                        let (_, passed) = walk.media.closest_from(tracer, &walk.ray, surface, 0);
                        walk.beta *= passed;
                    }
                    d.others.push((i, [surface.p, surface.p_error, surface.n_geom], surface.n_shade));
                    reflectance
                }
            };
            one.begin_event();
            one.state.sampler.enter(u64::from(one.path.walk.depth) + 1);
            v.push_path(*index, (hit.primitive(), one.path.walk.ray.time), wo, &one.state.sampler);
            put(&mut d.reflectance, i, reflectance.to_array());
            d.next.put_path(i, one);
            hits[i] = number;
        }
        let points = d.triangles.points(context.scene);
        (v.p, v.p_error, v.n_geom, d.n_shade) = (points.p, points.p_error, points.n_geom, points.n_shade);
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
    fn scatter(&mut self, v: &mut Vertices, d: &mut Diffuse, tracing: &PathTracing, level: CpuLevel) {
        // The first number would choose among lobes.
        v.dimension += 2;
        v.draw_points(level, v.dimension);
        run_at(level, Scatter { v, d });
        self.send_on(v, &mut d.next, tracing, level);
    }
}

/// f·|cosθi| and the density of a Lambertian lobe, as [`bilux_scene::Bsdf::eval_and_pdf`] computes them.
#[inline(always)]
fn eval_and_pdf(reflectance: Rgb, [n_geom, n]: [Vec3; 2], wo: Vec3, wi: Vec3) -> (Rgb, f32) {
    let (cos_o, cos_i) = (wo.dot(n), wi.dot(n));
    let on_one_side = cos_o * cos_i > 0.0;
    let scale = FRAC_1_PI * cos_i.abs();
    let pdf = if on_one_side { warp::cosine_hemisphere_pdf_solid_angle(cos_i.abs()) } else { 0.0 };
    let is_lit = on_one_side & sides_agree([n_geom, n], wo, wi);
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

/// A cosine-weighted direction about the shading normal, and the BSDF for it.
struct Scatter<'a> {
    v: &'a mut Vertices,
    d: &'a mut Diffuse,
}

impl Stage for Scatter<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { n_geom, wo, u, scattered, pdf, .. } = self.v;
        let Diffuse { n_shade, reflectance, next, .. } = self.d;
        for i in 0..LANES {
            let frame = Frame::from_normal(vec3(n_shade, i));
            let cos_o = vec3(wo, i).dot(frame.n);
            let local = warp::sample_cosine_hemisphere(Vec2::new(u[0].0[i], u[1].0[i]));
            let z = local.z * 1f32.copysign(cos_o);
            let is_sampled = (cos_o * z > 0.0) & (rgb(reflectance, i).luminance() > 0.0);
            let wi = frame.to_world(Vec3::new(local.x, local.y, z));
            let wi = wi * (1.0 / wi.length_squared().sqrt());
            put(&mut next.direction, i, wi.to_array());
            next.goes_on.0[i] = if is_sampled { 1.0 } else { 0.0 };
        }
        for i in 0..LANES {
            let (wo, wi, colour) = (vec3(wo, i), vec3(&next.direction, i), rgb(reflectance, i));
            let (found, density) = eval_and_pdf(colour, [vec3(n_geom, i), vec3(n_shade, i)], wo, wi);
            put(scattered, i, found.to_array());
            pdf.0[i] = density;
        }
    }
}

//! Surfaces of an [`OpaqueBase`](bilux_scene::bsdf::OpaqueBase), [`LANES`] of them at a time: metal, plastic and paint, as most glTF files have them.
//! The textures of surfaces in a row that have one material are looked up together; the BSDF is built, evaluated and sampled in columns.
//!
//! Every expression is the one that a single path evaluates ([`PathTracing::interact`] with a [`bilux_scene::Bsdf`] of that one
//! lobe), in the same order, so that the bits are the same.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, numbers_at, put, put_numbers, rgb, run_at, vec3};
use super::next_rays::{NextRays, density, rest_of_number, sides_agree};
use super::paths::Paths;
use super::vertices::{Point, Vertices};
use crate::path_tracing::PathTracing;
use crate::sampling::task::Context;
use bilux_accel::Hit;
use bilux_math::{Frame, Vec2};
use bilux_scene::bsdf::{AlbedoTable, OpaqueBaseAlbedos, OpaqueBaseForWo, OpaqueBaseInputs, faces_away};
use bilux_scene::{Surface, Tracer};

/// Data of these vertices, beyond those of all vertices.
pub(super) struct Opaque {
    table: &'static AlbedoTable,
    /// The surfaces of a chunk of hits, and what they are made of.
    surfaces: Vec<Surface>,
    bases: Vec<Option<OpaqueBaseInputs>>,
    inputs: Inputs,
    n_shade: Columns3,
    /// The numbers of each lobe.
    lobes: [Column; OpaqueBaseForWo::NUMBERS],
    /// Albedos from the table.
    albedos: [Column; 5],
    /// The number that picks one of the lobe's two densities.
    u_choice: Column,
    next: NextRays,
}

/// [`OpaqueBaseInputs`] in columns.
struct Inputs {
    base_color: Columns3,
    specular_color: Columns3,
    metalness: Column,
    specular_weight: Column,
    roughness: Column,
    ior: Column,
}

impl Default for Opaque {
    fn default() -> Opaque {
        Opaque {
            table: AlbedoTable::shared(),
            surfaces: Vec::with_capacity(LANES),
            bases: Vec::with_capacity(LANES),
            inputs: Inputs {
                base_color: ZERO3,
                specular_color: ZERO3,
                metalness: Column::ZERO,
                specular_weight: Column::ZERO,
                roughness: Column::ZERO,
                ior: Column::ZERO,
            },
            n_shade: ZERO3,
            lobes: [Column::ZERO; OpaqueBaseForWo::NUMBERS],
            albedos: [Column::ZERO; 5],
            u_choice: Column::ZERO,
            next: NextRays::default(),
        }
    }
}

impl Inputs {
    fn put(&mut self, i: usize, inputs: &OpaqueBaseInputs) {
        put(&mut self.base_color, i, inputs.base_color.to_array());
        put(&mut self.specular_color, i, inputs.specular_color.to_array());
        self.metalness.0[i] = inputs.metalness;
        self.specular_weight.0[i] = inputs.specular_weight;
        self.roughness.0[i] = inputs.roughness;
        self.ior.0[i] = inputs.ior;
    }

    #[inline(always)]
    fn at(&self, i: usize) -> OpaqueBaseInputs {
        OpaqueBaseInputs {
            base_color: rgb(&self.base_color, i),
            metalness: self.metalness.0[i],
            specular_weight: self.specular_weight.0[i],
            specular_color: rgb(&self.specular_color, i),
            roughness: self.roughness.0[i],
            ior: self.ior.0[i],
        }
    }
}

impl Paths {
    /// Shades these hits: fills the lists of shadow rays and of paths that go on.
    pub(super) fn shade_opaque<'a>(
        &mut self,
        v: &mut Vertices,
        o: &mut Opaque,
        tracing: &PathTracing,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let hits = std::mem::take(&mut self.opaque_hits);
        for chunk in hits.chunks(LANES) {
            self.gather_opaque(v, o, chunk, tracing, context, tracer);
            if v.count == 0 {
                continue;
            }
            let level = context.scene.cpu_level();
            run_at(level, Build { v, o });
            // Light samples bring something only on the side that the path comes from.
            let eval = |v: &mut Vertices, level| run_at(level, Eval::<true> { v, o });
            self.connect(v, context, eval, |path, _, _| path.walk.media);
            v.draw_numbers(level, v.dimension + 1);
            o.u_choice = v.u[0];
            v.dimension += 2;
            v.draw_points(level, v.dimension);
            run_at(level, Sample { v, o });
            run_at(level, Eval::<false> { v, o });
            self.send_on(v, &mut o.next, tracing, level);
        }
        self.opaque_hits = hits;
    }

    /// Fills the columns with a chunk of hits; paths that have reached their maximum depth end.
    fn gather_opaque<'a>(
        &mut self,
        v: &mut Vertices,
        o: &mut Opaque,
        chunk: &[(u32, Hit)],
        tracing: &PathTracing,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        v.count = 0;
        let is_clear = context.scene.has_clear_media();
        let Opaque { surfaces, bases, inputs: columns, n_shade, next, .. } = o;
        let hits = chunk.iter().map(|(index, hit)| (&self.paths[*index as usize].path.walk.ray, hit));
        tracer.opaque_bases(hits, (&mut *surfaces, &mut *bases));
        for ((index, hit), (surface, base)) in chunk.iter().zip(surfaces.iter().zip(bases)) {
            let one = &mut self.paths[*index as usize];
            let wo = one.path.walk.wo();
            let inputs = match base {
                Some(inputs) if !faces_away(surface.n_shade, surface.n_geom, wo) => inputs,
                // Few normals face away, and are bent; few points are polished.
                _ => {
                    self.general_hits.push((*index, *hit));
                    continue;
                }
            };
            if !is_clear {
                let walk = &mut one.path.walk;
                let (_, passed) = walk.media.closest_from(tracer, &walk.ray, *surface, 0);
                walk.beta *= passed;
            }
            one.begin_event();
            let (path, mut task) = one.parts(context, tracer);
            tracing.collect(path, surface, &mut task);
            if one.path.walk.depth >= context.max_depth {
                continue;
            }
            one.state.sampler.enter(u64::from(one.path.walk.depth) + 1);
            let i = v.push(*index, &Point::from(surface), wo, &one.state.sampler);
            columns.put(i, inputs);
            put(n_shade, i, surface.n_shade.to_array());
            next.put_path(i, one);
            self.shaded.push(*index);
        }
    }
}

/// From inputs to lobes.
struct Build<'a> {
    v: &'a Vertices,
    o: &'a mut Opaque,
}

impl Stage for Build<'_> {
    #[inline(always)]
    fn run(self) {
        // Read once: as far as the compiler knows, what the loop writes might change it.
        let table = self.o.table;
        let Vertices { wo, .. } = self.v;
        let Opaque { inputs, n_shade, lobes, albedos, .. } = self.o;
        for i in 0..LANES {
            let cos_o = vec3(wo, i).dot(vec3(n_shade, i));
            let OpaqueBaseAlbedos { mean, at_normal, along_wo } = inputs.at(i).look_up(cos_o, table);
            put_numbers(albedos, i, [mean[0], mean[1], at_normal, along_wo[0], along_wo[1]]);
        }
        for i in 0..LANES {
            let wo = Frame::from_normal(vec3(n_shade, i)).to_local(vec3(wo, i));
            let [opaque_mean, mean, at_normal, opaque, boundary] = numbers_at(albedos, i);
            let albedos =
                OpaqueBaseAlbedos { mean: [opaque_mean, mean], at_normal, along_wo: [opaque, boundary] };
            put_numbers(lobes, i, OpaqueBaseForWo::new(&inputs.at(i), wo, &albedos).to_numbers());
        }
    }
}

#[inline(always)]
fn lobe_at(lobes: &[Column; OpaqueBaseForWo::NUMBERS], i: usize) -> OpaqueBaseForWo {
    OpaqueBaseForWo::from_numbers(numbers_at(lobes, i))
}

/// The BSDF for the light samples, or for the next directions.
struct Eval<'a, const OF_LIGHTS: bool> {
    v: &'a mut Vertices,
    o: &'a mut Opaque,
}

impl<const OF_LIGHTS: bool> Stage for Eval<'_, OF_LIGHTS> {
    #[inline(always)]
    fn run(self) {
        let table = self.o.table;
        let Vertices { n_geom, wo, light, scattered, pdf, .. } = self.v;
        let Opaque { n_shade, lobes, albedos: [opaque, boundary, ..], next, .. } = self.o;
        let directions = if OF_LIGHTS { &light.wi } else { &next.direction };
        for i in 0..LANES {
            let cos_i = vec3(directions, i).dot(vec3(n_shade, i));
            [opaque.0[i], boundary.0[i]] = lobe_at(lobes, i).look_up(cos_i, table);
        }
        for i in 0..LANES {
            let (normals, wo, wi) = ([vec3(n_geom, i), vec3(n_shade, i)], vec3(wo, i), vec3(directions, i));
            let (lobe, local_wi) = (lobe_at(lobes, i), Frame::from_normal(normals[1]).to_local(wi));
            let (found, density_of_lobe) = lobe.eval_and_pdf(local_wi, [opaque.0[i], boundary.0[i]]);
            let agree = sides_agree(normals, wo, wi);
            let of = |c: f32| if agree { c } else { 0.0 };
            put(scattered, i, [of(found.r), of(found.g), of(found.b)]);
            pdf.0[i] = density(lobe.strength(), density_of_lobe);
        }
    }
}

/// The next directions.
struct Sample<'a> {
    v: &'a Vertices,
    o: &'a mut Opaque,
}

impl Stage for Sample<'_> {
    #[inline(always)]
    fn run(self) {
        let Vertices { wo, u, .. } = self.v;
        let Opaque { n_shade, lobes, u_choice, next, .. } = self.o;
        for i in 0..LANES {
            let (frame, lobe) = (Frame::from_normal(vec3(n_shade, i)), lobe_at(lobes, i));
            let strength = lobe.strength();
            let left = rest_of_number(u_choice.0[i], strength);
            let local = lobe.sample(left, Vec2::new(u[0].0[i], u[1].0[i]));
            let is_sampled = (vec3(wo, i).dot(frame.n) * local.z > 0.0) & (strength > 0.0);
            let wi = frame.to_world(local);
            let wi = wi * (1.0 / wi.length_squared().sqrt());
            put(&mut next.direction, i, wi.to_array());
            next.goes_on.0[i] = if is_sampled { 1.0 } else { 0.0 };
        }
    }
}

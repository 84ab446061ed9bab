//! `path`: path tracing from the camera. Each vertex samples a light and samples its BSDF, and the power heuristic
//! combines the two. [Kajiya 1986; Veach 1997, 9.2]

use super::light_connection::LightConnection;
use super::{IntegratorEntry, PixelIntegrator};
use crate::media::Media;
use crate::task::{PathVertex, Task, VertexKind};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::lights::Light;
use bilux_scene::{Bsdf, BsdfSample, Ray, Scene, Surface, TransportMode};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "path",
        summary: "path tracing with next-event estimation: unbiased",
        source: "Kajiya 1986",
        parameters: &[
            Parameter {
                name: "sampling",
                summary: "how direct light is sampled: by the lights and the BSDF with multiple importance sampling \
                          (mis), by the lights only, or by the BSDF only (scattering)",
                unit: "",
                kind: ParameterKind::Choice(&["mis", "lights", "scattering"]),
                default: "mis",
            },
            super::ROULETTE_DEPTH,
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        let sampling = match reader.text("sampling").as_str() {
            "lights" => Sampling::Lights,
            "scattering" => Sampling::Scattering,
            _ => Sampling::Mis,
        };
        Ok(Box::new(Path { sampling, roulette_depth: reader.integer("roulette_depth") as u32 }))
    },
};

pub(crate) struct Path {
    sampling: Sampling,
    roulette_depth: u32,
}

/// A vertex that samples lights.
#[derive(Clone, Copy)]
struct Vertex<'a> {
    surface: &'a Surface,
    bsdf: &'a Bsdf,
    wo: Vec3,
    /// The media on the side of `wo`.
    media: &'a Media,
}

/// How light is sampled where both techniques could find it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sampling {
    Mis,
    Lights,
    Scattering,
}

/// A path as it grows from the camera.
pub(crate) struct Walk {
    pub(crate) ray: Ray,
    /// What it has found.
    pub(crate) light: Rgb,
    /// Scattering events so far.
    pub(crate) depth: u32,
    /// Throughput: the weight of all events, over their density.
    pub(crate) beta: Rgb,
    /// The factor (η²) by which refraction has divided radiance so far; Russian roulette must not depend on it.
    pub(crate) eta_scale: f32,
    /// The position of the last event and the density of its direction; `None` after the camera and after delta events,
    /// where no light can be sampled.
    pub(crate) last: Option<(Vec3, f32)>,
    /// True while all events have been delta events: what only the camera sees may still be visible.
    pub(crate) specular: bool,
    /// The path carries a single wavelength.
    pub(crate) is_split: bool,
    /// The media that the ray travels in.
    pub(crate) media: Media,
}

impl PixelIntegrator for Path {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let mut walk = Walk::new(ray, Media::at_start(task.tracer, ray));
        loop {
            let Some((surface, passed)) = walk.media.closest(task.tracer, &walk.ray) else {
                self.escape(&mut walk, task);
                return walk.light;
            };
            walk.beta *= passed;
            task.vertices += 1;
            if !self.interact(&mut walk, &surface, task) {
                return walk.light;
            }
        }
    }

    fn reports_light(&self) -> bool {
        true
    }
}

impl Path {
    /// With multiple importance sampling.
    pub(super) fn new(roulette_depth: u32) -> Path {
        Path { sampling: Sampling::Mis, roulette_depth }
    }

    /// True when light is sampled by both techniques.
    pub(crate) fn is_mis(&self) -> bool {
        self.sampling == Sampling::Mis
    }

    /// The number of scattering events before Russian roulette starts.
    pub(crate) fn roulette_depth(&self) -> u32 {
        self.roulette_depth
    }

    /// The end of a path that leaves the scene.
    pub(crate) fn escape(&self, walk: &mut Walk, task: &mut Task) {
        walk.light += task.seen(walk.beta, walk.is_split) * self.background(task, walk);
    }

    /// What happens to a path at a surface: it collects the light that is emitted there, connects to lights, and goes
    /// on in another direction; false when it ends.
    #[inline]
    fn interact(&self, walk: &mut Walk, surface: &Surface, task: &mut Task) -> bool {
        let wo = -Vec3::from(walk.ray.direction);
        let Some(bsdf) = self.arrive(walk, surface, task) else { return false };
        let from = Vertex { surface, bsdf: &bsdf, wo, media: &walk.media };
        let seen = task.seen(walk.beta, walk.is_split);
        walk.light += seen * self.direct(task, &from, (walk.depth, seen));
        self.scatter(walk, surface, &bsdf, task)
    }

    /// The first part of [`Path::interact`]: collects the light that is emitted here; returns how the surface scatters,
    /// or `None` where the path ends.
    #[inline]
    pub(crate) fn arrive(&self, walk: &mut Walk, surface: &Surface, task: &mut Task) -> Option<Bsdf> {
        self.collect(walk, surface, task);
        if walk.depth >= task.max_depth {
            return None;
        }
        task.sampler.enter(u64::from(walk.depth) + 1);
        let bsdf = walk.media.bsdf(task.scene(), surface, &task.wavelength);
        walk.is_split |= bsdf.splits();
        Some(bsdf)
    }

    /// Collects the light that a surface emits.
    #[inline]
    pub(crate) fn collect(&self, walk: &mut Walk, surface: &Surface, task: &mut Task) {
        walk.light += task.seen(walk.beta, walk.is_split) * self.emitted(task, walk, surface);
    }

    /// The last part of [`Path::interact`]: goes on in another direction, or ends.
    #[inline]
    pub(crate) fn scatter(&self, walk: &mut Walk, surface: &Surface, bsdf: &Bsdf, task: &mut Task) -> bool {
        let u = (task.sampler.next_1d(), task.sampler.next_2d());
        self.scatter_by(walk, surface, bsdf, task, u) && self.survives(walk, || task.sampler.next_1d())
    }

    /// Samples a direction by these random numbers; false where there is none.
    #[inline]
    pub(crate) fn scatter_by(
        &self,
        walk: &mut Walk,
        surface: &Surface,
        bsdf: &Bsdf,
        task: &mut Task,
        (u_choice, u): (f32, Vec2),
    ) -> bool {
        let wo = -Vec3::from(walk.ray.direction);
        let Some(sample) = bsdf.sample(wo, u_choice, u, TransportMode::Radiance) else {
            let vertex = PathVertex::new(VertexKind::Absorption, surface.p);
            task.note_vertex(walk.depth, || (vertex, format!("is absorbed at {}", surface.p)));
            return false;
        };
        walk.scatter(task.scene(), surface, &sample);
        task.note_vertex(walk.depth, || {
            let (kind, how) = match sample.transmits {
                true => (VertexKind::Transmission, "transmitted"),
                false => (VertexKind::Reflection, "scattered"),
            };
            let what = format!("{how} by object {} at {} towards {}", surface.object, surface.p, sample.wi);
            (PathVertex::new(kind, surface.p), what)
        });
        true
    }

    /// Light from infinity that the ray reaches, weighted against light sampling.
    fn background(&self, task: &mut Task, walk: &Walk) -> Rgb {
        let direction = Vec3::from(walk.ray.direction);
        let mut sum = Rgb::BLACK;
        for (index, light) in task.scene().infinite_lights() {
            let found = match walk.last {
                Some((from, _)) => light.le_and_pdf(from, direction),
                None => (light.le(direction), 0.0),
            };
            let seen = self.seen_of(task, walk, (index, light), found);
            task.find(walk.depth + 1, Some(index), task.seen(walk.beta, walk.is_split) * seen);
            sum += seen;
        }
        let light = task.seen(walk.beta, walk.is_split) * sum;
        task.note_vertex(walk.depth, || {
            let vertex = PathVertex { kind: VertexKind::Escape, at: direction, light };
            (vertex, format!("leaves the scene towards {direction}"))
        });
        sum
    }

    /// What a ray that leaves the scene sees of an infinite light of this radiance and density.
    #[inline]
    pub(crate) fn seen_of(
        &self,
        task: &Task,
        walk: &Walk,
        (index, light): (usize, &dyn Light),
        (radiance, light_pdf): (Rgb, f32),
    ) -> Rgb {
        if radiance.is_black() || !task.scene().shows(light, walk.depth, walk.specular) {
            return Rgb::BLACK;
        }
        match walk.last {
            Some((_, pdf)) if !light.is_backdrop() => {
                radiance * self.scattering_weight(pdf, light_pdf * task.lights.probability(index))
            }
            _ => radiance,
        }
    }

    /// Light that the surface itself emits, weighted against light sampling.
    fn emitted(&self, task: &mut Task, walk: &Walk, surface: &Surface) -> Rgb {
        let radiance = task.scene().emission(surface, -Vec3::from(walk.ray.direction));
        if radiance.is_black() {
            return radiance;
        }
        let index = task.scene().light_index_of(surface.object);
        let seen = match (walk.last, index) {
            (Some((from, pdf)), Some(index)) => {
                let light = &task.scene().lights()[index].light;
                let direction = Vec3::from(walk.ray.direction);
                let light_pdf = light.li_pdf_solid_angle(from, direction, Some(surface));
                radiance * self.scattering_weight(pdf, light_pdf * task.lights.probability(index))
            }
            _ => radiance,
        };
        let light = task.seen(walk.beta, walk.is_split) * seen;
        task.find(walk.depth + 1, index, light);
        task.note_vertex(walk.depth, || {
            let vertex = PathVertex { kind: VertexKind::Emitter, at: surface.p, light };
            (vertex, format!("hits a light at {}", surface.p))
        });
        seen
    }

    /// Next-event estimation: samples lights from a vertex, and returns what they send along `wo`. The depth of the vertex
    /// and what the sample sees of it are for the record.
    fn direct(&self, task: &mut Task, from: &Vertex, (depth, seen): (u32, Rgb)) -> Rgb {
        if from.bsdf.is_delta() {
            self.skip_lights(task);
            return Rgb::BLACK;
        }
        let lights = task.lights;
        let chosen = if lights.takes_all() {
            task.sampler.skip(1);
            lights.sample(0.0)
        } else {
            lights.sample(task.sampler.next_1d())
        };
        chosen.fold(Rgb::BLACK, |sum, light| match self.connection(task, light, from) {
            Some(connection) => {
                let found = connection.trace(task);
                connection.note(task, depth, seen * found);
                task.find(depth + 2, Some(light), seen * found);
                sum + found
            }
            None => sum,
        })
    }

    /// Leaves out the random numbers of light samples.
    pub(crate) fn skip_lights(&self, task: &mut Task) {
        task.sampler.skip(self.light_draws(task));
    }

    /// How many random numbers and points light samples take.
    pub(crate) fn light_draws(&self, task: &Task) -> u32 {
        1 + if task.lights.takes_all() { task.lights.sample(0.0).len() as u32 } else { 1 }
    }

    /// Samples one light; `None` if it brings nothing.
    fn connection(&self, task: &mut Task, index: usize, from: &Vertex) -> Option<LightConnection> {
        let Vertex { surface, bsdf, wo, media } = *from;
        let probability = task.lights.probability(index);
        let light = &task.scene().lights()[index].light;
        if probability == 0.0 || (self.sampling == Sampling::Scattering && !light.is_delta()) {
            task.sampler.skip(1);
            return None;
        }
        let u = task.sampler.next_2d();
        let sample = light.sample_li(surface.p, surface.time, u).filter(|sample| !sample.li.is_black())?;
        let (scattered, pdf) = bsdf.eval_and_pdf(wo, sample.wi, TransportMode::Radiance);
        let scattered_light = scattered * sample.li;
        if scattered_light.is_black() {
            return None;
        }
        let light_pdf = sample.pdf_solid_angle * probability;
        let weight = match self.sampling {
            Sampling::Mis if !light.is_delta() => power_heuristic(light_pdf, pdf),
            _ => 1.0,
        };
        Some(LightConnection {
            ray: surface.spawn_to_light(&sample),
            distance: sample.point.map_or(0.0, |point| point.distance(surface.p)),
            n_light: sample.n_light,
            media: media.towards(task.scene(), surface, wo, sample.wi),
            light: scattered_light,
            factor: weight / light_pdf,
        })
    }

    /// MIS weight of light that BSDF sampling has found and light sampling could have found.
    fn scattering_weight(&self, pdf: f32, light_pdf: f32) -> f32 {
        match self.sampling {
            Sampling::Mis => power_heuristic(pdf, light_pdf),
            Sampling::Lights if light_pdf > 0.0 => 0.0,
            _ => 1.0,
        }
    }

    /// Russian roulette by the path's throughput. [Arvo 1990]
    #[inline]
    pub(crate) fn survives(&self, walk: &mut Walk, u: impl FnOnce() -> f32) -> bool {
        if walk.beta.is_black() {
            return false;
        }
        if walk.depth <= self.roulette_depth {
            return true;
        }
        let u = u();
        let survival = (walk.beta.max_channel() * walk.eta_scale).min(0.95);
        if u < survival {
            walk.beta = walk.beta / survival;
            return true;
        }
        // NaN must reach the film, which reports it.
        survival.is_nan()
    }
}

impl Walk {
    /// A path with only its camera ray, which travels in these media.
    pub(crate) fn new(ray: &Ray, media: Media) -> Walk {
        Walk {
            ray: *ray,
            light: Rgb::BLACK,
            depth: 0,
            beta: Rgb::WHITE,
            eta_scale: 1.0,
            last: None,
            specular: true,
            is_split: false,
            media,
        }
    }

    /// Sets up the next ray.
    fn scatter(&mut self, scene: &Scene, surface: &Surface, sample: &BsdfSample) {
        let wo = -Vec3::from(self.ray.direction);
        self.beta *= sample.weight;
        self.depth += 1;
        self.specular &= sample.is_delta;
        self.last = (!sample.is_delta).then_some((surface.p, sample.pdf_solid_angle));
        self.eta_scale *= sample.eta * sample.eta;
        self.media = self.media.towards(scene, surface, wo, sample.wi);
        self.ray = surface.spawn(sample.wi);
    }
}

/// MIS weight of a sample of density `a` against another technique of density `b`. [Veach 1997, eq. 9.17]
#[inline(always)]
pub(crate) fn power_heuristic(a: f32, b: f32) -> f32 {
    // The ratio is used so that squares of large densities do not overflow.
    if a > 0.0 { 1.0 / (1.0 + (b / a) * (b / a)) } else { 0.0 }
}

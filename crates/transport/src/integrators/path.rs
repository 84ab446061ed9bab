//! `path`: path tracing from the camera. At each vertex a light is sampled and the surface's scattering is
//! sampled, and the two are joined by the power heuristic. [Kajiya 1986; Veach 1997, 9.2]

use super::{IntegratorEntry, PixelIntegrator};
use crate::media::Media;
use crate::task::Task;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, BsdfSample, Ray, Scene, Surface, TransportMode};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "path",
        summary: "path tracing: all of the light, by chance, right on average",
        source: "Kajiya 1986",
        parameters: &[
            Parameter {
                name: "sampling",
                summary: "how lights are found: both techniques, weighted (mis), by picking points on lights, or by \
                          scattering alone",
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

pub(super) struct Path {
    sampling: Sampling,
    roulette_depth: u32,
}

/// Where lights are sampled from.
#[derive(Clone, Copy)]
struct Vertex<'a> {
    surface: &'a Surface,
    bsdf: &'a Bsdf,
    wo: Vec3,
    /// On the side of `wo`.
    media: &'a Media,
}

/// How light is found where both ways could find it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sampling {
    Mis,
    Lights,
    Scattering,
}

/// A path while it grows from the camera.
struct Walk {
    ray: Ray,
    /// Scattering events so far.
    depth: u32,
    /// Weight of all of them, over their density.
    beta: Rgb,
    /// What refraction has divided radiance by so far (η²), which survival must not depend on.
    eta_scale: f32,
    /// Where the last event was, and the density of its direction; `None` after the camera and after events
    /// without width, where no light can be sampled.
    last: Option<(Vec3, f32)>,
    /// True while all events have been without width: what only the camera sees may still be seen.
    specular: bool,
    /// It is of one wavelength.
    is_split: bool,
    /// Where the ray goes.
    media: Media,
}

impl PixelIntegrator for Path {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let mut walk = Walk {
            ray: *ray,
            depth: 0,
            beta: Rgb::WHITE,
            eta_scale: 1.0,
            last: None,
            specular: true,
            is_split: false,
            media: Media::at_start(task.tracer, ray),
        };
        let mut sum = Rgb::BLACK;
        loop {
            let Some((surface, passed)) = walk.media.closest(task.tracer, &walk.ray) else {
                return sum + task.seen(walk.beta, walk.is_split) * self.background(task, &walk);
            };
            let direction = Vec3::from(walk.ray.direction);
            walk.beta *= passed;
            sum += task.seen(walk.beta, walk.is_split) * self.emitted(task, &walk, &surface);
            if walk.depth >= task.max_depth {
                return sum;
            }
            task.sampler.enter(u64::from(walk.depth) + 1);
            let bsdf = walk.media.bsdf(task.scene(), &surface, &task.wavelength);
            walk.is_split |= bsdf.splits();
            let from = Vertex { surface: &surface, bsdf: &bsdf, wo: -direction, media: &walk.media };
            sum += task.seen(walk.beta, walk.is_split) * self.direct(task, &from);
            let (u_choice, u) = (task.sampler.next_1d(), task.sampler.next_2d());
            let Some(sample) = bsdf.sample(-direction, u_choice, u, TransportMode::Radiance) else {
                task.note(walk.depth, || format!("is absorbed at {}", surface.p));
                return sum;
            };
            walk.scatter(task.scene(), &surface, &sample);
            task.note(walk.depth, || {
                let kind = if sample.transmits { "transmitted" } else { "scattered" };
                let object = surface.object;
                format!("{kind} by object {object} at {} towards {}", surface.p, sample.wi)
            });
            if !self.survives(&mut walk, task) {
                return sum;
            }
        }
    }
}

impl Path {
    /// With both ways of finding lights.
    pub(super) fn new(roulette_depth: u32) -> Path {
        Path { sampling: Sampling::Mis, roulette_depth }
    }

    /// Light from infinity that the ray meets, weighted against having sampled it.
    fn background(&self, task: &mut Task, walk: &Walk) -> Rgb {
        let direction = Vec3::from(walk.ray.direction);
        task.note(walk.depth, || format!("leaves the scene towards {direction}"));
        let mut sum = Rgb::BLACK;
        for (index, light) in task.scene().lights().iter().enumerate() {
            let radiance = light.light.le(direction);
            if radiance.is_black() || !task.scene().shows(&*light.light, walk.depth, walk.specular) {
                continue;
            }
            sum += match walk.last {
                _ if light.light.is_backdrop() => radiance,
                None => radiance,
                Some((from, pdf)) => {
                    let light_pdf = light.light.li_pdf_solid_angle(from, direction, None);
                    radiance * self.scattering_weight(pdf, light_pdf * task.lights.probability(index))
                }
            };
        }
        sum
    }

    /// Light that the surface itself gives out, weighted against having sampled it.
    fn emitted(&self, task: &mut Task, walk: &Walk, surface: &Surface) -> Rgb {
        let radiance = task.scene().emission(surface, -Vec3::from(walk.ray.direction));
        if radiance.is_black() {
            return radiance;
        }
        task.note(walk.depth, || format!("meets a light at {}", surface.p));
        match (walk.last, task.scene().light_index_of(surface.object)) {
            (Some((from, pdf)), Some(index)) => {
                let light = &task.scene().lights()[index].light;
                let direction = Vec3::from(walk.ray.direction);
                let light_pdf = light.li_pdf_solid_angle(from, direction, Some(surface));
                radiance * self.scattering_weight(pdf, light_pdf * task.lights.probability(index))
            }
            _ => radiance,
        }
    }

    /// Lights sampled from a surface: what they send along `wo`.
    fn direct(&self, task: &mut Task, from: &Vertex) -> Rgb {
        let lights = task.lights;
        let chosen = if lights.takes_all() {
            task.sampler.skip(1);
            lights.sample(0.0)
        } else {
            lights.sample(task.sampler.next_1d())
        };
        if from.bsdf.is_delta() {
            task.sampler.skip(chosen.len() as u32);
            return Rgb::BLACK;
        }
        chosen.fold(Rgb::BLACK, |sum, light| sum + self.light(task, light, from))
    }

    /// One of them.
    fn light(&self, task: &mut Task, index: usize, from: &Vertex) -> Rgb {
        let Vertex { surface, bsdf, wo, media } = *from;
        let probability = task.lights.probability(index);
        let light = &task.scene().lights()[index].light;
        if probability == 0.0 || (self.sampling == Sampling::Scattering && !light.is_delta()) {
            task.sampler.skip(1);
            return Rgb::BLACK;
        }
        let u = task.sampler.next_2d();
        let Some(sample) = light.sample_li(surface.p, surface.time, u) else {
            return Rgb::BLACK;
        };
        let (scattered, pdf) = bsdf.eval_and_pdf(wo, sample.wi, TransportMode::Radiance);
        if scattered.is_black() {
            return Rgb::BLACK;
        }
        let light_pdf = sample.pdf_solid_angle * probability;
        let weight = match self.sampling {
            Sampling::Mis if !light.is_delta() => power_heuristic(light_pdf, pdf),
            _ => 1.0,
        };
        // Beyond the last surface there is no absorbing glass: its boundary would have blocked the ray.
        let distance = sample.point.map_or(0.0, |point| point.distance(surface.p));
        let media = media.towards(task.scene(), surface, wo, sample.wi);
        match media.visible(task.tracer, &surface.spawn_to_light(&sample), distance, sample.n_light) {
            Some(passed) => scattered * sample.li * passed * (weight / light_pdf),
            None => Rgb::BLACK,
        }
    }

    /// Weight of light that scattering has found and light sampling could have found.
    fn scattering_weight(&self, pdf: f32, light_pdf: f32) -> f32 {
        match self.sampling {
            Sampling::Mis => power_heuristic(pdf, light_pdf),
            Sampling::Lights if light_pdf > 0.0 => 0.0,
            _ => 1.0,
        }
    }

    /// Russian roulette by what the path could still carry. [Arvo 1990]
    fn survives(&self, walk: &mut Walk, task: &mut Task) -> bool {
        if walk.beta.is_black() {
            return false;
        }
        if walk.depth <= self.roulette_depth {
            return true;
        }
        let u = task.sampler.next_1d();
        let survival = (walk.beta.max_channel() * walk.eta_scale).min(0.95);
        if u < survival {
            walk.beta = walk.beta / survival;
            return true;
        }
        // What is not a number must reach the film, which reports it.
        survival.is_nan()
    }
}

impl Walk {
    /// The next ray.
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

/// Weight of a sample of density `a` against another way of density `b`. [Veach 1997, eq. 9.17]
fn power_heuristic(a: f32, b: f32) -> f32 {
    // By the ratio, so that squares of large densities do not overflow.
    if a > 0.0 { 1.0 / (1.0 + (b / a) * (b / a)) } else { 0.0 }
}

//! Path tracing from the camera. Each vertex samples a light and samples its BSDF, and the power heuristic combines the two.
//! [Kajiya 1986; Veach 1997, 9.2]

mod fog;
mod last_event;
mod light_connection;
pub(crate) mod sheet;

use crate::media::equiangular::{self, Approach};
use crate::media::interaction::{Interaction, NO_OBJECT};
use crate::media::{Arrival, Media, Travelled};
use crate::sampling::task::{Context, PathVertex, Task, VertexKind};
use crate::techniques::optical_path::OpticalPath;
use crate::walk::Walk;
use crate::walk::segment::Segment;
use crate::walk::through::Through;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::lights::Light;
use bilux_scene::{Ray, Surface, TransportMode};
pub(crate) use last_event::{LastEvent, passes_straight};
use light_connection::LightConnection;
pub(crate) use light_connection::power_heuristic;

#[derive(Clone, Copy)]
pub(crate) struct PathTracing {
    pub(crate) sampling: Sampling,
    pub(crate) roulette_depth: u32,
}

/// A vertex that samples lights.
#[derive(Clone, Copy)]
struct Vertex<'a> {
    at: &'a Interaction,
    wo: Vec3,
    /// The media on the side of `wo`.
    media: &'a Media,
    /// [`Walk::odds`].
    odds: Rgb,
    /// Approach of its ray, where [equiangular points](equiangular) may be.
    approach: Option<Approach>,
    /// [`Walk::panes`].
    panes: u32,
}

/// Sampling of light that both techniques could find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sampling {
    Mis,
    Lights,
    Scattering,
}

/// A path as it grows from the camera.
pub(crate) struct Path {
    pub(crate) walk: Walk,
    /// Light that it has found.
    pub(crate) light: Rgb,
    /// The last event but for those of panes, which are passed straight. `None` after the camera and after other delta events, where no
    /// light can be sampled.
    pub(crate) last: Option<LastEvent>,
}

impl PathTracing {
    /// Follows one path to its end; returns the light that it finds.
    pub(crate) fn trace(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.follow(Path::new(ray, Media::at_start(task.tracer, ray)), task)
    }

    /// Follows a path from where it is.
    #[inline]
    fn follow(&self, mut path: Path, task: &mut Task) -> Rgb {
        loop {
            let (ray, ahead) = path.walk.ahead(task.context.scene, task.sample, TransportMode::Radiance);
            let first = task.tracer.closest(&ray);
            if self.sampling != Sampling::Scattering
                && (!path.walk.leaves_medium || task.context.lights.has_beams())
                && equiangular::is_used_in(task.context.scene)
            {
                self.equiangular(&mut path, (first, ray.t_max), task);
            }
            let (tracer, mode) = (&mut *task.tracer, TransportMode::Radiance);
            let travelled = path.walk.travel((first, ahead), tracer, task.sample, mode, |_| {});
            if let Some(last) = &mut path.last {
                last.pdf *= travelled.passage.survival;
            }
            if !travelled.emitted.is_black() {
                self.glow(&mut path, travelled.emitted, task);
            }
            if matches!(travelled.arrival, Arrival::Escape) {
                self.escape(&mut path, task);
                return path.light;
            }
            task.sample.vertices += 1;
            if !self.interact(&mut path, &travelled, task) {
                return path.light;
            }
        }
    }

    /// With multiple importance sampling.
    pub(crate) fn new(roulette_depth: u32) -> PathTracing {
        PathTracing { sampling: Sampling::Mis, roulette_depth }
    }

    /// True when light is sampled by both techniques.
    pub(crate) fn is_mis(&self) -> bool {
        self.sampling == Sampling::Mis
    }

    /// Collects what media on the way have emitted.
    #[cold]
    fn glow(&self, path: &mut Path, emitted: Rgb, task: &mut Task) {
        let light = task.sample.seen(emitted, path.walk.is_split);
        path.light += light;
        task.sample.find(path.walk.depth + 1, None, path.walk.ray.direction, light, OpticalPath::length);
        task.sample.note_vertex(path.walk.depth, || {
            let at = Vec3::from(path.walk.ray.origin);
            (
                PathVertex { kind: VertexKind::Emitter, at, light },
                "passes a medium that emits light".to_owned(),
            )
        });
    }

    /// The end of a path that leaves the scene.
    pub(crate) fn escape(&self, path: &mut Path, task: &mut Task) {
        path.light += path.walk.seen(task.sample) * self.background(task, path);
    }

    /// Follows a path through an event at a surface or in a medium: it collects the light that is emitted there, connects to
    /// lights, and goes on in another direction; false when it ends.
    #[inline]
    fn interact(&self, path: &mut Path, travelled: &Travelled, task: &mut Task) -> bool {
        let wo = path.walk.wo();
        let Some(at) = self.arrive(path, &travelled.arrival, task) else { return false };
        task.sample.reach(|| at.place(wo));
        let by_walk = travelled.passage.arriving(None);
        let approach = Approach::of(&at, wo, path.walk.leaves_medium, by_walk)
            .filter(|approach| !approach.ray.leaves_medium || task.context.lights.has_beams());
        let panes = path.walk.panes(task.context, at.is_inside());
        let from = Vertex { at: &at, wo, media: &path.walk.media, odds: path.walk.odds, approach, panes };
        let seen = path.walk.seen(task.sample);
        path.light += seen * self.direct(task, &from, (path.walk.depth, seen));
        self.scatter(path, &at, approach, task)
    }

    /// The first part of [`PathTracing::interact`]: collects the light that is emitted here; returns how light scatters here, or
    /// `None` where the path ends.
    #[inline]
    pub(crate) fn arrive(&self, path: &mut Path, arrival: &Arrival, task: &mut Task) -> Option<Interaction> {
        if let Arrival::Surface(surface) = arrival {
            self.collect(path, surface, task);
        }
        let events = path.walk.events().and(matches!(arrival, Arrival::Medium(point) if point.is_inside));
        if !events.are_within(task.context.max_depth) {
            return None;
        }
        task.sample.sampler.enter(u64::from(path.walk.depth) + 1);
        let at = path.walk.media.interaction(task.context.scene, arrival, &task.sample.wavelength)?;
        path.walk.is_split |= at.splits();
        Some(at)
    }

    /// Collects the light that a surface emits.
    #[inline]
    pub(crate) fn collect(&self, path: &mut Path, surface: &Surface, task: &mut Task) {
        path.light += path.walk.seen(task.sample) * self.emitted(task, path, surface);
    }

    /// The last part of [`PathTracing::interact`]: goes on in another direction, or ends.
    #[inline]
    pub(crate) fn scatter(
        &self,
        path: &mut Path,
        at: &Interaction,
        approach: Option<Approach>,
        task: &mut Task,
    ) -> bool {
        let u = (task.sample.sampler.next_1d(), task.sample.sampler.next_2d());
        self.scatter_by(path, (at, approach), task, u)
            && self.survives(path, || task.sample.sampler.next_1d())
    }

    /// Samples a direction by these random numbers; false where there is none.
    #[inline]
    pub(crate) fn scatter_by(
        &self,
        path: &mut Path,
        (at, approach): (&Interaction, Option<Approach>),
        task: &mut Task,
        (u_choice, u): (f32, Vec2),
    ) -> bool {
        let wo = path.walk.wo();
        let p = at.p();
        let Some(sample) = at.sample(wo, u_choice, u, TransportMode::Radiance) else {
            let vertex = PathVertex::new(VertexKind::Absorption, p);
            task.sample.note_vertex(path.walk.depth, || (vertex, format!("is absorbed at {p}")));
            return false;
        };
        let media = path.walk.media;
        path.walk.follow(task.context.scene, at, wo, &media, &sample, TransportMode::Radiance);
        let is_in_medium = at.is_in_medium();
        path.last = match sample.is_delta {
            false => Some(LastEvent { p, pdf: sample.pdf_solid_angle, is_in_medium, approach }),
            true => path.last.filter(|_| sample.transmits && passes_straight(task.context.scene, at, wo)),
        };
        task.sample.note_vertex(path.walk.depth, || {
            let Some(surface) = at.surface() else {
                let what = format!("scattered by a medium at {p} towards {}", sample.wi);
                return (PathVertex::new(VertexKind::Medium, p), what);
            };
            let (kind, how) = match sample.transmits {
                true => (VertexKind::Transmission, "transmitted"),
                false => (VertexKind::Reflection, "scattered"),
            };
            let what = match surface.object {
                NO_OBJECT => format!("received at {p} from {}", sample.wi),
                object => format!("{how} by object {object} at {p} towards {}", sample.wi),
            };
            (PathVertex::new(kind, p), what)
        });
        true
    }

    /// Light from infinity that the ray reaches, weighted against light sampling.
    fn background(&self, task: &mut Task, path: &Path) -> Rgb {
        let direction = Vec3::from(path.walk.ray.direction);
        let mut sum = Rgb::BLACK;
        for (index, light) in task.context.scene.infinite_lights() {
            let found = match path.last {
                Some(last) => light.le_and_pdf(last.p, direction),
                None => (light.le(direction), 0.0),
            };
            let seen = self.seen_of(task.context, path, (index, light), found);
            let light = path.walk.seen(task.sample) * seen;
            let towards = path.walk.ray.direction;
            task.sample.find(path.walk.depth + 1, Some(index), towards, light, |_| f64::INFINITY);
            sum += seen;
        }
        let light = path.walk.seen(task.sample) * sum;
        task.sample.note_vertex(path.walk.depth, || {
            let vertex = PathVertex { kind: VertexKind::Escape, at: direction, light };
            (vertex, format!("leaves the scene towards {direction}"))
        });
        sum
    }

    /// Light that a ray which leaves the scene sees of an infinite light of this radiance and density.
    #[inline]
    pub(crate) fn seen_of(
        &self,
        context: &Context,
        path: &Path,
        (index, light): (usize, &dyn Light),
        (radiance, light_pdf): (Rgb, f32),
    ) -> Rgb {
        if radiance.is_black() || !context.scene.shows(light, path.walk.depth, path.walk.specular) {
            return Rgb::BLACK;
        }
        match path.last {
            Some(last) if !light.is_backdrop() => {
                radiance
                    * self.scattering_weight(last.pdf, light_pdf * context.lights.probability(index, None))
            }
            _ => radiance,
        }
    }

    /// Light that the surface itself emits, weighted against light sampling.
    fn emitted(&self, task: &mut Task, path: &Path, surface: &Surface) -> Rgb {
        let radiance = task.context.scene.emission(surface, path.walk.wo());
        if radiance.is_black() {
            return radiance;
        }
        let index = task.context.scene.light_index_of(surface.object);
        let seen = match (path.last, index) {
            (Some(last), Some(index)) => {
                let light = &task.context.scene.lights()[index].light;
                let direction = Vec3::from(path.walk.ray.direction);
                let often = last.approach.map_or(1.0, |way| 1.0 + way.ratio(task.context.scene, index));
                let light_pdf = light.li_pdf_solid_angle(last.p, direction, Some(surface)) * often;
                let at = (!last.is_in_medium).then_some(last.p);
                radiance
                    * self.scattering_weight(last.pdf, light_pdf * task.context.lights.probability(index, at))
            }
            _ => radiance,
        };
        let light = path.walk.seen(task.sample) * seen;
        let towards = path.walk.ray.direction;
        task.sample.find(path.walk.depth + 1, index, towards, light, |way| way.length_to(surface.p));
        task.sample.note_vertex(path.walk.depth, || {
            let vertex = PathVertex { kind: VertexKind::Emitter, at: surface.p, light };
            (vertex, format!("hits a light at {}", surface.p))
        });
        seen
    }

    /// Next-event estimation: samples lights from a vertex, and returns what they send along `wo`. The depth of the vertex
    /// and what the sample sees of it are for the record.
    fn direct(&self, task: &mut Task, from: &Vertex, (depth, seen): (u32, Rgb)) -> Rgb {
        if from.at.is_delta() || from.media.hide_lights(task.context.scene, from.at) {
            self.skip_lights(task);
            return Rgb::BLACK;
        }
        let lights = &task.context.lights;
        let u = if lights.takes_all() {
            task.sample.sampler.skip(1);
            0.0
        } else {
            task.sample.sampler.next_1d()
        };
        lights.sample(u, from.at.lit_at()).fold(Rgb::BLACK, |sum, light| {
            let u = task.sample.sampler.next_2d();
            sum + self.light_sample(task, light, from, u, (depth, seen))
        })
    }

    /// Light that one light, chosen with this probability, sends along `wo`, from the point that `u` picks. The depth of the
    /// vertex and what the sample sees of it are for the record.
    fn light_sample(
        &self,
        task: &mut Task,
        chosen: (usize, f32),
        from: &Vertex,
        u: Vec2,
        (depth, seen): (u32, Rgb),
    ) -> Rgb {
        let Some(connection) = self.connection(task, chosen, from, u) else { return Rgb::BLACK };
        let (found, panes) = connection.trace(task.tracer);
        connection.note(task.sample, depth, seen * found);
        let Segment { ray, through, .. } = &connection.segment;
        task.sample.find(depth + 2 + panes, Some(chosen.0), ray.direction, seen * found, |way| {
            way.length_by(from.at.p(), ray.direction.into(), through.distance)
        });
        found
    }

    /// Leaves out the random numbers of light samples.
    pub(crate) fn skip_lights(&self, task: &mut Task) {
        task.sample.sampler.skip(task.context.lights.draws());
    }

    /// Samples one light by this random point; `None` if it brings nothing.
    fn connection(
        &self,
        task: &mut Task,
        (index, probability): (usize, f32),
        from: &Vertex,
        u: Vec2,
    ) -> Option<LightConnection> {
        let Vertex { at, wo, media, odds, approach, panes } = *from;
        let light = &task.context.scene.lights()[index].light;
        if probability == 0.0 || (self.sampling == Sampling::Scattering && !light.is_delta()) {
            return None;
        }
        let sample = light.sample_li(at.p(), at.time(), u).filter(|sample| !sample.li.is_black())?;
        let (scattered, pdf) = at.eval_and_pdf(wo, sample.wi, TransportMode::Radiance);
        let scattered_light = scattered * sample.li;
        if scattered_light.is_black() {
            return None;
        }
        let often = approach.map_or(1.0, |approach| 1.0 + approach.ratio(task.context.scene, index));
        let light_pdf = sample.pdf_solid_angle * probability * often;
        let pdf = (self.sampling == Sampling::Mis && !light.is_delta()).then_some(pdf);
        let through = Through {
            media: media.towards(task.context.scene, at, wo, sample.wi),
            distance: sample.point.map(|point| point.distance(at.p())),
            panes,
            seed: task.sample.seed(),
        };
        let segment = Segment { ray: at.spawn_to_light(&sample), n: sample.n_light, through };
        Some(LightConnection { segment, light: scattered_light, light_pdf, pdf, odds })
    }

    /// MIS weight of light that BSDF sampling has found and light sampling could have found.
    fn scattering_weight(&self, pdf: f32, light_pdf: f32) -> f32 {
        match self.sampling {
            Sampling::Mis => power_heuristic(pdf, light_pdf),
            Sampling::Lights if light_pdf > 0.0 => 0.0,
            _ => 1.0,
        }
    }

    /// Russian roulette.
    #[inline]
    pub(crate) fn survives(&self, path: &mut Path, u: impl FnOnce() -> f32) -> bool {
        path.walk.survives(self.roulette_depth, 1.0, u)
    }
}

impl Path {
    /// A path with only its camera ray, which travels in these media.
    pub(crate) fn new(ray: &Ray, media: Media) -> Path {
        Path { walk: Walk::new(ray, Rgb::WHITE, media), light: Rgb::BLACK, last: None }
    }
}

//! A random walk: what every path has while it grows, from whichever end.

pub(crate) mod segment;
pub(crate) mod shadow_rays;
pub(crate) mod through;

use crate::film::limits::Events;
use crate::media::equiangular::{Departure, Equiangular, EquiangularSample};
use crate::media::interaction::Interaction;
use crate::media::{Media, MediumPart, Travelled};
use crate::sampling::task::{Context, SampleState, Task};
use bilux_math::{Rgb, Vec3};
use bilux_scene::media::{Flight, mean};
use bilux_scene::{BsdfSample, Ray, Scene, Surface, Tracer, TransportMode};

/// A path on its way to its next vertex.
#[derive(Clone, Copy)]
pub(crate) struct Walk {
    /// The ray to it.
    pub(crate) ray: Ray,
    /// Scattering events so far.
    pub(crate) depth: u32,
    /// Events in media behind surfaces: all, and those in a row up to here.
    inside: [u32; 2],
    /// Throughput: the weight of all events, over their mean density of walks in all channels.
    pub(crate) beta: Rgb,
    /// The densities of walks in each channel over their mean.
    pub(crate) odds: Rgb,
    /// The factor (η²) by which refraction has divided radiance so far; Russian roulette must not depend on it.
    pub(crate) eta_scale: f32,
    /// True while all events have been delta events: what only the camera sees may still be visible.
    pub(crate) specular: bool,
    /// Whether it carries a single wavelength.
    pub(crate) is_split: bool,
    /// Whether its last vertex is a point of a medium.
    pub(crate) leaves_medium: bool,
    /// The media that the ray travels in.
    pub(crate) media: Media,
}

impl Walk {
    /// One with only its first ray.
    #[inline]
    pub(crate) fn new(ray: &Ray, beta: Rgb, media: Media) -> Walk {
        Walk {
            ray: *ray,
            depth: 0,
            inside: [0; 2],
            odds: Rgb::WHITE,
            beta,
            eta_scale: 1.0,
            specular: true,
            is_split: false,
            leaves_medium: false,
            media,
        }
    }

    /// Throughput as the colour channels see it, up to here.
    #[inline]
    pub(crate) fn seen(&self, sample: &SampleState) -> Rgb {
        sample.seen(self.beta, self.is_split)
    }

    /// Events so far, as far as they limit the path.
    #[inline]
    pub(crate) fn events(&self) -> Events {
        let [inside, in_row] = self.inside;
        Events { counted: self.depth - inside, in_row }
    }

    /// The number of panes through which its next event, which may be behind a surface, is connected with a light: they count against the
    /// depth, since paths that go that way have events there.
    #[inline]
    pub(crate) fn panes(&self, context: &Context, is_inside: bool) -> u32 {
        if !context.scene.has_panes() {
            return 0;
        }
        context.max_depth.saturating_sub(self.events().and(is_inside).counted)
    }

    /// The unit direction to where it comes from.
    #[inline]
    pub(crate) fn wo(&self) -> Vec3 {
        -Vec3::from(self.ray.direction)
    }

    /// Continues from where it came along `wo` through these media.
    #[inline]
    pub(crate) fn follow(
        &mut self,
        scene: &Scene,
        at: &Interaction,
        wo: Vec3,
        media: &Media,
        sample: &BsdfSample,
        mode: TransportMode,
    ) {
        self.beta *= sample.weight;
        self.depth += 1;
        self.inside = match self.inside {
            [all, in_row] if at.is_inside() => [all + 1, in_row + 1],
            [all, _] => [all, 0],
        };
        self.specular &= sample.is_delta;
        self.leaves_medium = at.is_in_medium();
        if mode == TransportMode::Radiance {
            self.eta_scale *= sample.eta * sample.eta;
        }
        self.media = media.towards(scene, at, wo, sample.wi);
        self.ray = at.spawn(sample.wi);
    }

    /// Next ray, as far as it has to be traced, and the flight to the event that the walk has at its end unless a surface is
    /// before: known where its medium is. In milk a walk has hundreds of events and meets no surface for a long time.
    #[inline]
    pub(crate) fn ahead(
        &mut self,
        scene: &Scene,
        sample: &mut SampleState,
        mode: TransportMode,
    ) -> (Ray, Option<Flight>) {
        if !self.leaves_medium {
            return (self.ray, None);
        }
        sample.enter_medium(self.depth, mode);
        self.media.channel = sample.channel;
        let flight = self.media.flight_ahead(scene, &self.ray, self.odds, || sample.sampler.next_1d());
        let event = flight.and_then(|flight| flight.event);
        let t_max = event.map_or(self.ray.t_max, |event| event.distance);
        (Ray { t_max, ..self.ray }, flight)
    }

    /// Travels along its ray to the next event, given the first surface there and [what is ahead](Walk::ahead); `mode` is what it carries. Afterwards its media
    /// are those on the side that it comes from. `visit` is told of each medium that scatters, on the way. What media emit is what it brings to the start of the path.
    #[inline]
    pub(crate) fn travel(
        &mut self,
        (first, ahead): (Option<Surface>, Option<Flight>),
        tracer: &mut Tracer,
        sample: &mut SampleState,
        mode: TransportMode,
        visit: impl FnMut(MediumPart),
    ) -> Travelled {
        let scatters = tracer.scene.scatters();
        // What is ahead has taken these numbers.
        if scatters && (first.is_some() || ahead.is_none()) {
            sample.enter_medium(self.depth, mode);
            self.media.channel = sample.channel;
        }
        let draw = || sample.sampler.next_1d();
        let travelled = self.media.travel(tracer, &self.ray, (first, ahead), self.odds, draw, visit);
        let emitted = self.beta * travelled.emitted;
        self.beta *= travelled.weight;
        if scatters {
            let odds = self.odds * travelled.odds;
            let all = mean(odds);
            (self.beta, self.odds) = (self.beta / all, odds / all);
        }
        Travelled { emitted, ..travelled }
    }

    /// Visits an [equiangular point](crate::media::equiangular) of its ray for each light that is sampled there.
    pub(crate) fn each_equiangular(
        &self,
        task: &mut Task,
        mut visit: impl FnMut(&mut Task, EquiangularSample),
    ) {
        if !self.events().and(false).are_within(task.context.max_depth) {
            return;
        }
        let ray = Departure {
            origin: Vec3::from(self.ray.origin),
            direction: Vec3::from(self.ray.direction),
            leaves_medium: self.leaves_medium,
        };
        task.sample.enter_equiangular(self.depth);
        let u = task.sample.sampler.next_1d();
        let lights = &task.context.lights;
        for (light, probability) in lights.sample(u, None) {
            let (u, u_light) = (task.sample.sampler.next_1d(), task.sample.sampler.next_2d());
            if let Some(points) = Equiangular::new(task.context.scene, light, &ray) {
                let distance = points.sample(u);
                visit(task, EquiangularSample { light, probability, points, distance, u_light });
            }
        }
    }

    /// This walk as if it had an event at this distance, in metres, where [equiangular points](crate::media::equiangular) may be;
    /// `None` where they may not, or where a surface is before it.
    pub(crate) fn in_fog(
        &self,
        first: Surface,
        distance: f32,
        tracer: &mut Tracer,
        sample: &SampleState,
    ) -> Option<(Walk, Travelled)> {
        let mut walk = *self;
        walk.media.channel = sample.channel;
        let travelled = walk.media.travel_to_fog(tracer, &self.ray, first, distance, sample.seed())?;
        walk.beta *= travelled.weight;
        Some((walk, travelled))
    }

    /// Russian roulette by the throughput, after `free` events without; `full` is the throughput's maximum channel at the
    /// beginning. In a medium, whatever has lost nothing goes on: walks through clouds have tens of events, and through milk thousands. [Arvo 1990]
    #[inline]
    pub(crate) fn survives(&mut self, free: u32, full: f32, u: impl FnOnce() -> f32) -> bool {
        if self.beta.is_black() {
            return false;
        }
        if self.depth <= free {
            return true;
        }
        let most = if self.leaves_medium { 1.0 } else { MOST };
        let survival = survival(self.beta, full, self.eta_scale, most);
        if u() < survival {
            self.beta = self.beta / survival;
            return true;
        }
        // NaN must reach the film, which reports it.
        survival.is_nan()
    }
}

/// The highest probability of surviving an event on a surface: between mirrors that lose nothing, walks must end too.
pub(crate) const MOST: f32 = 0.95;

/// The probability of surviving Russian roulette, at `most` this.
#[inline(always)]
pub(crate) fn survival(beta: Rgb, full: f32, eta_scale: f32, most: f32) -> f32 {
    (beta.max_channel() / full * eta_scale).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a walk with this throughput goes on by a number, after an event in a medium or on a surface; and its throughput then.
    fn goes_on(beta: f32, u: f32, leaves_medium: bool) -> Option<f32> {
        let ray = Ray::new([0.0; 3], [0.0, 0.0, 1.0]);
        let mut walk = Walk { depth: 9, leaves_medium, ..Walk::new(&ray, Rgb::grey(beta), Media::AIR) };
        walk.survives(4, 1.0, || u).then_some(walk.beta.g)
    }

    #[test]
    fn in_a_medium_roulette_ends_what_absorption_has_taken_and_no_more() {
        assert_eq!(goes_on(1.0, 1.0f32.next_down(), true), Some(1.0), "nothing was lost");
        assert_eq!(goes_on(0.99, 0.98, true), Some(1.0), "what is left is white again");
        assert_eq!(goes_on(0.99, 0.995, true), None);
        assert_eq!(goes_on(1.0, 0.96, false), None, "between mirrors walks end");
        assert_eq!(goes_on(1.0, 0.94, false), Some(1.0 / MOST));
    }
}

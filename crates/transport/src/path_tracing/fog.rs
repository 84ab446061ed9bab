//! Points of fog on the rays of a path, wherever its walk has its events.

use super::{Path, PathTracing, Vertex};
use crate::media::equiangular::{Approach, EquiangularSample};
use crate::media::interaction::Interaction;
use crate::media::{Arrival, Travelled};
use crate::sampling::task::Task;
use bilux_scene::{Ray, Surface};

impl PathTracing {
    /// Connects the [equiangular points](crate::media::equiangular) of the path's ray with their lights. `first` is the first surface along it, as far as it
    /// has been traced, and `traced` that distance in metres.
    pub(super) fn equiangular(
        &self,
        path: &mut Path,
        (first, traced): (Option<Surface>, f32),
        task: &mut Task,
    ) {
        let walk = path.walk;
        if first.is_none() && traced == walk.ray.t_max {
            return;
        }
        let mut first = first;
        walk.each_equiangular(
            task,
            |task, EquiangularSample { light, probability, distance, u_light, .. }| {
                let light = (light, probability);
                // Walks look no further than to their event.
                first = first.or_else(|| task.tracer.closest(&Ray { t_min: traced, ..walk.ray }));
                let alike = first.and_then(|first| walk.in_fog(first, distance, task.tracer, task.sample));
                let Some((alike, Travelled { arrival: Arrival::Medium(point), passage, .. })) = alike else {
                    return;
                };
                let (at, wo) = (Interaction::Medium(point), alike.wo());
                let approach = Approach::of(&at, wo, walk.leaves_medium, passage.arriving(None));
                let panes = alike.panes(task.context, at.is_inside());
                let from = Vertex { at: &at, wo, media: &alike.media, odds: alike.odds, approach, panes };
                let seen = alike.seen(task.sample);
                path.light += seen * self.light_sample(task, light, &from, u_light, (alike.depth, seen));
            },
        );
    }
}

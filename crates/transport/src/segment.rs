//! The straight line from one vertex of a path to another.

use crate::media::{Media, Passage};
use crate::shadow_rays::ShadowRays;
use bilux_math::Vec3;
use bilux_scene::{Ray, Tracer};

/// A line between two points, or to what is infinitely far away, before it is known whether light passes.
pub(crate) struct Segment {
    /// From one end to the other.
    pub(crate) ray: Ray,
    /// Its length in metres; `None` to what is infinitely far away: beyond the last surface nothing absorbs, since the
    /// boundary of what does would have blocked the ray.
    pub(crate) distance: Option<f32>,
    /// The [normal](bilux_scene::Scene::normal_towards) of the surface at the end of the ray; zero where there is none.
    pub(crate) n: Vec3,
    /// The media at the start of the ray.
    pub(crate) media: Media,
}

impl Segment {
    /// What lies along it; `None` where something blocks it.
    #[inline]
    pub(crate) fn passage(&self, tracer: &mut Tracer) -> Option<Passage> {
        self.media.visible(tracer, &self.ray, self.distance, self.n)
    }

    /// Adds its ray to a list, with what it brings. Where no medium changes light, as `is_clear` says, none is stored.
    #[inline]
    pub(crate) fn list<T>(&self, shadow_rays: &mut ShadowRays<T>, is_clear: bool, contribution: T) {
        let media = (!is_clear).then_some((self.media, self.distance));
        shadow_rays.push(self.ray, self.n, media, contribution);
    }
}

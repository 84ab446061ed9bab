//! The media along a line between two points.

use crate::media::{Media, Passage};
use bilux_math::Vec3;
use bilux_scene::{Ray, Scene, Tracer};

/// Media along a line, to be found with the ray along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Through {
    /// The media at its start.
    pub(crate) media: Media,
    /// Length of the line in metres; `None` to what is infinitely far away: beyond the last surface nothing absorbs, since the
    /// boundary of what does would have blocked the ray.
    pub(crate) distance: Option<f32>,
    /// The number of panes that it may lead through.
    pub(crate) panes: u32,
    /// The seed of the random numbers that estimate what passes media that vary.
    pub(crate) seed: u64,
}

impl Through {
    /// Passage along a ray; `None` where something blocks it. `n` is the [normal](Scene::normal_towards) of the surface that
    /// the ray ends on at parameter 1; zero where there is none.
    #[inline]
    pub(crate) fn visible(&self, tracer: &mut Tracer, ray: &Ray, n: Vec3) -> Option<Passage> {
        if self.is_hidden(tracer.scene, ray) {
            return None;
        }
        self.media.visible(tracer, ray, (self.distance, n), self.panes, self.seed)
    }

    /// True where a surface is certain to block a ray.
    #[inline]
    pub(crate) fn is_hidden(&self, scene: &Scene, ray: &Ray) -> bool {
        self.media.hide(scene, Vec3::from(ray.origin) + Vec3::from(ray.direction) * ray.t_max)
    }

    /// Passage along a ray that no surface is on.
    #[inline]
    pub(crate) fn unoccluded(&self, scene: &Scene, ray: &Ray) -> Passage {
        self.media.unoccluded(scene, ray, self.distance, self.seed)
    }
}

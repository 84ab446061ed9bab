//! The straight line from one vertex of a path to another.

use crate::media::Passage;
use crate::walk::shadow_rays::ShadowRays;
use crate::walk::through::Through;
use bilux_math::Vec3;
use bilux_scene::{Ray, Scene, Tracer};

/// A line between two points, or to what is infinitely far away, before it is known whether light passes.
pub(crate) struct Segment {
    /// From one end to the other.
    pub(crate) ray: Ray,
    /// The [normal](bilux_scene::Scene::normal_towards) of the surface at the end of the ray; zero where there is none.
    pub(crate) n: Vec3,
    /// The media along it.
    pub(crate) through: Through,
}

impl Segment {
    /// Passage along it; `None` where something blocks it.
    #[inline]
    pub(crate) fn passage(&self, tracer: &mut Tracer) -> Option<Passage> {
        self.through.visible(tracer, &self.ray, self.n)
    }

    /// Adds its ray to a list, with what it brings, unless that can bring nothing. Where shadows are [plain](Scene::has_plain_shadows), no
    /// media are stored.
    #[inline]
    pub(crate) fn list<T>(
        &self,
        shadow_rays: &mut ShadowRays<T>,
        scene: &Scene,
        is_plain: bool,
        contribution: T,
    ) {
        if !is_plain && self.through.is_hidden(scene, &self.ray) {
            return;
        }
        shadow_rays.push(self.ray, self.n, (!is_plain).then_some(self.through), contribution);
    }
}

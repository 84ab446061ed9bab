//! Shadow rays of many connections, which are traced together.

use crate::media::Passage;
use crate::walk::through::Through;
use bilux_math::Vec3;
use bilux_scene::{Ray, Tracer};

/// Shadow rays, each with what its connection brings if nothing lies between its ends.
pub(crate) struct ShadowRays<T> {
    rays: Vec<Ray>,
    /// The [normals](bilux_scene::Scene::normal_towards) at their ends; zero where there is no surface.
    normals: Vec<Vec3>,
    contributions: Vec<T>,
    /// The media along each ray; nothing where no medium changes light.
    media: Vec<Through>,
    occluded: Vec<bool>,
}

impl<T> Default for ShadowRays<T> {
    fn default() -> ShadowRays<T> {
        let (rays, normals, contributions) = (Vec::new(), Vec::new(), Vec::new());
        ShadowRays { rays, normals, contributions, media: Vec::new(), occluded: Vec::new() }
    }
}

impl<T> ShadowRays<T> {
    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.normals.clear();
        self.contributions.clear();
        self.media.clear();
    }

    /// Adds a ray that ends on a surface with the normal `n`. All rays come with their media, or none does.
    #[inline]
    pub(crate) fn push(&mut self, ray: Ray, n: Vec3, media: Option<Through>, contribution: T) {
        self.rays.push(ray);
        self.normals.push(n);
        self.media.extend(media);
        self.contributions.push(contribution);
    }

    /// Traces the rays. `add` receives what the unoccluded ones bring and what lies along them, in the order in which
    /// they were added.
    pub(crate) fn trace(&mut self, tracer: &mut Tracer, mut add: impl FnMut(&T, &Passage)) {
        let ShadowRays { rays, normals, contributions, media, occluded } = self;
        occluded.clear();
        occluded.resize(rays.len(), false);
        tracer.all_occluded(rays, |i| normals[i], occluded);
        let has_nested = tracer.scene.has_nested();
        for (i, contribution) in contributions.iter().enumerate() {
            let passed = match (occluded[i], media.get(i)) {
                (false, None) => Passage::CLEAR,
                (false, Some(through)) => through.unoccluded(tracer.scene, &rays[i]),
                // What it hits may separate nothing, or be a pane.
                (true, Some(through)) if has_nested || through.panes > 0 => {
                    // Asked again, and counted once.
                    tracer.counters.rays -= 1;
                    let Some(passed) = through.visible(tracer, &rays[i], normals[i]) else { continue };
                    passed
                }
                (true, _) => continue,
            };
            add(contribution, &passed);
        }
    }
}

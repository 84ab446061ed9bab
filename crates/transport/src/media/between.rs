//! Passages between two points.

use super::Media;
use super::passage::{Passage, behind, draws_along};
use bilux_math::Vec3;
use bilux_scene::{Ray, Scene, Tracer, Wavelength};

impl Media {
    /// Passage along a ray that begins in these media, is `distance` metres long, and may lead through so many panes; `None`
    /// where something blocks it.
    ///
    /// For light from infinity there is no `distance`: beyond the last surface nothing absorbs. `n` is the [normal](Scene::normal_towards) of the
    /// surface that the ray ends on at parameter 1; zero where there is none. Of media that vary it is an estimate, by random numbers of this seed.
    #[inline]
    pub(crate) fn visible(
        &self,
        tracer: &mut Tracer,
        ray: &Ray,
        (distance, n): (Option<f32>, Vec3),
        panes: u32,
        seed: u64,
    ) -> Option<Passage> {
        tracer.ending_on(ray, n, |tracer| self.passed(tracer, ray, distance, (panes, seed)))
    }

    /// Passage along a ray of this length that no surface is on.
    #[inline]
    pub(crate) fn unoccluded(&self, scene: &Scene, ray: &Ray, distance: Option<f32>, seed: u64) -> Passage {
        let Some(distance) = distance else { return Passage::CLEAR };
        let mut draws = draws_along(ray, seed);
        Passage::CLEAR.then(self.passed_between(scene, ray, [0.0, distance], &mut draws))
    }

    #[inline]
    fn passed(
        &self,
        tracer: &mut Tracer,
        ray: &Ray,
        distance: Option<f32>,
        (panes, seed): (u32, u64),
    ) -> Option<Passage> {
        if !tracer.scene.has_nested() {
            if !tracer.occluded(ray) {
                return Some(self.unoccluded(tracer.scene, ray, distance, seed));
            }
            if panes == 0 {
                return None;
            }
            // Asked again, and counted once.
            tracer.counters.rays -= 1;
        }
        let (mut media, mut rest, scene) = (*self, *ray, tracer.scene);
        let (mut draws, direction) = (draws_along(ray, seed), Vec3::from(ray.direction));
        let (length, mut begin, mut passed) = (direction.length(), 0.0, Passage::CLEAR);
        while let Some(surface) = tracer.closest(&rest) {
            let surface = media.arrive(tracer, ray, surface);
            let separates = media.overlap.separates(scene, &surface);
            if separates {
                if passed.panes == panes || !scene.material(&surface).is_pane() {
                    return None;
                }
                let pane = media.bsdf(scene, &surface, &Wavelength::D);
                passed = passed.beyond_pane(pane.straight(-direction / length))?;
            }
            let end = surface.t * length;
            passed = passed.then(media.passed_between(scene, ray, [begin, end], &mut draws));
            if !separates {
                media.cross(scene, &surface, direction);
            }
            (begin, rest) = (end, behind(&rest, &surface));
        }
        let Some(distance) = distance else { return Some(passed) };
        Some(passed.then(media.passed_between(scene, ray, [begin, distance.max(begin)], &mut draws)))
    }
}

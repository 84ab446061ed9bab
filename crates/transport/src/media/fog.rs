//! Points of fog along a ray, wherever a walk would have had its event.

use super::Media;
use super::passage::{Arrival, Passage, Travelled, behind, draws_along};
use crate::media::equiangular;
use crate::media::interaction::MediumPoint;
use bilux_math::Vec3;
use bilux_scene::{Medium, Ray, Scene, Surface, Tracer};

/// The least density of events per metre with which a walk comes to a point that is sampled otherwise. It is a divisor of weights, which are infinite
/// beside a smaller one; a walk has never been there, and next to no light passes to the point.
const RAREST: f32 = 1e-20;

impl Media {
    /// A point of the medium around, which scatters, at this distance in metres along a ray of unit direction.
    #[inline]
    pub(super) fn point(&self, scene: &Scene, medium: &Medium, ray: &Ray, distance: f32) -> MediumPoint {
        let is_inside = !scene.material_of(self.inside).is_interface();
        MediumPoint {
            p: Vec3::from(ray.origin) + Vec3::from(ray.direction) * distance,
            t: distance,
            time: ray.time,
            phase: medium.phase,
            is_inside,
            even: medium.density.is_none().then(|| medium.sigma_t()),
            is_equiangular: equiangular::is_used_inside(scene, medium, is_inside),
        }
    }

    /// As if a walk along a ray of unit direction had an event in a medium that has [equiangular points](equiangular), at this distance in metres. `first`
    /// is the first surface along the ray. `None` where something else is there, a surface before it, or so much fog that nothing passes.
    /// Afterwards these are the media there.
    pub(crate) fn travel_to_fog(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        first: Surface,
        distance: f32,
        seed: u64,
    ) -> Option<Travelled> {
        let (scene, direction) = (tracer.scene, Vec3::from(ray.direction));
        let (mut surface, mut begin, mut passage) = (first, 0.0, Passage::CLEAR);
        let mut draws = draws_along(ray, seed);
        loop {
            if distance < surface.t {
                self.meet(scene, &surface, direction);
                break;
            }
            surface = self.arrive(tracer, ray, surface);
            if self.overlap.separates(scene, &surface) {
                return None;
            }
            passage = passage.then(self.passed_between(scene, ray, [begin, surface.t], &mut draws));
            self.cross(scene, &surface, direction);
            begin = surface.t;
            surface = tracer.closest(&behind(ray, &surface))?;
        }
        let medium = self.medium(scene);
        if !medium.scatters() {
            return None;
        }
        let point = self.point(scene, &medium, ray, distance);
        passage = passage.then(self.passed_between(scene, ray, [begin, distance], &mut draws));
        self.overlap.leave();
        let density = passage.arriving(None);
        let weight = passage.transmittance * medium.sigma_s / density;
        let arrival = Arrival::Medium(point);
        (point.is_equiangular && density >= RAREST).then_some(Travelled {
            arrival,
            weight,
            passage,
            ..Travelled::NOWHERE
        })
    }
}

//! Flights and hidden points in a medium that nothing leaves unseen, known before a ray is traced.

use super::Media;
use super::nested::NONE;
use crate::media::interaction::Interaction;
use bilux_math::{Rgb, Vec3};
use bilux_scene::media::{Flight, MediumEvent, WalkChannel};
use bilux_scene::{Enclosure, Ray, Scene};

impl Media {
    /// The flight along a ray that leaves a point of the medium around, up to its next event, if that is known without the surfaces along
    /// the ray: where nothing leaves the medium unseen. `None` where the point of the event is outside by rounding, and for media that
    /// vary, where a flight that ends at a surface would be followed twice.
    pub(crate) fn flight_ahead(
        &self,
        scene: &Scene,
        ray: &Ray,
        odds: Rgb,
        draw: impl FnMut() -> f32,
    ) -> Option<Flight> {
        let enclosure = scene.enclosure(self.inside)?;
        let medium = self.medium(scene);
        if medium.density.is_some() || medium.glow.is_some() {
            return None;
        }
        let channel = WalkChannel { index: usize::from(self.channel), odds };
        let flight = medium.walk(None, f32::INFINITY, channel, draw);
        let at = |distance: f32| Vec3::from(ray.origin) + Vec3::from(ray.direction) * distance;
        let is_inside = |event: MediumEvent| enclosure.bounds.contains(at(event.distance));
        flight.event.is_some_and(is_inside).then_some(flight)
    }

    /// The boundary of the medium around, if that is a surface which nothing leaves unseen.
    #[inline]
    fn walls<'s>(&self, scene: &'s Scene) -> Option<&'s Enclosure> {
        if self.inside == NONE {
            return None;
        }
        scene.enclosure(self.inside).filter(|enclosure| enclosure.is_solid)
    }

    /// True where a surface is certain to lie between a point in here and this one.
    #[inline]
    pub(crate) fn hide(&self, scene: &Scene, p: Vec3) -> bool {
        self.walls(scene).is_some_and(|walls| !walls.bounds.contains(p))
    }

    /// True where a surface is certain to lie between a vertex in these media and every light.
    #[inline]
    pub(crate) fn hide_lights(&self, scene: &Scene, at: &Interaction) -> bool {
        at.is_in_medium() && self.walls(scene).is_some_and(|walls| !walls.holds_light)
    }
}

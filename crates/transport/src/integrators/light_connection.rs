//! The connection of a camera path's vertex with a point of a light.

use crate::media::Media;
use crate::task::{PathVertex, Task, VertexKind};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Ray;

/// A connection from a vertex to a sample of a light, before it is known whether something lies between.
pub(super) struct LightConnection {
    /// The ray to the light.
    pub(super) ray: Ray,
    /// Its length in metres; 0 for light from infinity, since beyond the last surface there is no absorbing glass: its
    /// boundary would have blocked the ray.
    pub(super) distance: f32,
    /// The normal of the light at the end of the ray.
    pub(super) n_light: Vec3,
    /// The media at the start of the ray.
    pub(super) media: Media,
    /// The light that the vertex would scatter along the path, without the factor.
    pub(super) light: Rgb,
    /// MIS weight over density.
    pub(super) factor: f32,
}

impl LightConnection {
    /// What it brings.
    #[inline]
    pub(super) fn trace(&self, task: &mut Task) -> Rgb {
        match self.media.visible(task.tracer, &self.ray, self.distance, self.n_light) {
            Some(passed) => self.light * self.factor * passed,
            None => Rgb::BLACK,
        }
    }

    /// Records the connection, if it brings light to the sample.
    pub(super) fn note(&self, task: &mut Task, depth: u32, light: Rgb) {
        if light.is_black() {
            return;
        }
        task.note_vertex(depth, || {
            let [origin, direction] = [self.ray.origin, self.ray.direction].map(Vec3::from);
            let (kind, at) = match self.distance {
                0.0 => (VertexKind::DistantLight, direction),
                _ => (VertexKind::LightSample, origin + direction),
            };
            (PathVertex { kind, at, light }, format!("is lit from {at}, which brings {:?}", light.to_array()))
        });
    }
}

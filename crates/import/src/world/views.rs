//! Sizes of the pixels of pictures on what a scene shows.

use crate::output::values::vector;
use bilux_math::transcendental::tan;
use bilux_math::{Aabb, Mat3, Vec3};
use bilux_scene::{Object, SceneBuilder};

/// The finest that a picture is taken to be, in pixels of its height.
const HEIGHT: f32 = 1024.0;
/// Cameras beyond these are not considered.
const CAMERAS: usize = 32;

/// From where a scene is seen.
pub struct Views {
    /// The places of cameras, and the height of a pixel at distance 1.
    cameras: Vec<(Vec3, f32)>,
    /// The size of a pixel if the whole scene fills a picture, for scenes without cameras.
    of_whole: f32,
}

impl Views {
    /// Of a scene that will also have something in this box.
    pub fn of(scene: &SceneBuilder, more: Aabb) -> Views {
        let perspective = scene.cameras.iter().filter(|camera| camera.spec.kind == "perspective");
        let cameras = perspective.take(CAMERAS).map(|camera| {
            let fov = camera.spec.number("fov").unwrap_or(40.0).to_radians();
            (
                vector(&camera.spec, "position").unwrap_or(Vec3::new(0.0, 0.0, 5.0)),
                2.0 * tan(0.5 * fov) / HEIGHT,
            )
        });
        let whole = more.union(scene.bounds(0.0));
        Views { cameras: cameras.collect(), of_whole: whole.extent().length() / HEIGHT }
    }

    /// The size of a pixel on an object whose mesh has these bounds, in lengths of the mesh.
    pub fn pixel_on(&self, object: &Object, bounds: &Aabb) -> f32 {
        let place = object.motion.at(0.0);
        let linear = Mat3::from_mat4(*place.matrix());
        let scales = [linear.x_axis, linear.y_axis, linear.z_axis].map(Vec3::length);
        self.pixel(&place.bounds(bounds)) / scales.into_iter().fold(0.0, f32::max)
    }

    /// The size of a pixel at what is in this box.
    fn pixel(&self, bounds: &Aabb) -> f32 {
        let distance = |from: Vec3| from.distance(from.clamp(bounds.min, bounds.max));
        let nearest = self.cameras.iter().map(|(from, size)| distance(*from) * size).reduce(f32::min);
        // A camera within the box sees some of it from very near, but not all.
        nearest.map_or(self.of_whole, |size| size.max(0.1 * self.of_whole))
    }
}

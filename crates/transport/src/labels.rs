//! The surface that all labels of a pixel describe.
//!
//! Ids, positions, distances, normals, texture coordinates and motion are labels: a mean of them describes nothing that is
//! there. All labels of a pixel come from a single ray, through the centre of the pixel and of the lens, when the shutter
//! opens. It depends on the camera alone: not on seed, samples, filter or integrator. It stops at the first surface that
//! is there for the camera:
//!
//! - at opaque surfaces, and at mirrors and glass like at any other;
//! - at a surface with an opacity mask where its opacity is at least one half;
//! - not at backs that the camera sees through, nor at boundaries of nested media that separate nothing; of those that
//!   coincide, at the one of the stronger medium.

use crate::camera_rays::CameraRays;
use crate::media::Media;
use crate::window::Window;
use bilux_accel::Hit;
use bilux_math::Vec3;
use bilux_scene::{Ray, Surface, Tracer};

/// What a pixel is labelled with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Labelled {
    pub(crate) hit: Hit,
    pub(crate) surface: Surface,
    /// The unit direction of the ray.
    direction: Vec3,
}

impl Labelled {
    /// The shading normal, on the visible side.
    pub(crate) fn normal(&self) -> Vec3 {
        visible_normal(&self.surface, self.direction)
    }
}

/// The shading normal of a surface that a ray of this direction hits, on the side of the ray.
pub(crate) fn visible_normal(surface: &Surface, direction: Vec3) -> Vec3 {
    if surface.n_geom.dot(direction) < 0.0 { surface.n_shade } else { -surface.n_shade }
}

/// The labels of each pixel of a tile; `None` where nothing is visible.
pub(crate) fn labels<'s>(
    eye: &CameraRays<'s>,
    tile: &Window,
    tracer: &mut Tracer<'s>,
) -> Vec<Option<Labelled>> {
    let places = (0..tile.pixels()).map(|i| tile.position(i));
    let rays: Vec<Ray> = places.map(|(x, y)| eye.of_labels(x, y)).collect();
    let mut hits = vec![None; rays.len()];
    tracer.hits(&rays, &mut hits);
    rays.iter().zip(hits).map(|(ray, hit)| labelled(tracer, ray, hit?)).collect()
}

/// The first surface that separates two media, given what the ray hits first.
fn labelled(tracer: &mut Tracer, ray: &Ray, mut hit: Hit) -> Option<Labelled> {
    let direction = Vec3::from(ray.direction);
    let mut surface = tracer.surface(ray, &hit);
    if !tracer.scene.has_nested() {
        return Some(Labelled { hit, surface, direction });
    }
    let mut media = Media::at_start(tracer, ray);
    loop {
        match media.end_or_rest(tracer, ray, surface) {
            Ok(end) => {
                // Of faces that coincide it may be another than the one that was hit first.
                let faces = tracer.all_hits(&Ray { t_min: surface.t, t_max: end.t, ..*ray });
                let hit = faces.into_iter().find(|face| face.primitive() == end.primitive).unwrap_or(hit);
                return Some(Labelled { hit, surface: end, direction });
            }
            Err(rest) => {
                hit = tracer.hit(&rest)?;
                surface = tracer.surface(&rest, &hit);
            }
        }
    }
}

//! Part of a picture that path tracing shades in columns, which costs less.

use super::grid::Grid;
use crate::film::failures::SamplePlace;
use crate::film::window::Window;
use crate::queue::PathQueue;
use crate::sampling::camera_rays::CameraRays;
use crate::schedule::settings::RenderSettings;
use bilux_scene::{Shading, Tracer};

/// The part of the first surfaces, over the pilot's pixels, that path tracing shades in columns; 1 if there are none, and 0 where
/// it has no queue.
pub(super) fn share_in_columns(eye: &CameraRays, film: &RenderSettings) -> f64 {
    let (scene, mut tracer) = (eye.context.scene, Tracer::new(eye.context.scene, false));
    if !PathQueue::takes(scene) {
        return 0.0;
    }
    let grid = Grid::of(film);
    let whole = Window::whole(grid.size[0], grid.size[1]);
    let (mut hits, mut in_columns) = (0u32, 0u32);
    for (x, y) in (0..whole.pixels()).map(|i| grid.pixel(whole.position(i))) {
        let (ray, _) = eye.sample(SamplePlace { x, y, sample: 0 });
        let Some(hit) = tracer.hit(&ray) else { continue };
        let shading = scene.shading(scene.geometry().object_of(&hit));
        let is_any = shading == Shading::General || (shading == Shading::Smooth && !scene.has_clear_media());
        hits += 1;
        in_columns += u32::from(!is_any);
    }
    if hits == 0 { 1.0 } else { f64::from(in_columns) / f64::from(hits) }
}

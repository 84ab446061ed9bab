//! The widths of points and lines for an image of a given size: a few pixels where most of them are.

use crate::builder::SceneBuilder;
use crate::cameras;
use crate::geometry::strokes::StrokeWidths;
use bilux_math::Vec3;

/// The number of vertices that are sampled.
const PLACES: usize = 512;
/// The minimum diameter, in pixels.
const MIN: f32 = 1.5;
/// The maximum diameter of points, and the diameter of lines, as fractions of the image's shorter side.
const LARGE: f32 = 1.0 / 50.0;
const LINE: f32 = 1.0 / 256.0;
/// The diameter of points relative to their mean distance, at which points on a surface cover it.
const COVERING: f32 = 1.3;

/// Sets the widths of points and lines for an image by one of the scene's cameras, with this many columns and rows.
///
/// Does nothing if the scene has widths of its own, or has no points or lines.
pub fn set_stroke_widths(scene: &mut SceneBuilder, camera: &str, size: [u32; 2], time: f32) {
    let [columns, rows] = size.map(|side| side.max(1) as f32);
    let strokes = || scene.objects.iter().filter(|object| object.mesh.stroke_count() > 0);
    if strokes().next().is_none() || scene.stroke_widths != StrokeWidths::default() {
        return;
    }
    let by_name = || scene.cameras.iter().find(|c| c.spec.name == camera);
    let by_number = || camera.parse().ok().and_then(|i: usize| scene.cameras.get(i));
    let Some(spec) = by_name().or_else(by_number).or(scene.cameras.first()) else { return };
    let Ok(camera) = cameras::build(spec, columns / rows) else { return };
    let count: usize = strokes().map(|object| object.mesh.stroke_count()).sum();
    let points: usize = strokes().map(|object| object.mesh.points.len()).sum();
    let step = (count / PLACES).max(1);
    let (mut heights, mut low, mut high) = (Vec::new(), Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut next = 0;
    for object in strokes() {
        let (to_world, mesh) = (object.motion.at(time), &object.mesh);
        let bounds = to_world.bounds(&mesh.bounds());
        (low, high) = (low.min(bounds.min), high.max(bounds.max));
        let vertices = mesh.points.iter().copied().chain(mesh.lines.iter().map(|line| line[0]));
        for vertex in vertices {
            if next == 0 {
                next = step;
                let p =
                    mesh.positions.get(vertex as usize).map(|p| camera.height_at(to_world.point(*p), time));
                heights.extend(p.filter(|height| *height > 0.0 && height.is_finite()));
            }
            next -= 1;
        }
    }
    heights.sort_by(f32::total_cmp);
    let Some(&height) = heights.get(heights.len() / 2) else { return };
    let (pixel, side) = (height / rows, columns.min(rows));
    // As if all of them lay on their bounding box.
    let area = {
        let e = (high - low) / pixel;
        (e.x * e.y + e.y * e.z + e.z * e.x) * 0.7
    };
    let apart = (area / points.max(1) as f32).sqrt();
    let covering = if apart.is_finite() { apart * COVERING } else { MIN };
    scene.stroke_widths = StrokeWidths {
        points: covering.clamp(MIN, (side * LARGE).max(MIN)) * pixel,
        lines: (side * LINE).max(MIN) * pixel,
    };
}

//! A depth for every pixel, and a comparison for every hit.

use crate::canvas::Canvas;
use crate::polygon::corners;
use crate::screen::Screen;
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::TriangleMesh;
use bilux_math::registry::Entry;

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "z-buffer",
        summary: "z-buffer: one depth comparison per pixel and triangle",
        source: "Catmull 1974",
        parameters: &[],
    },
    exact: true,
    run,
};

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    for (index, triangle) in mesh.triangles().iter().enumerate() {
        let Some(polygon) = corners(triangle) else { continue };
        let index = index as u32;
        canvas.counts.pieces += 1;
        canvas.each_pixel(screen.rect(&polygon), |canvas, pixel| {
            if let Some(hit) = canvas.hit(pixel, index) {
                canvas.put_if_nearer(hit, index);
            }
        });
    }
    canvas.finish(0.0)
}

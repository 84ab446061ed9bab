//! The plain painter's algorithm: far triangles first, near ones over them. Wrong wherever one depth per triangle
//! cannot order them: where they are large, intersect, or overlap in a cycle.

use crate::canvas::Canvas;
use crate::polygon::corners;
use crate::screen::Screen;
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, registry::Entry};

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "painter",
        summary: "painter's algorithm: triangles sorted by the depth of their centres; not exact",
        source: "",
        parameters: &[],
    },
    exact: false,
    run,
};

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    let forward = view.axes[2];
    let mut order: Vec<(f64, u32, [DVec3; 3])> = mesh
        .triangles()
        .iter()
        .enumerate()
        .filter_map(|(index, triangle)| {
            let polygon = corners(triangle)?;
            let depth: f64 = polygon.iter().map(|&corner| (corner - screen.eye).dot(forward)).sum();
            Some((depth, index as u32, polygon))
        })
        .collect();
    let mut comparisons = 0;
    order.sort_by(|a, b| {
        comparisons += 1;
        b.0.total_cmp(&a.0)
    });
    canvas.counts.sort_comparisons = comparisons;
    canvas.counts.pieces = order.len() as u64;
    for (_, index, polygon) in order {
        canvas.each_pixel(screen.rect(&polygon), |canvas, pixel| {
            if let Some(hit) = canvas.hit(pixel, index) {
                canvas.put(hit, index);
            }
        });
    }
    canvas.finish(0.0)
}

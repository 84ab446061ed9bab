//! A tree of the polygons' own planes, painted back to front [Fuchs 1980].

use crate::canvas::Canvas;
use crate::partition::{Start, Stop, Tree, draw_piece};
use crate::screen::Screen;
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::TriangleMesh;
use bilux_math::registry::Entry;
use std::time::Instant;

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "bsp-back-to-front",
        summary: "BSP tree of the polygons' planes, painted back to front",
        source: "Fuchs 1980",
        parameters: &[],
    },
    exact: true,
    run,
};

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    let begun = Instant::now();
    let tree = Tree::of_own_planes(mesh, &screen.slack, &mut canvas.counts);
    let build_seconds = begun.elapsed().as_secs_f64();
    tree.walk(screen.eye, Start::Farthest, |stop| {
        match stop {
            Stop::Enter(_) => canvas.counts.sort_comparisons += 1,
            Stop::On(node) => paint(&tree, node, &screen, &mut canvas),
            Stop::Leaf(_) => {}
        }
        true
    });
    canvas.finish(build_seconds)
}

/// Paints what lies on one plane over everything behind it; depth is compared only between hits on the same plane.
fn paint(tree: &Tree, node: u32, screen: &Screen, canvas: &mut Canvas) {
    for piece in tree.pieces_on(node) {
        draw_piece(
            tree,
            piece,
            screen,
            canvas,
            |_, _| true,
            |canvas, hit| canvas.put_first_or_nearer(hit, node),
        );
    }
}

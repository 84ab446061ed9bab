//! A tree of the polygons' own planes, front to back: the first hit in a pixel stays, and what is covered is skipped.

use crate::canvas::{Canvas, NO_OWNER};
use crate::coverage::Coverage;
use crate::partition::{Child, Start, Stop, Tree, draw_piece};
use crate::piece::Piece;
use crate::polygon::corners;
use crate::screen::{Screen, Slack};
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::Culling;
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, registry::Entry};
use std::time::Instant;

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "bsp-front-to-back",
        summary: "the same BSP tree front to back, with a coverage mask and occlusion culling of subtrees",
        source: "Gordon 1991",
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
    let mut drawing = Drawing {
        tree: &tree,
        mesh,
        screen: &screen,
        options,
        coverage: Coverage::new(view.width(), view.height()),
    };
    tree.walk(screen.eye, Start::Nearest, |stop| match stop {
        Stop::Enter(child) => drawing.enter(child, &mut canvas),
        Stop::On(node) => {
            drawing.draw(node, &mut canvas);
            true
        }
        Stop::Leaf(_) => true,
    });
    canvas.finish(build_seconds)
}

struct Drawing<'a> {
    tree: &'a Tree,
    mesh: &'a TriangleMesh,
    screen: &'a Screen<'a>,
    options: &'a VisibilityOptions,
    coverage: Coverage,
}

impl Drawing<'_> {
    /// Whether anything below can still be visible.
    fn enter(&self, child: Child, canvas: &mut Canvas) -> bool {
        if self.options.skip_covered && self.is_covered(child) {
            canvas.counts.skipped_subtrees += 1;
            return false;
        }
        canvas.counts.sort_comparisons += 1;
        true
    }

    /// True when the screen rectangle of a subtree's bounding box has no open pixel.
    fn is_covered(&self, child: Child) -> bool {
        if self.coverage.is_full() {
            return true;
        }
        let Some(hull) = self.tree.hull(child) else { return false };
        self.coverage.covers(self.screen.rect_of_hull(&hull))
    }

    fn draw(&mut self, node: u32, canvas: &mut Canvas) {
        for piece in self.tree.pieces_on(node) {
            if self.is_certainly_back_facing(piece, node) {
                canvas.counts.culled_back_faces += 1;
                continue;
            }
            let coverage = &mut self.coverage;
            let open = |canvas: &Canvas, pixel| [NO_OWNER, node].contains(&canvas.owner(pixel));
            draw_piece(self.tree, piece, self.screen, canvas, open, |canvas, hit| {
                coverage.cover(hit.pixel);
                canvas.put_first_or_nearer(hit, node);
            });
        }
    }

    /// True when the eye's side of the partition plane proves that the ray test would find a back face.
    fn is_certainly_back_facing(&self, piece: &Piece, node: u32) -> bool {
        if self.options.culling != Culling::Back || !self.options.cull_by_partition {
            return false;
        }
        let node = &self.tree.nodes[node as usize];
        let Some(corners) = corners(&self.mesh.triangles()[piece.triangle as usize]) else { return false };
        let (low, high) = node.plane.range(&corners);
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let along = cross.dot(node.plane.normal);
        let eye_side = node.plane.side(self.screen.eye) * along.signum();
        let stray = high.max(-low);
        stray <= node.half && -eye_side > facing_margin(&corners, along.abs(), stray, &self.screen.slack)
    }
}

/// Minimum distance of the eye from a plane for its side to decide which way a triangle along the plane faces.
///
/// The ray test takes the sign of the volume between the eye and the triangle, each corner of which may be
/// `p = stray + radius` away from its position in the plane. That changes a volume (times six) of
/// `distance · double_area` by at most `p·reach·perimeter + 3p²·reach + p³`.
fn facing_margin(corners: &[DVec3; 3], double_area: f64, stray: f64, slack: &Slack) -> f64 {
    let p = stray + slack.radius;
    let reach = slack.reach + p;
    let [a, b, c] = *corners;
    let perimeter = a.distance(b) + b.distance(c) + c.distance(a) + 6.0 * p;
    (p * reach * perimeter + 3.0 * p * p * reach + p * p * p) / double_area
}

//! Warnock's area subdivision: a window in which a single triangle decides everything is drawn; any other window is
//! divided into four, down to single pixels [Warnock 1969].

use crate::canvas::Canvas;
use crate::polygon::{Plane, clip, corners};
use crate::screen::{Rect, Screen};
use crate::{View, VisibilityEntry, VisibilityOptions, VisibilityResult};
use bilux_accel::Culling;
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, registry::Entry};
use std::rc::Rc;

/// Row of [`VISIBILITY`](crate::VISIBILITY).
pub(crate) const ENTRY: VisibilityEntry = VisibilityEntry {
    entry: Entry {
        name: "warnock",
        summary: "Warnock's algorithm: the screen is divided into quarters until one triangle covers a window",
        source: "Warnock 1969",
        parameters: &[],
    },
    exact: true,
    run,
};

fn run(view: &View, mesh: &TriangleMesh, options: &VisibilityOptions) -> VisibilityResult {
    let screen = Screen::new(view, mesh);
    let mut canvas = Canvas::new(view, mesh, options);
    let candidates: Vec<Candidate> = mesh
        .triangles()
        .iter()
        .enumerate()
        .filter_map(|(index, triangle)| Candidate::new(index as u32, &corners(triangle)?, &screen))
        .filter(|candidate| !(options.culling == Culling::Back && candidate.is_certainly_back_facing()))
        .collect();
    canvas.counts.pieces = candidates.len() as u64;
    let all: Rc<[(u32, Cover)]> = (0..candidates.len() as u32).map(|index| (index, Cover::Partly)).collect();
    let mut windows = vec![(screen.whole(), all)];
    while let Some((rect, parent)) = windows.pop() {
        canvas.counts.windows += 1;
        let window = Window::new(rect, &screen);
        let mut inside = window.classify(&parent, &candidates);
        window.drop_hidden(&mut inside, &candidates, &screen, &mut canvas);
        match inside.as_slice() {
            [] => {}
            &[(index, Cover::Whole)] => canvas.fill(rect, candidates[index as usize].triangle),
            &[(index, Cover::Partly)] => draw_one(rect, &candidates[index as usize], &mut canvas),
            several if rect.is_pixel() => draw_pixel(rect, several, &candidates, &mut canvas),
            several => {
                let several: Rc<[(u32, Cover)]> = several.into();
                windows.extend(rect.quarters().map(|part| (part, Rc::clone(&several))));
            }
        }
    }
    canvas.finish(0.0)
}

/// Part of a window that a triangle covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cover {
    /// Possibly some of it.
    Partly,
    /// All of it: the ray of every pixel hits the triangle.
    Whole,
}

/// A triangle as windows see it.
struct Candidate {
    triangle: u32,
    /// The visible part.
    polygon: Vec<DVec3>,
    rect: Rect,
    plane: Plane,
    /// Half the thickness of the plane: how far the triangle's hits may deviate from it.
    half: f64,
    /// The edges on the screen; `None` when the eye is so near to the plane that the ray test might see either side.
    edges: Option<[Edge; 3]>,
    /// True when hits cannot be nearer than the view's minimum distance.
    beyond_near: bool,
    front: bool,
}

/// A function of the direction `(x, y, 1)`, positive inside. The ray test agrees with its sign beyond `margin`.
struct Edge {
    slope: [f64; 2],
    offset: f64,
    margin: f64,
}

impl Candidate {
    fn new(triangle: u32, corners: &[DVec3; 3], screen: &Screen) -> Option<Candidate> {
        let polygon = screen.visible(corners)?.into_owned();
        let rect = screen.rect(&polygon);
        if rect.is_empty() {
            return None;
        }
        let view = screen.view;
        let radius = screen.slack.radius;
        let plane = Plane::of_triangle(corners);
        let (low, high) = plane.range(corners);
        let least = (screen.depth(&polygon).0 - radius) / view.deepest;
        let local = corners.map(|corner| corner - screen.eye);
        let volume = local[0].dot(local[1].cross(local[2]));
        Some(Candidate {
            triangle,
            rect,
            plane,
            half: high.max(-low) + 2.0 * radius,
            edges: edges(&local, volume, screen),
            beyond_near: view.t_min() == 0.0 || least > f64::from(view.t_min()),
            front: volume < 0.0,
            polygon,
        })
    }

    fn is_certainly_back_facing(&self) -> bool {
        self.edges.is_some() && !self.front
    }
}

/// The three edges, if the sign of the volume between eye and triangle is certain. The ray test moves each corner by
/// at most a radius.
fn edges(local: &[DVec3; 3], volume: f64, screen: &Screen) -> Option<[Edge; 3]> {
    let radius = screen.slack.radius;
    let [a, b, c] = *local;
    let doubt = |p: DVec3, q: DVec3| radius * (p.length() + q.length() + radius);
    let normals = [(b, c), (c, a), (a, b)];
    let faces: f64 = normals.iter().map(|(p, q)| p.cross(*q).length()).sum();
    let volume_doubt = radius * (faces + radius * (a.length() + b.length() + c.length() + radius));
    let is_sure = volume.abs() > volume_doubt;
    if !is_sure {
        return None;
    }
    let [right, down, forward] = screen.view.axes;
    let ((left, far_right), (top, bottom)) = (screen.view.columns.whole(), screen.view.rows.whole());
    let longest = DVec3::new(1.0, left.abs().max(far_right.abs()), top.abs().max(bottom.abs())).length();
    Some(normals.map(|(p, q)| {
        let normal = p.cross(q) * volume.signum();
        Edge {
            slope: [normal.dot(right), normal.dot(down)],
            offset: normal.dot(forward),
            margin: doubt(p, q) * longest,
        }
    }))
}

/// A rectangle of pixels and the directions through it.
struct Window {
    rect: Rect,
    x: (f64, f64),
    y: (f64, f64),
    /// Sides of the window, as planes through the eye with the window in front of them.
    sides: [Plane; 4],
}

impl Window {
    fn new(rect: Rect, screen: &Screen) -> Window {
        let [right, down, forward] = screen.view.axes;
        let x = screen.view.columns.span(rect.x.0, rect.x.1);
        let y = screen.view.rows.span(rect.y.0, rect.y.1);
        let normals =
            [right - forward * x.0, forward * x.1 - right, down - forward * y.0, forward * y.1 - down];
        let sides = normals.map(|n| Plane::through(screen.eye, n.try_normalize().unwrap_or(forward)));
        Window { rect, x, y, sides }
    }

    /// Triangles of the parent that may be visible here, and how they cover the window.
    fn classify(&self, parent: &[(u32, Cover)], candidates: &[Candidate]) -> Vec<(u32, Cover)> {
        let look = |&(index, cover): &(u32, Cover)| match cover {
            Cover::Whole => Some((index, cover)),
            Cover::Partly => Some((index, self.cover(&candidates[index as usize])?)),
        };
        parent.iter().filter_map(look).collect()
    }

    fn cover(&self, candidate: &Candidate) -> Option<Cover> {
        if !candidate.rect.overlaps(&self.rect) {
            return None;
        }
        let Some(edges) = &candidate.edges else { return Some(Cover::Partly) };
        let mut whole = candidate.beyond_near;
        for edge in edges {
            let (low, high) = self.range(edge);
            if high < -edge.margin {
                return None;
            }
            whole &= low > edge.margin;
        }
        Some(if whole { Cover::Whole } else { Cover::Partly })
    }

    /// Minimum and maximum of an edge function in the window: at its corners, since it is linear.
    fn range(&self, edge: &Edge) -> (f64, f64) {
        let ends = |slope: f64, (low, high): (f64, f64)| {
            let (a, b) = (slope * low, slope * high);
            (a.min(b), a.max(b))
        };
        let (x, y) = (ends(edge.slope[0], self.x), ends(edge.slope[1], self.y));
        (edge.offset + x.0 + y.0, edge.offset + x.1 + y.1)
    }

    /// Drops what is hidden by the nearest triangle that fills the window.
    fn drop_hidden(
        &self,
        inside: &mut Vec<(u32, Cover)>,
        candidates: &[Candidate],
        screen: &Screen,
        canvas: &mut Canvas,
    ) {
        let centre = screen.view.axes[2]
            + screen.view.axes[0] * (0.5 * (self.x.0 + self.x.1))
            + screen.view.axes[1] * (0.5 * (self.y.0 + self.y.1));
        let nearness = |&&(index, _): &&(u32, Cover)| {
            let Candidate { plane, .. } = &candidates[index as usize];
            -plane.normal.dot(centre) / plane.side(screen.eye)
        };
        let whole = inside.iter().filter(|(_, cover)| *cover == Cover::Whole);
        let Some(&(nearest, _)) = whole.max_by(|a, b| nearness(a).total_cmp(&nearness(b))) else { return };
        let candidate = &candidates[nearest as usize];
        let eye = candidate.plane.side(screen.eye);
        // From within the thickness of a plane, nothing is certainly behind it.
        let is_sided = eye.abs() > candidate.half;
        if !is_sided {
            return;
        }
        let plane = if eye > 0.0 { candidate.plane } else { candidate.plane.flipped() };
        inside.retain(|&(index, _)| {
            canvas.counts.sort_comparisons += u64::from(index != nearest);
            index == nearest || !self.hides(&plane, candidate.half, &candidates[index as usize], screen)
        });
    }

    /// True when no hit of a triangle in this window is in front of a plane, or within its thickness.
    fn hides(&self, plane: &Plane, half: f64, behind: &Candidate, screen: &Screen) -> bool {
        if plane.range(&behind.polygon).1 < -half {
            return true;
        }
        let part = self
            .sides
            .iter()
            .fold(behind.polygon.clone(), |part, side| clip(&part, side, -screen.slack.radius));
        plane.range(&part).1 < -half
    }
}

/// Draws the only triangle of a window.
fn draw_one(rect: Rect, candidate: &Candidate, canvas: &mut Canvas) {
    canvas.each_pixel(rect.intersection(&candidate.rect), |canvas, pixel| {
        if let Some(hit) = canvas.hit(pixel, candidate.triangle) {
            canvas.put(hit, candidate.triangle);
        }
    });
}

/// Draws the triangles of a window that cannot be divided further, where depth decides.
fn draw_pixel(rect: Rect, inside: &[(u32, Cover)], candidates: &[Candidate], canvas: &mut Canvas) {
    canvas.each_pixel(rect, |canvas, pixel| {
        for &(index, _) in inside {
            let triangle = candidates[index as usize].triangle;
            if let Some(hit) = canvas.hit(pixel, triangle) {
                canvas.put_if_nearer(hit, triangle);
            }
        }
    });
}

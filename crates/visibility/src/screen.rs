//! Conservative bounds of polygons on the screen.

use crate::polygon::{Plane, clip, corners};
use crate::view::View;
use bilux_accel::Ray;
use bilux_accel::TriangleMesh;
use bilux_accel::triangle::PreparedRay;
use bilux_math::DVec3;

/// Maximum deviation of the ray test from the triangles that it is given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slack {
    /// Every hit, and every vertex as the test sees it, lies within a ball of this radius around a point of
    /// the triangle: the lemma of [`bilux_accel::triangle`] on every axis, hence √3 of its bound and less than two.
    pub(crate) radius: f64,
    /// No vertex is farther from the eye.
    pub(crate) reach: f64,
}

/// A view, for triangles of a mesh.
#[derive(Debug)]
pub(crate) struct Screen<'a> {
    pub(crate) view: &'a View,
    pub(crate) eye: DVec3,
    pub(crate) slack: Slack,
    /// Region in front of the eye and within the rectangle of pixel centres.
    frustum: [Plane; 5],
}

/// Pixels from a first column and row up to, but not including, an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rect {
    pub(crate) x: (usize, usize),
    pub(crate) y: (usize, usize),
}

impl Rect {
    pub(crate) const EMPTY: Rect = Rect { x: (0, 0), y: (0, 0) };

    pub(crate) fn is_empty(&self) -> bool {
        self.x.0 >= self.x.1 || self.y.0 >= self.y.1
    }

    pub(crate) fn is_pixel(&self) -> bool {
        self.x.1 - self.x.0 == 1 && self.y.1 - self.y.0 == 1
    }

    pub(crate) fn intersection(&self, other: &Rect) -> Rect {
        let common = |a: (usize, usize), b: (usize, usize)| (a.0.max(b.0), a.1.min(b.1));
        Rect { x: common(self.x, other.x), y: common(self.y, other.y) }
    }

    /// Four quarters of it, or two halves where it is one pixel wide or high.
    pub(crate) fn quarters(&self) -> impl Iterator<Item = Rect> {
        let halves = |(first, end): (usize, usize)| {
            let middle = first + (end - first) / 2;
            [(first, middle), (middle, end)]
        };
        let (columns, rows) = (halves(self.x), halves(self.y));
        let parts = rows.into_iter().flat_map(move |y| columns.map(|x| Rect { x, y }));
        parts.filter(|part| !part.is_empty())
    }

    pub(crate) fn overlaps(&self, other: &Rect) -> bool {
        self.x.0 < other.x.1 && other.x.0 < self.x.1 && self.y.0 < other.y.1 && other.y.0 < self.y.1
    }
}

/// A polygon on the screen.
#[derive(Clone, Debug)]
pub(crate) struct Footprint {
    /// The pixels whose rays may hit it.
    pub(crate) rect: Rect,
    /// Minimum and maximum depth along the view's axis, of the visible part.
    pub(crate) depth: (f64, f64),
    /// Corners on the screen one unit in front of the eye; `None` when the polygon comes too near to the eye.
    pub(crate) outline: Option<Outline>,
}

/// Corners on the screen; every hit is within `blur` of their hull.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    corners: Vec<[f64; 2]>,
    blur: f64,
}

impl<'a> Screen<'a> {
    pub(crate) fn new(view: &'a View, mesh: &TriangleMesh) -> Screen<'a> {
        let toward = Ray::new(view.eye(), [0.0, 0.0, 1.0]);
        let pad = PreparedRay::new(&toward).map_or(f32::INFINITY, |ray| ray.pad(&mesh.bounds()));
        let eye = view.eye_point();
        let reach = mesh.triangles().iter().filter_map(corners).flatten();
        let reach = reach.map(|corner| corner.distance_squared(eye)).fold(0.0, f64::max).sqrt();
        let [right, down, forward] = view.axes;
        let ((left, far_right), (top, bottom)) = (view.columns.whole(), view.rows.whole());
        let normals = [
            right - forward * left,
            forward * far_right - right,
            down - forward * top,
            forward * bottom - down,
            forward,
        ];
        let frustum = normals.map(|n| Plane::through(eye, n.try_normalize().unwrap_or(forward)));
        Screen { view, eye, slack: Slack { radius: 2.0 * f64::from(pad), reach }, frustum }
    }

    /// The pixels whose rays may hit a convex polygon; empty when it cannot be visible.
    pub(crate) fn rect(&self, polygon: &[DVec3]) -> Rect {
        match self.visible(polygon) {
            Some(part) => self.rect_of_visible(&part),
            None => Rect::EMPTY,
        }
    }

    /// The pixels whose rays may hit anything within the hull of some points.
    pub(crate) fn rect_of_hull(&self, points: &[DVec3]) -> Rect {
        if self.frustum.iter().any(|plane| plane.range(points).1 < -self.slack.radius) {
            return Rect::EMPTY;
        }
        self.rect_of_visible(points)
    }

    /// The footprint of a convex polygon on the screen; `None` when it cannot be visible.
    pub(crate) fn footprint(&self, polygon: &[DVec3]) -> Option<Footprint> {
        let part = self.visible(polygon)?;
        let rect = self.rect_of_visible(&part);
        if rect.is_empty() {
            return None;
        }
        let depth = self.depth(&part);
        Some(Footprint { rect, depth, outline: self.outline(&part, depth.0) })
    }

    /// The pixels of the whole view.
    pub(crate) fn whole(&self) -> Rect {
        Rect { x: (0, self.view.width()), y: (0, self.view.height()) }
    }

    /// The part of a polygon that rays of the view may hit.
    pub(crate) fn visible<'p>(&self, polygon: &'p [DVec3]) -> Option<std::borrow::Cow<'p, [DVec3]>> {
        let mut part = std::borrow::Cow::Borrowed(polygon);
        for plane in &self.frustum {
            let (low, high) = plane.range(&part);
            if high < -self.slack.radius {
                return None;
            }
            if low < -self.slack.radius {
                part = clip(&part, plane, -self.slack.radius).into();
            }
        }
        (!part.is_empty()).then_some(part)
    }

    /// Minimum and maximum depth along the view's axis.
    pub(crate) fn depth(&self, polygon: &[DVec3]) -> (f64, f64) {
        self.frustum[4].range(polygon)
    }

    /// Bounds of the projected balls around the corners. The hull of the balls contains every hit, and projection
    /// preserves hulls, as long as no ball reaches the eye's plane.
    fn rect_of_visible(&self, part: &[DVec3]) -> Rect {
        let radius = self.slack.radius;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for &corner in part {
            let [x, y, z] = self.to_camera(corner);
            let is_ahead = z > 2.0 * radius;
            if !is_ahead {
                return self.whole();
            }
            let (near, far) = ((z - radius).recip(), (z + radius).recip());
            for (axis, position) in [x, y].into_iter().enumerate() {
                let (least, most) = (position - radius, position + radius);
                low[axis] = low[axis].min(least * if least < 0.0 { near } else { far });
                high[axis] = high[axis].max(most * if most > 0.0 { near } else { far });
            }
        }
        let (columns, rows) = (&self.view.columns, &self.view.rows);
        Rect { x: columns.between(low[0], high[0]), y: rows.between(low[1], high[1]) }
    }

    fn outline(&self, part: &[DVec3], nearest: f64) -> Option<Outline> {
        let radius = self.slack.radius;
        let is_ahead = nearest > 2.0 * radius;
        if !is_ahead {
            return None;
        }
        let corners: Vec<[f64; 2]> = part
            .iter()
            .map(|&corner| {
                let [x, y, z] = self.to_camera(corner);
                [x / z, y / z]
            })
            .collect();
        // A ball of radius r at depth z and slope s projects within r (1 + |s|) / (z − r) of its centre.
        let steepest = corners.iter().map(|[x, y]| x.abs() + y.abs()).fold(0.0, f64::max);
        Some(Outline { corners, blur: 2.0 * radius * (1.0 + steepest) / (nearest - radius) })
    }

    fn to_camera(&self, point: DVec3) -> [f64; 3] {
        self.view.axes.map(|axis| axis.dot(point - self.eye))
    }
}

impl Outline {
    /// True when no ray can hit both: all of one lies beyond some edge of the other.
    pub(crate) fn is_apart_from(&self, other: &Outline) -> bool {
        self.has_edge_against(other) || other.has_edge_against(self)
    }

    fn has_edge_against(&self, other: &Outline) -> bool {
        let Some(&last) = self.corners.last() else { return false };
        let mut from = last;
        self.corners.iter().any(|&to| {
            let (nx, ny) = (from[1] - to[1], to[0] - from[0]);
            from = to;
            let along = |[x, y]: [f64; 2]| nx * x + ny * y;
            let extent = |corners: &[[f64; 2]]| {
                corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &corner| {
                    (low.min(along(corner)), high.max(along(corner)))
                })
            };
            let ((low, high), (other_low, other_high)) = (extent(&self.corners), extent(&other.corners));
            let blur = (self.blur + other.blur) * (nx.abs() + ny.abs());
            other_low - high > blur || low - other_high > blur
        })
    }
}

//! Edges, each sampled once.

use crate::curves::{Accuracy, Curve, curve, sampled};
use crate::part21::Table;
use crate::structure::axes::point;
use bilux_math::DVec3;

/// An edge as its instance describes it.
pub(super) struct Edge {
    ends: [DVec3; 2],
    /// Curve of the edge, with the parameters of both ends; `None` for a line between them.
    along: Option<(Box<dyn Curve>, [f64; 2])>,
}

/// The position of a VERTEX_POINT.
pub(super) fn vertex(table: &Table, id: u64) -> Option<DVec3> {
    point(table, table.part(id, "VERTEX_POINT")?.reference(1)?)
}

impl Edge {
    /// `unit` is that of angles.
    pub(super) fn read(table: &Table, id: u64, unit: f64) -> Option<Edge> {
        let values = table.simple(id)?;
        let (first, second) = (values.reference(1)?, values.reference(2)?);
        let ends = [vertex(table, first)?, vertex(table, second)?];
        if table.kind(id) != b"EDGE_CURVE" {
            return Some(Edge { ends, along: None });
        }
        let curve = curve(table, values.reference(3)?, unit)?;
        let is_forward = values.flag(4).unwrap_or(true);
        let is_loop = first == second || ends[0] == ends[1];
        let along = parameters(&*curve, ends, is_forward, is_loop);
        Some(Edge { ends, along: along.map(|along| (curve, along)) })
    }

    /// The bytes that it takes.
    pub(super) fn size(&self) -> usize {
        64 + self.along.as_ref().map_or(0, |(curve, _)| curve.size())
    }

    /// A few points, to find out how large the model is.
    pub(super) fn some_points(&self) -> Vec<DVec3> {
        let mut points = self.ends.to_vec();
        if let Some((curve, [from, to])) = &self.along {
            let at = |i: usize| from + (to - from) * i as f64 / 4.0;
            let [start, end] = curve.range();
            points.extend((1..4).map(|i| curve.point(at(i).clamp(start, end))));
        }
        points
    }

    /// Points of the edge from its first vertex to its second, with both.
    pub(super) fn points(&self, accuracy: Accuracy) -> Vec<DVec3> {
        let Some((curve, [from, to])) = &self.along else { return self.ends.to_vec() };
        let mut points = sampled(&**curve, *from, *to, accuracy);
        let last = points.len() - 1;
        // Vertices are exact, and all edges at one share it.
        (points[0], points[last]) = (self.ends[0], self.ends[1]);
        points.retain(|p| p.is_finite());
        points
    }
}

/// Ends that are closer than this to each other, compared with the curve, are those of a short edge rather than of a whole turn.
const SHORT: f64 = 1e-6;

/// The parameters of the ends of an edge on its curve; `None` if the edge is too short to tell.
fn parameters(curve: &dyn Curve, ends: [DVec3; 2], is_forward: bool, is_loop: bool) -> Option<[f64; 2]> {
    let [first, last] = curve.range();
    let (start, end) = if is_forward { (first, last) } else { (last, first) };
    let period = curve.period();
    if first.is_finite() {
        // Most edges take all of their curve.
        let near = SHORT * curve.point(first).distance(curve.point(0.5 * (first + last)));
        let fits = |t: f64, p: DVec3| curve.point(t).distance(p) <= near;
        if fits(start, ends[0]) && fits(end, ends[1]) && (is_loop || period.is_none()) {
            return Some([start, end]);
        }
    }
    let from = curve.parameter(ends[0]);
    let Some(period) = period else {
        let to = curve.parameter(ends[1]);
        return (from != to && from.is_finite() && to.is_finite()).then_some([from, to]);
    };
    if is_loop {
        return Some([from, if is_forward { from + period } else { from - period }]);
    }
    let to = curve.parameter(ends[1]);
    let turn = if is_forward { (to - from).rem_euclid(period) } else { -(from - to).rem_euclid(period) };
    let is_short = period - turn.abs() <= SHORT * period || turn.abs() <= f64::EPSILON * period;
    (!is_short && turn.is_finite()).then_some([from, from + turn])
}

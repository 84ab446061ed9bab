//! Closed lines in the parameters of a surface.

use super::corner::Corner;
use crate::surfaces::{Pole, Surface};
use bilux_math::{DVec2, DVec3};

/// A closed line. On a surface that is closed itself, it may end whole periods away from its start.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) corners: Vec<Corner>,
    /// From the start to the start after one round.
    pub(super) turn: DVec2,
}

/// The lines at a pole between two neighbours have this many pieces for a whole turn.
const PIECES: f64 = 32.0;

/// Tolerance for a whole period, as a part of it.
const NEAR: f64 = 1e-6;

impl Path {
    /// The path of points, with the surface on its left; `near` is how close to a pole a point counts as one. `None` if all do.
    pub(super) fn new(surface: &dyn Surface, points: &[DVec3], near: f64) -> Option<Path> {
        let poles = surface.poles();
        let pole_at = |p: DVec3| poles.iter().find(|pole| pole.point.distance(p) <= near).copied();
        let start = points.iter().position(|&p| pole_at(p).is_none())?;
        let first = surface.parameters(points[start], None);
        let mut walk =
            Walk { surface, corners: vec![Corner { at: first, point: points[start] }], pole: None };
        for i in 1..points.len() {
            let p = points[(start + i) % points.len()];
            match pole_at(p) {
                Some(pole) => walk.pole = Some(pole),
                None => walk.go(p),
            }
        }
        walk.go(points[start]);
        let mut corners = walk.corners;
        let end = corners.pop()?;
        let mut turn = end.at - first;
        let periods = surface.periods();
        for axis in 0..2 {
            // Of surfaces that are not closed, a line returns to where it was.
            turn[axis] = periods[axis].map_or(0.0, |period| (turn[axis] / period).round() * period);
        }
        Some(Path { corners, turn })
    }

    /// The mean of its coordinates along an axis.
    pub(super) fn mean(&self, axis: usize) -> f64 {
        self.corners.iter().map(|corner| corner.at[axis]).sum::<f64>() / self.corners.len() as f64
    }

    pub(super) fn reversed(mut self) -> Path {
        self.corners.reverse();
        // The corners after the first one are those of the round before.
        Path { turn: -self.turn, corners: self.corners }
    }

    pub(super) fn shift(&mut self, by: DVec2) {
        self.corners.iter_mut().for_each(|corner| *corner = corner.moved(by));
    }
}

struct Walk<'a> {
    surface: &'a dyn Surface,
    corners: Vec<Corner>,
    /// The pole that lies between the last corner and the next.
    pole: Option<Pole>,
}

impl Walk<'_> {
    /// Goes to a point, by the shorter way around a closed surface.
    fn go(&mut self, p: DVec3) {
        let last = self.corners[self.corners.len() - 1].at;
        let mut at = self.surface.parameters(p, Some(last));
        let periods = self.surface.periods();
        for axis in 0..2 {
            if let Some(period) = periods[axis] {
                at[axis] += ((last[axis] - at[axis]) / period).round() * period;
            }
        }
        if let Some(pole) = self.pole.take() {
            at = self.around(pole, last, at);
        }
        self.corners.push(Corner { at, point: p });
    }

    /// Goes along the line of a pole, the way that has the surface on its left.
    fn around(&mut self, pole: Pole, last: DVec2, mut at: DVec2) -> DVec2 {
        let axis = pole.along;
        let is_low = pole.at < last[1 - axis];
        let sign = if is_low == (axis == 0) { 1.0 } else { -1.0 };
        let mut way = at[axis] - last[axis];
        let mut pieces = 1.0;
        if let Some(period) = self.surface.periods()[axis] {
            way = sign * (sign * way).rem_euclid(period);
            if way.abs() > (1.0 - NEAR) * period {
                way = 0.0;
            }
            pieces = (PIECES * way.abs() / period).ceil().max(1.0);
        }
        at[axis] = last[axis] + way;
        for i in 0..=pieces as usize {
            let mut here = DVec2::splat(pole.at);
            here[axis] = last[axis] + way * i as f64 / pieces;
            self.corners.push(Corner { at: here, point: pole.point });
        }
        at
    }
}

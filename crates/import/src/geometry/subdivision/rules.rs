//! Rules that make the points of the next level.

use bilux_math::DVec3;
use bilux_math::transcendental::cos_f64;
use std::f64::consts::TAU;
use std::ops::{Add, Mul};

/// Scheme by which a surface follows from its cage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Of any polygons, smooth. [Catmull 1978]
    CatmullClark,
    /// Of triangles, smooth. [Loop 1987]
    Loop,
    /// Of any polygons, which stay as they are.
    Bilinear,
}

impl Scheme {
    /// All schemes, by name.
    pub const ALL: [(&str, Scheme); 3] =
        [("catmull-clark", Scheme::CatmullClark), ("loop", Scheme::Loop), ("bilinear", Scheme::Bilinear)];

    /// The scheme with this name.
    pub fn named(name: &str) -> Option<Scheme> {
        Scheme::ALL.iter().find(|(known, _)| *known == name).map(|(_, scheme)| *scheme)
    }

    /// The name of the scheme.
    pub fn name(self) -> &'static str {
        Scheme::ALL.iter().find(|(_, scheme)| *scheme == self).map_or("", |(name, _)| name)
    }
}

/// Value that is smoothed: a position and a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Value {
    pub(super) position: DVec3,
    pub(super) colour: DVec3,
}

impl Add for Value {
    type Output = Value;
    fn add(self, other: Value) -> Value {
        Value { position: self.position + other.position, colour: self.colour + other.colour }
    }
}

impl Mul<f64> for Value {
    type Output = Value;
    fn mul(self, factor: f64) -> Value {
        Value { position: self.position * factor, colour: self.colour * factor }
    }
}

/// Values of neighbours: their sum and how many there are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    pub(super) value: Value,
    pub(super) count: f64,
}

impl Sum {
    pub(super) fn add(&mut self, value: Value) {
        *self = Sum { value: self.value + value, count: self.count + 1.0 };
    }
}

/// Ring of neighbours around a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ring {
    /// The points at the other ends of its edges.
    pub(super) edges: Sum,
    /// The middles of its polygons.
    pub(super) faces: Sum,
    /// The points opposite in its polygons, of those with four corners.
    pub(super) opposite: Sum,
    /// The points at the other ends of edges that are sharp.
    pub(super) sharp: Sum,
    /// Points at the other ends of edges that are still sharp at the next level.
    pub(super) sharper: Sum,
    /// The sharpness of those that are not, in total, and how many there are.
    pub(super) fading: (f64, f64),
    /// Sharpness of the point itself.
    pub(super) sharpness: f64,
}

impl Ring {
    /// The point at the next level. Between sharp and smooth it is a blend of both. [DeRose 1998, section 3]
    pub(super) fn moved(&self, scheme: Scheme, own: Value) -> Value {
        if scheme == Scheme::Bilinear || self.edges.count == 0.0 {
            return own;
        }
        let [now, next] = [(self.sharp, self.sharpness > 0.0), (self.sharper, self.sharpness > 1.0)]
            .map(|(sharp, is_corner)| self.by(sharp, is_corner, 0.125, || self.smooth(scheme, own), own));
        let own_fading =
            if self.sharpness > 0.0 && self.sharpness < 1.0 { (self.sharpness, 1.0) } else { (0.0, 0.0) };
        let (sum, count) = (self.fading.0 + own_fading.0, self.fading.1 + own_fading.1);
        let share = if count > 0.0 { sum / count } else { 0.0 };
        now * share + next * (1.0 - share)
    }

    /// Limit of the point; on a crease each of its neighbours has the weight `side`.
    pub(super) fn limit(&self, scheme: Scheme, own: Value, side: f64) -> Value {
        if scheme == Scheme::Bilinear || self.edges.count == 0.0 {
            return own;
        }
        self.by(self.sharp, self.sharpness > 0.0, side, || self.smooth_limit(scheme, own), own)
    }

    /// The rule for this many sharp edges: none or one is smooth, two are a crease, more a corner.
    fn by(&self, sharp: Sum, is_corner: bool, side: f64, smooth: impl Fn() -> Value, own: Value) -> Value {
        match sharp.count {
            _ if is_corner => own,
            count if count < 2.0 => smooth(),
            2.0 => own * (1.0 - 2.0 * side) + sharp.value * side,
            _ => own,
        }
    }

    fn smooth(&self, scheme: Scheme, own: Value) -> Value {
        let n = self.edges.count;
        if scheme == Scheme::Loop {
            return self.edges.blended(own, beta(n));
        }
        // (Q + 2R + (n - 3) S) / n, where the middles of edges in R have half of S. [Catmull 1978]
        let faces = self.faces.value * (1.0 / (self.faces.count.max(1.0) * n));
        faces + self.edges.value * (1.0 / (n * n)) + own * ((n - 2.0) / n)
    }

    fn smooth_limit(&self, scheme: Scheme, own: Value) -> Value {
        let n = self.edges.count;
        if scheme == Scheme::Loop {
            return self.edges.blended(own, 1.0 / (n + 3.0 / (8.0 * beta(n))));
        }
        // Of four-sided polygons, which all are after one level. [Halstead 1993, appendix A]
        (own * (n * n) + self.edges.value * 4.0 + self.opposite.value) * (1.0 / (n * (n + 5.0)))
    }
}

impl Sum {
    /// A point blended with its neighbours, each weighted by `part`.
    fn blended(&self, own: Value, part: f64) -> Value {
        own * (1.0 - self.count * part) + self.value * part
    }
}

/// The weight of each neighbour for this number of them. [Loop 1987]
fn beta(count: f64) -> f64 {
    let middle = 0.375 + 0.25 * cos_f64(TAU / count);
    (0.625 - middle * middle) / count
}

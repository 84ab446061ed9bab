//! Curves as ribbons that face the ray: hair, grass, threads.

use super::rounding::{outwards, wide};
use crate::ray::Ray;
use crate::triangle::Crossing;
use bilux_math::glam::DVec3;

/// A piece of a cubic Bézier curve, rendered as a ribbon that turns to face every ray: the right model for what is
/// too thin for its roundness to be visible. In a hit, `u` is the parameter of the curve and `v` the position across
/// the ribbon, 0..=1; both sides are front. A ray that leaves a piece does not hit the same piece again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Control points.
    pub points: [[f32; 3]; 4],
    /// Width of the ribbon at the parameters 0 and 1, not negative, linear in between.
    pub widths: [f32; 2],
    /// The piece of the curve: parameters from and to, within 0..=1.
    pub span: [f32; 2],
}

/// Control points in the space of a ray, which starts at the origin and runs along z.
type Controls = [DVec3; 4];

/// A piece is straight enough when it deviates from its chord by less than this fraction of its width.
const FLATNESS: f64 = 0.05;
/// Maximum number of halvings of a piece.
const MAX_HALVINGS: u32 = 10;

impl Curve {
    /// A whole curve.
    pub fn new(points: [[f32; 3]; 4], widths: [f32; 2]) -> Curve {
        Curve { points, widths, span: [0.0, 1.0] }
    }

    /// Cuts the curve into `count` pieces of equal spans: they take more memory, but have tighter boxes and are faster
    /// to query.
    pub fn pieces(self, count: u32) -> impl Iterator<Item = Curve> {
        let [from, to] = self.span;
        let at = move |i: u32| if i == count { to } else { from + (to - from) * i as f32 / count as f32 };
        (0..count).map(move |i| Curve { span: [at(i), at(i + 1)], ..self })
    }

    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let controls = self.controls(|p| p);
        let reach = DVec3::splat(self.width(0.0).max(self.width(1.0)) * 0.5);
        let least = controls.iter().fold(DVec3::INFINITY, |least, p| least.min(*p));
        let greatest = controls.iter().fold(DVec3::NEG_INFINITY, |greatest, p| greatest.max(*p));
        outwards(least - reach, greatest + reach)
    }

    /// The width at a position within the piece, 0..=1.
    fn width(&self, place: f64) -> f64 {
        let ([a, b], u) = (self.widths.map(f64::from), self.parameter(place));
        a + (b - a) * u
    }

    fn parameter(&self, place: f64) -> f64 {
        let [from, to] = self.span.map(f64::from);
        from + (to - from) * place
    }

    /// Control points of the piece, by blossoming. [Ramshaw 1989]
    fn controls(&self, map: impl Fn(DVec3) -> DVec3) -> Controls {
        let [p, q, r, s] = self.points.map(|point| map(wide(point)));
        let blossom = |a: f64, b: f64, c: f64| {
            let first = [p.lerp(q, a), q.lerp(r, a), r.lerp(s, a)];
            let second = [first[0].lerp(first[1], b), first[1].lerp(first[2], b)];
            second[0].lerp(second[1], c)
        };
        let [from, to] = self.span.map(f64::from);
        [blossom(from, from, from), blossom(from, from, to), blossom(from, to, to), blossom(to, to, to)]
    }

    pub(super) fn crossings(&self, ray: &Ray, visit: &mut dyn FnMut(Crossing)) {
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        let length = direction.length();
        let z = direction / length;
        let (x, y) = z.any_orthonormal_pair();
        let controls =
            self.controls(|p| DVec3::new((p - origin).dot(x), (p - origin).dot(y), (p - origin).dot(z)));
        let widest = self.width(0.0).max(self.width(1.0));
        if widest > 0.0 {
            let halvings = halvings(&controls, widest);
            self.search(&controls, [0.0, 1.0], halvings, &mut |place, z, v| {
                let u = self.parameter(place) as f32;
                visit(Crossing { t: (z / length) as f32, u, v, back: false });
            });
        }
    }

    /// Halves the piece until it is straight, and skips the halves that the ray misses. [Nakamaru 2002]
    fn search(
        &self,
        controls: &Controls,
        places: [f64; 2],
        halvings: u32,
        found: &mut impl FnMut(f64, f64, f32),
    ) {
        let [from, to] = places;
        let reach = self.width(from).max(self.width(to)) * 0.5;
        let passes_by =
            |k: usize| controls.iter().all(|p| p[k] > reach) || controls.iter().all(|p| p[k] < -reach);
        if passes_by(0) || passes_by(1) {
            return;
        }
        if halvings == 0 {
            return self.cross(controls, places, found);
        }
        let [p, q, r, s] = *controls;
        let (pq, qr, rs) = (p.midpoint(q), q.midpoint(r), r.midpoint(s));
        let (a, b) = (pq.midpoint(qr), qr.midpoint(rs));
        let (middle, half) = (a.midpoint(b), (from + to) * 0.5);
        self.search(&[p, pq, a, middle], [from, half], halvings - 1, found);
        self.search(&[middle, b, rs, s], [half, to], halvings - 1, found);
    }

    /// A piece that is nearly straight. Its ends are cut perpendicular to the curve, so that neighbours fit together.
    fn cross(&self, controls: &Controls, [from, to]: [f64; 2], found: &mut impl FnMut(f64, f64, f32)) {
        let [p, q, r, s] = controls.map(|c| c.truncate());
        let (begin, end) = (q - p, s - r);
        let chord = s - p;
        let before = if begin.length_squared() > 0.0 { begin } else { chord };
        let after = if end.length_squared() > 0.0 { end } else { chord };
        if (-p).dot(before) < 0.0 || (-s).dot(after) > 0.0 {
            return;
        }
        let along = if chord.length_squared() > 0.0 { (-p).dot(chord) / chord.length_squared() } else { 0.0 };
        let w = along.clamp(0.0, 1.0);
        let place = from + (to - from) * w;
        let (at, tangent) = point(controls, w);
        let (distance, reach) = (at.truncate().length(), self.width(place) * 0.5);
        if distance <= reach && reach > 0.0 {
            let side = tangent.truncate().perp_dot(at.truncate());
            let v = 0.5 + 0.5 * (distance / reach).copysign(side);
            found(place, at.z, v as f32);
        }
    }
}

/// A point of a curve, and the tangent there.
fn point([p, q, r, s]: &Controls, w: f64) -> (DVec3, DVec3) {
    let (a, b, c) = (p.lerp(*q, w), q.lerp(*r, w), r.lerp(*s, w));
    let (d, e) = (a.lerp(b, w), b.lerp(c, w));
    (d.lerp(e, w), e - d)
}

/// The number of halvings, from the second differences; each halving reduces them to a quarter. [Wang 1984]
fn halvings([p, q, r, s]: &Controls, width: f64) -> u32 {
    let bend = (*p - *q * 2.0 + *r).length().max((*q - *r * 2.0 + *s).length()) * 0.75;
    let allowed = width * FLATNESS;
    let mut count = 0;
    while count < MAX_HALVINGS && bend > allowed * f64::from(1u32 << (2 * count)) {
        count += 1;
    }
    count
}

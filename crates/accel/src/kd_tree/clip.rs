//! The part of a cell that a triangle actually occupies.

/// Minimum and maximum corner.
pub(super) type Planes = [[f32; 3]; 2];

/// The part of a triangle that lies in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    pub(super) planes: Planes,
    pub(super) index: u32,
}

/// The bounding box of the part of a triangle that lies in `region`; `None` if there is none.
///
/// Uses Sutherland–Hodgman clipping [Sutherland 1974] in f64, against the region enlarged by `2⁻⁴⁸` of the triangle's
/// largest coordinate. That exceeds the sum of all roundings, so no point of the triangle in the region itself is
/// ever lost.
pub(super) fn clipped_bounds(triangle: &[[f32; 3]; 3], region: &Planes) -> Option<Planes> {
    let reach = triangle.iter().flatten().fold(0f32, |reach, x| reach.max(x.abs()));
    let margin = f64::from(reach) / (1u64 << 48) as f64;
    let mut polygon = Polygon::new(triangle);
    for (axis, (&low, &high)) in region[0].iter().zip(&region[1]).enumerate() {
        polygon.clip(axis, 1.0, f64::from(low) - margin);
        polygon.clip(axis, -1.0, -f64::from(high) - margin);
    }
    let mut bounds = *region;
    for axis in 0..3 {
        let coordinates = || polygon.corners[..polygon.len].iter().map(|p| p[axis]);
        let low = ((coordinates().fold(f64::INFINITY, f64::min) - margin) as f32).next_down();
        let high = ((coordinates().fold(f64::NEG_INFINITY, f64::max) + margin) as f32).next_up();
        bounds[0][axis] = bounds[0][axis].max(low);
        bounds[1][axis] = bounds[1][axis].min(high);
        if bounds[0][axis] > bounds[1][axis] {
            return None;
        }
    }
    Some(bounds)
}

/// Three corners, and one more for each of six planes.
struct Polygon {
    corners: [[f64; 3]; 9],
    len: usize,
}

impl Polygon {
    fn new(triangle: &[[f32; 3]; 3]) -> Polygon {
        let mut corners = [[0.0; 3]; 9];
        for (corner, p) in corners.iter_mut().zip(triangle) {
            *corner = p.map(f64::from);
        }
        Polygon { corners, len: 3 }
    }

    /// Keeps the part with `sign * coordinate >= least`.
    fn clip(&mut self, axis: usize, sign: f64, least: f64) {
        let depth = |p: &[f64; 3]| sign * p[axis] - least;
        if self.corners[..self.len].iter().all(|p| depth(p) >= 0.0) {
            return;
        }
        let (old, len) = (self.corners, self.len);
        self.len = 0;
        for i in 0..len {
            let (p, q) = (old[i], old[(i + 1) % len]);
            let (from, to) = (depth(&p), depth(&q));
            if from >= 0.0 {
                self.push(p);
            }
            if (from >= 0.0) != (to >= 0.0) {
                let x = from / (from - to);
                let mut crossing: [f64; 3] = std::array::from_fn(|k| p[k] + (q[k] - p[k]) * x);
                crossing[axis] = sign * least;
                self.push(crossing);
            }
        }
    }

    /// A plane crosses the outline of a convex polygon twice, so there is always space; at worst, rounding could
    /// produce more crossings, and then those left out lie next to those kept.
    fn push(&mut self, p: [f64; 3]) {
        if let Some(corner) = self.corners.get_mut(self.len) {
            *corner = p;
            self.len += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    #[test]
    fn the_box_of_a_corner_is_tight() {
        let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let bounds = clipped_bounds(&triangle, &[[3.0, -1.0, -1.0], [9.0, 9.0, 9.0]]).unwrap();
        let exact = [[3.0, 0.0, 0.0], [4.0, 1.0, 0.0]];
        for (p, q) in bounds.iter().flatten().zip(exact.iter().flatten()) {
            assert!((p - q).abs() < 1e-6, "{bounds:?}");
        }
        assert!(clipped_bounds(&triangle, &[[3.0, 2.0, -1.0], [9.0, 9.0, 9.0]]).is_none());
    }

    #[test]
    fn no_point_of_a_triangle_in_the_region_is_outside_of_the_box() {
        let mut inside = 0;
        for seed in 0..20_000 {
            let number = |i: u64| unit_f32(hash_words([seed, i]) as u32);
            let offset = [0.0, 1e5, -3e7][seed as usize % 3];
            let thin = [1.0, 1e-6][seed as usize / 3 % 2];
            let mut triangle = [[0f32; 3]; 3];
            for (i, x) in triangle.iter_mut().flatten().enumerate() {
                *x = number(i as u64) * if i == 8 { thin } else { 1.0 } + offset;
            }
            let ends: [[f32; 3]; 2] =
                [20, 30].map(|i| std::array::from_fn(|axis| number(i + axis as u64) + offset));
            let pick = |by: fn(f32, f32) -> f32| std::array::from_fn(|k| by(ends[0][k], ends[1][k]));
            let region: Planes = [pick(f32::min), pick(f32::max)];
            let bounds = clipped_bounds(&triangle, &region);
            for i in 0..20 {
                let (mut u, mut v) = (f64::from(number(40 + i)), f64::from(number(80 + i)));
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let p: [f64; 3] = std::array::from_fn(|k| {
                    let [a, b, c] = triangle.map(|p| f64::from(p[k]));
                    a + (b - a) * u + (c - a) * v
                });
                let is_in = |planes: &Planes| {
                    (0..3).all(|k| f64::from(planes[0][k]) <= p[k] && p[k] <= f64::from(planes[1][k]))
                };
                if is_in(&region) {
                    inside += 1;
                    assert!(bounds.as_ref().is_some_and(is_in), "{triangle:?} {region:?} {p:?}");
                }
            }
        }
        assert!(inside > 1000, "{inside}");
    }
}

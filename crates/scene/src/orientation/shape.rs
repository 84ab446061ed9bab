//! Orientation from shape: a hand-made score that distinguishes 105 public models; see `docs/adr/0029-up-and-front.md`.

use crate::builder::SceneBuilder;
use crate::geometry::axis::Axis;
use bilux_math::DVec3;

/// A point of a surface with its unit normal, or zero if it has none, and its area.
#[derive(Clone, Copy)]
struct Sample {
    p: DVec3,
    n: DVec3,
    area: f64,
}

/// The number of points that are sampled.
const SAMPLES: usize = 1 << 14;
/// A mesh of at most so many triangles is too coarse to have finer and coarser parts.
const FEW: usize = 1000;
/// Cells along the longest side of the bounding box, for measuring symmetry.
const CELLS: usize = 24;

/// The part of the bounding box that a foot has to cover for a shape to stand on it.
const STEADY: f64 = 0.1;

/// Maximum distance from 0, relative to its height, of the lowest point of a shape on the ground plane.
const ON_GROUND: f64 = 0.005;

/// The measurements.
pub(super) struct Shape {
    /// The sides of its bounding box.
    extent: DVec3,
    low: DVec3,
    middle: DVec3,
    samples: Vec<Sample>,
    /// For each axis, how much of the shape its mirror image across the centre of the box contains, 0..=1.
    symmetry: [f64; 3],
    /// Whether it has so few triangles that their sizes say nothing.
    is_coarse: bool,
    /// Triangles per area on the lower and upper half of each axis.
    density: [[f64; 2]; 3],
}

impl Shape {
    /// `None` for a shape of zero size.
    pub(super) fn of(scene: &SceneBuilder) -> Option<Shape> {
        let bounds = scene.bounds(0.0);
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let extent = high - low;
        if bounds.is_empty() || !extent.is_finite() || extent.max_element() <= 0.0 {
            return None;
        }
        let middle = (low + high) * 0.5;
        let samples = samples(scene);
        let is_coarse = triangles(scene).nth(FEW).is_none();
        let (symmetry, density) = ([0.0; 3], [[1.0; 2]; 3]);
        let mut shape = Shape { extent, low, middle, samples, symmetry, is_coarse, density };
        shape.symmetry = shape.symmetries();
        shape.density = shape.densities(scene);
        (!shape.samples.is_empty()).then_some(shape)
    }

    /// The fraction of filled cells whose mirror image, or a neighbour of that, is also filled.
    fn symmetries(&self) -> [f64; 3] {
        let longest = self.extent.max_element();
        let cell = |p: DVec3| -> [usize; 3] {
            let q = ((p - self.middle) / longest + 0.5) * CELLS as f64;
            q.to_array().map(|c| (c.max(0.0) as usize).min(CELLS - 1))
        };
        let at = |[x, y, z]: [usize; 3]| (x * CELLS + y) * CELLS + z;
        let mut filled = vec![false; CELLS * CELLS * CELLS];
        let cells: Vec<[usize; 3]> = self.samples.iter().map(|sample| cell(sample.p)).collect();
        cells.iter().for_each(|c| filled[at(*c)] = true);
        let all: Vec<[usize; 3]> =
            cells.into_iter().filter(|c| std::mem::take(&mut filled[at(*c)])).collect();
        all.iter().for_each(|c| filled[at(*c)] = true);
        let is_near = |c: [usize; 3]| {
            let beside = |axis: usize, by: isize| {
                let mut near = c;
                near[axis] = c[axis].checked_add_signed(by).filter(|&i| i < CELLS)?;
                Some(filled[at(near)])
            };
            filled[at(c)] || (0..3).any(|axis| [-1, 1].into_iter().any(|by| beside(axis, by) == Some(true)))
        };
        std::array::from_fn(|axis| {
            let mirrored = |mut c: [usize; 3]| {
                c[axis] = CELLS - 1 - c[axis];
                c
            };
            let found = all.iter().filter(|c| is_near(mirrored(**c))).count();
            found as f64 / all.len().max(1) as f64
        })
    }

    fn densities(&self, scene: &SceneBuilder) -> [[f64; 2]; 3] {
        let mut sums = [[[1.0, 0.0]; 2]; 3];
        for corners in triangles(scene) {
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            for (axis, sums) in sums.iter_mut().enumerate() {
                let [count, sum] = &mut sums[usize::from(middle[axis] > self.middle[axis])];
                *count += 1.0;
                *sum += area(corners);
            }
        }
        sums.map(|halves| halves.map(|[count, area]| count / area.max(f64::MIN_POSITIVE)))
    }

    /// A score for this up axis, where `usual` is the up axis of most files of its format.
    ///
    /// The weights are those that orient most of the models of the record correctly.
    pub(super) fn upright(&self, up: Axis, usual: Axis) -> f64 {
        let axis = up.index();
        let mut score = match up {
            up if up == usual => 1.0,
            up if up.index() == usual.index() => 0.33,
            Axis::Y | Axis::Z => 0.42,
            _ => 0.0,
        };
        let mut sides = self.extent.to_array();
        sides.sort_by(f64::total_cmp);
        // A plate lies flat; a shape without any height is a picture, and hangs.
        let flatness = self.extent[axis] / sides[1].max(f64::MIN_POSITIVE);
        if self.extent[axis] == sides[0] && flatness > 0.01 {
            score += 4.0 * (1.0 - flatness / 0.16).max(0.0);
        }
        // Modellers put things on the ground plane.
        if up.sign() > 0.0 && self.low[axis].abs() < self.extent[axis] * ON_GROUND {
            score += 0.2;
        }
        // Up lies in the plane of symmetry of an object.
        let others = (0..3).filter(|other| *other != axis).map(|other| self.symmetry[other]);
        score += 0.44 * ((others.fold(0.0, f64::max) - self.symmetry[axis]) * 4.0).clamp(-1.0, 1.0);
        score + self.support(up)
    }

    /// A score for a broad, flat base and a low centre of mass. What would topple scores nothing for its base.
    fn support(&self, up: Axis) -> f64 {
        let (axis, longest) = (up.index(), self.extent.max_element());
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let height = |p: DVec3| {
            let h = p[axis] - self.low[axis];
            if up.sign() > 0.0 { h } else { self.extent[axis] - h }
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (mut contact, mut area, mut middle) = (0.0, 0.0, DVec3::ZERO);
        for sample in &self.samples {
            let h = height(sample.p);
            area += sample.area;
            middle += sample.p * sample.area;
            if h < 0.02 * longest {
                for (i, side) in [u, v].into_iter().enumerate() {
                    low[i] = low[i].min(sample.p[side]);
                    high[i] = high[i].max(sample.p[side]);
                }
                if h < 0.01 * longest && sample.n[axis] * up.sign() < -0.95 {
                    contact += sample.area;
                }
            }
        }
        if area <= 0.0 {
            return 0.0;
        }
        middle /= area;
        let cross = (self.extent[u] * self.extent[v]).max(f64::MIN_POSITIVE);
        let stands = [u, v].into_iter().enumerate().all(|(i, s)| (low[i]..=high[i]).contains(&middle[s]));
        let foot = if stands { (high[0] - low[0]) * (high[1] - low[1]) / cross } else { 0.0 };
        let steady = 0.2 * (foot / STEADY).min(1.0);
        let lowness = 0.5 - height(middle) / self.extent[axis].max(f64::MIN_POSITIVE);
        0.22 * (contact / cross).min(1.0) + 1.08 * foot.min(1.0) + steady + 0.12 * lowness
    }

    /// The part of what is seen from the side of an axis that is backs of triangles.
    fn backs(&self, from: Axis) -> f64 {
        let axis = from.index();
        let sides = [(axis + 1) % 3, (axis + 2) % 3];
        let cell = |p: DVec3, side: usize| {
            let along = (p[side] - self.low[side]) / self.extent[side].max(f64::MIN_POSITIVE);
            ((along * CELLS as f64) as usize).min(CELLS - 1)
        };
        let mut nearest: Vec<Option<&Sample>> = vec![None; CELLS * CELLS];
        for sample in &self.samples {
            let place = &mut nearest[cell(sample.p, sides[0]) * CELLS + cell(sample.p, sides[1])];
            let near = |sample: &Sample| sample.p[axis] * from.sign();
            if place.is_none_or(|before| near(before) < near(sample)) {
                *place = Some(sample);
            }
        }
        let seen = nearest.iter().flatten().count();
        let is_back = |sample: &&&Sample| sample.n[axis] * from.sign() < -0.1;
        nearest.iter().flatten().filter(is_back).count() as f64 / seen.max(1) as f64
    }

    /// True when the front is on the other side.
    ///
    /// A room without a wall, or a relief, that shows its backs on one side and none on the other is made to be seen
    /// from the other. A shape with left-right symmetry looks backwards if its upper half and its finer triangles
    /// tend to lie behind the centre, one of them clearly, unless it is broader than high: then its highest part may be
    /// a tail.
    pub(super) fn looks_back(&self, up: Axis, front: Axis) -> bool {
        if self.backs(front) > 0.8 && self.backs(front.opposite()) < 0.1 {
            return true;
        }
        let [up_axis, axis] = [up.index(), front.index()];
        let across = 3 - up_axis - axis;
        let is_broad = self.extent[across] > self.extent[up_axis];
        if self.symmetry[across] < 0.97 || self.symmetry[axis] > 0.97 || is_broad {
            return false;
        }
        let forward = |p: DVec3| (p[axis] - self.middle[axis]) * front.sign() / self.extent[axis];
        let mut halves = [[0.0; 2]; 2];
        for sample in &self.samples {
            let is_upper = (sample.p[up_axis] - self.middle[up_axis]) * up.sign() > 0.0;
            let [sum, area] = &mut halves[usize::from(is_upper)];
            *sum += forward(sample.p) * sample.area;
            *area += sample.area;
        }
        let [lower, upper] = halves.map(|[sum, area]| sum / area.max(f64::MIN_POSITIVE));
        let [behind, before] = self.density[axis];
        let finer = bilux_math::transcendental::ln(((before / behind) as f32).max(f32::MIN_POSITIVE));
        let finer =
            if self.is_coarse { 0.0 } else { 0.5 * (f64::from(finer) * front.sign()).clamp(-1.5, 1.5) };
        let shift = upper - lower;
        shift + finer < -0.1 && (shift < -0.15 || finer < -0.1)
    }
}

/// All triangles, in world space.
fn triangles(scene: &SceneBuilder) -> impl Iterator<Item = [DVec3; 3]> {
    scene.objects.iter().flat_map(|object| {
        let (mesh, to_world) = (&object.mesh, object.motion.at(0.0));
        let at = move |i: u32| mesh.positions.get(i as usize).map(|p| to_world.point(*p).as_dvec3());
        mesh.triangles.iter().filter_map(move |triangle| {
            let [a, b, c] = triangle.map(at);
            Some([a?, b?, c?]).filter(|corners| corners.iter().all(|p| p.is_finite()))
        })
    })
}

fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() * 0.5
}

/// Uniform points on all triangles; without triangles, the points of point clouds and the ends of lines.
fn samples(scene: &SceneBuilder) -> Vec<Sample> {
    let total: f64 = triangles(scene).map(area).sum();
    if total > 0.0 && total.is_finite() {
        return on_triangles(scene, total / SAMPLES as f64);
    }
    let count: usize = scene.objects.iter().map(|object| object.mesh.stroke_count()).sum();
    let points = scene.objects.iter().flat_map(|object| {
        let (mesh, to_world) = (&object.mesh, object.motion.at(0.0));
        let vertices = mesh.points.iter().copied().chain(mesh.lines.iter().map(|line| line[0]));
        vertices.filter_map(move |i| Some(to_world.point(*mesh.positions.get(i as usize)?).as_dvec3()))
    });
    let some = points.step_by((count / SAMPLES).max(1)).filter(|p| p.is_finite());
    some.map(|p| Sample { p, n: DVec3::ZERO, area: 1.0 }).collect()
}

/// One sample per `part` of the area.
fn on_triangles(scene: &SceneBuilder, part: f64) -> Vec<Sample> {
    // From the plastic number: points that fill a square uniformly. [Roberts 2018]
    const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];
    let (mut samples, mut sum, mut next) = (Vec::new(), 0.0, 0.5);
    for [a, b, c] in triangles(scene) {
        let normal = (b - a).cross(c - a);
        sum += normal.length() * 0.5 / part;
        while next < sum && samples.len() <= SAMPLES {
            let [mut u, mut v] = STEPS.map(|step| (samples.len() as f64 * step).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = a + (b - a) * u + (c - a) * v;
            samples.push(Sample { p, n: normal.normalize_or_zero(), area: part });
            next += 1.0;
        }
    }
    samples
}

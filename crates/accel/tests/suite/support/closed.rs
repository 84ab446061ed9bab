//! Closed meshes, and origins that provably lie inside them.
//!
//! Vertices are multiples of 2⁻²⁰ below 2¹⁹, so the predicates below are exact in integers. A point is inside when a
//! ray from it crosses the mesh an odd number of times. Each edge belongs to an even number of triangles, so the
//! parity is the same in every direction, and every ray from such a point must hit.

use super::Numbers;
use bilux_accel::TriangleMesh;
use std::collections::HashMap;
use std::sync::LazyLock;

/// A closed mesh with points inside it.
pub struct Closed {
    pub name: &'static str,
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
    pub inside: Vec<[f32; 3]>,
}

const GRID: f64 = 1_048_576.0;
/// Approximately: a power of two, so that scaling is exact.
const MILLION: f32 = 1_048_576.0;

fn on_grid(p: [f64; 3]) -> [f32; 3] {
    p.map(|x| ((x * GRID).round() / GRID) as f32)
}

fn whole(p: [f32; 3]) -> [i128; 3] {
    p.map(|x| (f64::from(x) * GRID) as i128)
}

impl Closed {
    /// Checks that the surface is closed, and keeps those of many random points that are inside and not too near the
    /// surface.
    fn new(name: &'static str, positions: Vec<[f64; 3]>, indices: Vec<[u32; 3]>) -> Closed {
        let positions: Vec<[f32; 3]> = positions.into_iter().map(on_grid).collect();
        let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
        for &[a, b, c] in &indices {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_default() += 1;
            }
        }
        assert!(edges.values().all(|count| count % 2 == 0), "{name} is not closed");
        let mut closed = Closed { name, positions, indices, inside: Vec::new() };
        let bounds = closed.mesh().bounds();
        let mut numbers = Numbers::new(77);
        // 160 units of f32 rounding of its size: the triangle test's shear moves a vertex by less than 7.
        let margin = f64::from(bounds.extent().max_element()) * 1e-5;
        let count = closed.positions.len();
        while closed.inside.len() < 24 {
            let [a, b] = [0; 2].map(|_| closed.positions[numbers.below(count)].map(f64::from));
            let x = f64::from(numbers.unit());
            let p = on_grid(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * x));
            if closed.is_inside(p) && closed.is_clear(p, margin) {
                closed.inside.push(p);
            }
        }
        closed
    }

    fn scaled(mut self, by: f32) -> Closed {
        self.positions.iter_mut().chain(&mut self.inside).flatten().for_each(|x| *x *= by);
        self
    }

    pub fn mesh(&self) -> TriangleMesh {
        TriangleMesh::new(self.positions.clone(), self.indices.clone()).expect("the indices are sound")
    }

    /// Exact; also false when the ray along +x hits an edge, which proves nothing.
    fn is_inside(&self, p: [f32; 3]) -> bool {
        let o = whole(p);
        let mut crossings = 0;
        for triangle in &self.indices {
            let [a, b, c] = triangle.map(|v| {
                let v = whole(self.positions[v as usize]);
                [v[0] - o[0], v[1] - o[1], v[2] - o[2]]
            });
            let cross = |p: [i128; 3], q: [i128; 3]| p[1] * q[2] - p[2] * q[1];
            let (u, v, w) = (cross(b, c), cross(c, a), cross(a, b));
            let signs = [u.signum(), v.signum(), w.signum()];
            if signs.contains(&1) && signs.contains(&-1) {
                continue;
            }
            if signs.contains(&0) {
                if signs == [0; 3] && [a, b, c].iter().all(|v| v[1] > 0) {
                    continue;
                }
                return false;
            }
            let along = (u * a[0] + v * b[0] + w * c[0]) * (u + v + w).signum();
            crossings += usize::from(along > 0);
        }
        crossings % 2 == 1
    }

    /// True when no triangle is nearer than `margin`.
    fn is_clear(&self, p: [f32; 3], margin: f64) -> bool {
        use bilux_math::DVec3;
        let o = DVec3::from(p.map(f64::from));
        self.indices.iter().all(|triangle| {
            let [a, b, c] = triangle.map(|v| DVec3::from(self.positions[v as usize].map(f64::from)) - o);
            distance_to_triangle(a, b, c) > margin
        })
    }
}

/// From the origin: the minimum of the distance to the plane, if its foot is inside, and to the edges.
fn distance_to_triangle(a: bilux_math::DVec3, b: bilux_math::DVec3, c: bilux_math::DVec3) -> f64 {
    let to_edge = |p: bilux_math::DVec3, q: bilux_math::DVec3| {
        let d = q - p;
        let x = if d.length_squared() > 0.0 { (-p.dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
        (p + d * x).length()
    };
    let edges = to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a));
    let normal = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| (*q - *p).cross(-*p).dot(normal) >= 0.0);
    if inside && normal.length() > 0.0 { edges.min((a.dot(normal) / normal.length()).abs()) } else { edges }
}

/// A cube's faces divided into `n` by `n` cells, each point then moved by `place`.
fn cube(n: u32, place: impl Fn([f64; 3]) -> [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let mut known: HashMap<[i32; 3], u32> = HashMap::new();
    for face in 0..6 {
        let (axis, side) = (face % 3, if face < 3 { -1 } else { 1 });
        let mut vertex = |i: u32, j: u32| {
            let mut key = [0; 3];
            key[axis] = side * n as i32;
            key[(axis + 1) % 3] = 2 * i as i32 - n as i32;
            key[(axis + 2) % 3] = 2 * j as i32 - n as i32;
            *known.entry(key).or_insert_with(|| {
                positions.push(place(key.map(|x| f64::from(x) / f64::from(n))));
                positions.len() as u32 - 1
            })
        };
        for (i, j) in (0..n * n).map(|cell| (cell / n, cell % n)) {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            let pair = if side > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            indices.extend(pair);
        }
    }
    (positions, indices)
}

fn torus(rings: u32, sides: u32, tube: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    use bilux_math::transcendental::{cos_f64 as cos, sin_f64 as sin};
    let turn = |i: u32, n: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
    let positions = (0..rings * sides).map(|i| {
        let (a, b) = (turn(i / sides, rings), turn(i % sides, sides));
        let r = 1.0 + tube * cos(b);
        [r * cos(a), tube * sin(b), r * sin(a)]
    });
    let at = |i: u32, j: u32| (i % rings) * sides + j % sides;
    let indices = (0..rings * sides).map(|cell| (cell / sides, cell % sides)).flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    (positions.collect(), indices.collect())
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
    p.map(|x| x / length)
}

/// Rotated about an oblique axis, scaled, and moved.
fn posed(p: [f64; 3], scale: [f64; 3], by: [f64; 3]) -> [f64; 3] {
    let q = [
        0.48 * p[0] + 0.64 * p[1] - 0.6 * p[2],
        -0.8 * p[0] + 0.6 * p[1],
        0.36 * p[0] + 0.48 * p[1] + 0.8 * p[2],
    ];
    std::array::from_fn(|k| q[k] * scale[k] + by[k])
}

/// Every closed mesh.
pub fn all() -> &'static [Closed] {
    static ALL: LazyLock<Vec<Closed>> = LazyLock::new(every);
    &ALL
}

fn every() -> Vec<Closed> {
    let make =
        |name, (positions, indices): (Vec<[f64; 3]>, Vec<[u32; 3]>)| Closed::new(name, positions, indices);
    let far = |p| posed(p, [3.0; 3], [10_000.3, -77_777.7, 12_345.6]);
    // Cells a thousand times as long as wide, bent inwards and outwards.
    let slivers = |p: [f64; 3]| {
        let q = unit(p);
        let bump = 1.0 + 0.3 * bilux_math::transcendental::sin_f64(9.0 * q[0] + 4.0 * q[1] * q[2]);
        posed(q.map(|x| x * bump), [1.0, 1.0, 1.0], [0.0; 3]).map(|x| x * x * x * 5.0)
    };
    let (ring, tube) = torus(96, 24, 0.25);
    let needle = cube(24, |p| {
        let q = unit(p);
        posed([q[0] * 50.0, q[1] * 0.02, q[2]], [1.0; 3], [5.0, 6.0, 7.0])
    });
    vec![
        make("cube", cube(8, |p| p)),
        make("sphere", cube(24, unit)),
        make("sphere, turned, far away", cube(24, |p| far(unit(p)))),
        make("blob with slivers", cube(30, slivers)),
        make("needle", needle),
        make("torus", (ring.clone(), tube.clone())),
        make("sphere, a millionth", cube(12, unit)).scaled(1.0 / MILLION),
        make("sphere, a millionth, far for its size", cube(12, |p| far(unit(p)))).scaled(1.0 / MILLION),
        make("sphere, a million times", cube(12, unit)).scaled(MILLION),
        make("blob with slivers, a million times", cube(12, slivers)).scaled(MILLION),
        make("torus, turned, far away", (ring.into_iter().map(far).collect(), tube)),
    ]
}

/// Ray number `index` from inside: towards a vertex, an edge or a triangle, along an axis, or in any direction.
pub fn ray(closed: &Closed, seed: u64, index: u64) -> bilux_accel::Ray {
    let mut numbers = Numbers::new(bilux_math::hash::hash_words([seed, index]));
    let origin = closed.inside[numbers.below(closed.inside.len())];
    let triangle = closed.indices[numbers.below(closed.indices.len())];
    let [a, b, c] = triangle.map(|v| closed.positions[v as usize]);
    let mix = |p: [f32; 3], q: [f32; 3], x: f32| -> [f32; 3] {
        std::array::from_fn(|k| p[k] * (1.0 - x) + q[k] * x)
    };
    let target = match index % 5 {
        0 => a,
        1 => mix(a, b, numbers.unit()),
        2 => mix(mix(a, b, numbers.unit()), c, numbers.unit()),
        _ => {
            let v = numbers.vector();
            std::array::from_fn(|k| origin[k] + v[k])
        }
    };
    let mut direction: [f32; 3] = std::array::from_fn(|k| target[k] - origin[k]);
    if index % 5 == 4 {
        let axis = numbers.below(3);
        direction = [0.0, -0.0, 0.0];
        direction[axis] = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
    }
    if direction == [0.0; 3] {
        direction[0] = 1.0;
    }
    bilux_accel::Ray::new(origin, direction)
}

//! Elementary shapes, for scenes and tests. All are counter-clockwise from outside; the round ones have normals.

use crate::mesh::Mesh;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Aabb, DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A parallelogram around its centre; counter-clockwise when seen from the side that `u × v` points to.
pub fn quad(middle: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    Mesh {
        name: "quad".to_owned(),
        positions: corners.map(|(a, b)| middle + u * a + v * b).to_vec(),
        uvs: corners.map(|(a, b)| Vec2::new(a + 0.5, b + 0.5)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A horizontal square of this side length around a point, facing upwards.
pub fn floor(middle: Vec3, side: f32) -> Mesh {
    Mesh { name: "floor".to_owned(), ..quad(middle, Vec3::Z * side, Vec3::X * side) }
}

/// A horizontal disc around a point, facing upwards, of `around` (at least 3) triangles.
pub fn disc(middle: Vec3, radius: f32, around: u32) -> Mesh {
    let around = around.max(3);
    let rim = (0..around).map(|i| {
        let (sin, cos) = sin_cos_f64(TAU * f64::from(i) / f64::from(around));
        middle + DVec3::new(cos, 0.0, -sin).as_vec3() * radius
    });
    Mesh {
        name: "disc".to_owned(),
        positions: std::iter::once(middle).chain(rim).collect(),
        triangles: (0..around).map(|i| [0, 1 + i, 1 + (i + 1) % around]).collect(),
        ..Mesh::default()
    }
}

/// A horizontal chessboard of `count * count` squares around a point: those of one colour, then those of the other.
pub fn chessboard(middle: Vec3, side: f32, count: u32) -> [Mesh; 2] {
    let square = side / count.max(1) as f32;
    let mut boards = ["light squares", "dark squares"].map(|n| Mesh { name: n.into(), ..Mesh::default() });
    // Corners are multiples of one length, so that neighbours share them bit for bit.
    let corner = |i: u32, k: u32| {
        let at = |i: u32| (i as f32 - count as f32 * 0.5) * square;
        middle + Vec3::new(at(i), 0.0, at(k))
    };
    for (i, k) in (0..count).flat_map(|i| (0..count).map(move |k| (i, k))) {
        let board = &mut boards[((i + k) % 2) as usize];
        let first = board.positions.len() as u32;
        board.positions.extend([corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k)]);
        board.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    boards
}

/// A closed box, flat-shaded.
pub fn cuboid(bounds: Aabb) -> Mesh {
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        name: "box".to_owned(),
        positions: bounds.corners().to_vec(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

/// A closed upright prism around a point, flat-shaded, with `sides` (at least 3) corners on a circle of this radius.
///
/// The first of them is along x.
pub fn prism(middle: Vec3, radius: f32, height: f32, sides: u32) -> Mesh {
    let sides = sides.max(3);
    let corner = |i: u32, y: f32| {
        let (sin, cos) = sin_cos_f64(TAU * f64::from(i) / f64::from(sides));
        middle + DVec3::new(cos, 0.0, -sin).as_vec3() * radius + Vec3::Y * y
    };
    let ends = [-0.5 * height, 0.5 * height];
    let walls = (0..sides).flat_map(|i| {
        let (a, b) = (i, (i + 1) % sides);
        [[a, b, b + sides], [a, b + sides, a + sides]]
    });
    let caps = (2..sides).flat_map(|i| [[0, i, i - 1], [sides, sides + i - 1, sides + i]]);
    Mesh {
        name: "prism".to_owned(),
        positions: ends.into_iter().flat_map(|y| (0..sides).map(move |i| corner(i, y))).collect(),
        triangles: walls.chain(caps).collect(),
        ..Mesh::default()
    }
}

/// A closed sphere of nearly equal triangles, with 20 · 4^level of them.
///
/// It is an icosahedron whose triangles are each cut into four, `level` times (at most 10).
pub fn icosphere(centre: Vec3, radius: f32, level: u32) -> Mesh {
    let mut points = icosahedron();
    let mut triangles = ICOSAHEDRON.to_vec();
    for _ in 0..level.min(10) {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh {
        name: "sphere".to_owned(),
        positions: points.iter().map(|p| (centre.as_dvec3() + *p * f64::from(radius)).as_vec3()).collect(),
        normals: points.iter().map(|p| p.as_vec3()).collect(),
        triangles,
        ..Mesh::default()
    }
}

/// A closed surface around a centre, `distance(direction)` away in every direction, with area-weighted normals.
///
/// It makes smooth and bumpy objects for tests.
pub fn blob(centre: Vec3, level: u32, distance: impl Fn(Vec3) -> f32) -> Mesh {
    let mut mesh = Mesh { name: "blob".to_owned(), ..icosphere(Vec3::ZERO, 1.0, level) };
    for p in &mut mesh.positions {
        *p = centre + *p * distance(*p);
    }
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// A closed sphere by longitude and latitude, poles up and down, with uv: `around` (at least 3) by `along` (at least 2)
/// segments.
pub fn uv_sphere(centre: Vec3, radius: f32, around: u32, along: u32) -> Mesh {
    let point = |theta: f64, phi: f64| {
        let ((st, ct), (sp, cp)) = (sin_cos_f64(theta), sin_cos_f64(phi));
        DVec3::new(st * cp, ct, -st * sp)
    };
    let (around, along) = (around.max(3), along.max(2));
    let place = |n: DVec3| (centre.as_dvec3() + n * f64::from(radius)).as_vec3();
    grid("sphere", around, along, |i, j| {
        // The last meridian equals the first, and a pole is one point, bit for bit.
        let (i, theta) = (i % around, PI * f64::from(j) / f64::from(along));
        let n = match j {
            0 => DVec3::Y,
            j if j == along => DVec3::NEG_Y,
            _ => point(theta, TAU * f64::from(i) / f64::from(around)),
        };
        (place(n), n.as_vec3())
    })
}

/// A closed torus around the y axis: `radius` to the centre of the tube, whose own radius is `tube`.
pub fn torus(centre: Vec3, radius: f32, tube: f32, around: u32, along: u32) -> Mesh {
    let (around, along) = (around.max(3), along.max(3));
    grid("torus", around, along, |i, j| {
        let turn = |i: u32, n: u32| sin_cos_f64(TAU * f64::from(i % n) / f64::from(n));
        let ((sp, cp), (st, ct)) = (turn(i, around), turn(j, along));
        let n = DVec3::new(ct * cp, -st, -ct * sp);
        let middle = DVec3::new(cp, 0.0, -sp) * f64::from(radius);
        ((centre.as_dvec3() + middle + n * f64::from(tube)).as_vec3(), n.as_vec3())
    })
}

/// A surface by its points and normals at `(0..=columns) × (0..=rows)`, v downwards, with uv from 0 to 1.
///
/// Each square between four of them is two triangles, or one where two of its corners coincide.
pub fn grid(name: &str, columns: u32, rows: u32, at: impl Fn(u32, u32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let (position, normal) = at(i, j);
        mesh.positions.push(position);
        mesh.normals.push(normal);
        mesh.uvs.push(Vec2::new(i as f32 / columns as f32, 1.0 - j as f32 / rows as f32));
    }
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let corner = |di: u32, dj: u32| (j + dj) * (columns + 1) + i + di;
        let (a, b, c, d) = (corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|k| mesh.positions[k as usize]);
            if p != q && q != r && r != p {
                mesh.triangles.push(triangle);
            }
        }
    }
    mesh
}

fn icosahedron() -> Vec<DVec3> {
    let golden = 0.5 + 1.25f64.sqrt();
    let signs = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut points = signs.map(|(a, b)| DVec3::new(a, b * golden, 0.0)).to_vec();
    points.extend(signs.map(|(a, b)| DVec3::new(0.0, a, b * golden)));
    points.extend(signs.map(|(a, b)| DVec3::new(b * golden, 0.0, a)));
    points.iter().map(|p| p.normalize()).collect()
}

const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

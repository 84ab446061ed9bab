//! Meshes that have broken ray tracers.

use super::Numbers;
use bilux_accel::TriangleMesh;

type Triangle = [[f32; 3]; 3];

fn mesh(corners: Vec<Triangle>) -> TriangleMesh {
    TriangleMesh::from_corners(corners).expect("few triangles")
}

fn random(seed: u64, count: usize, spread: f32, size: f32) -> Vec<Triangle> {
    let mut numbers = Numbers::new(seed);
    let triangle = |_| {
        let at = numbers.vector().map(|x| x * spread);
        std::array::from_fn(|_| {
            let d = numbers.vector();
            std::array::from_fn(|k| at[k] + d[k] * size)
        })
    };
    (0..count).map(triangle).collect()
}

/// A unit square of `n` by `n` cells in the plane where `axis` is `height`.
fn sheet(axis: usize, height: f32, n: usize) -> Vec<Triangle> {
    let point = |i: usize, j: usize| {
        let mut p = [height; 3];
        p[(axis + 1) % 3] = i as f32 / n as f32;
        p[(axis + 2) % 3] = j as f32 / n as f32;
        p
    };
    let cells = (0..n * n).map(|cell| (cell / n, cell % n));
    cells
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn moved(mut corners: Vec<Triangle>, scale: f32, by: [f32; 3]) -> Vec<Triangle> {
    for p in corners.iter_mut().flatten() {
        *p = std::array::from_fn(|k| p[k] * scale + by[k]);
    }
    corners
}

/// Walls of cells: every plane that a tree may choose contains triangles, and lies in the edges of others.
fn grid(n: usize) -> Vec<Triangle> {
    (0..3).flat_map(|axis| (0..=n).flat_map(move |i| sheet(axis, i as f32 / n as f32, n))).collect()
}

fn degenerate() -> Vec<Triangle> {
    let mut all = random(5, 200, 1.0, 0.3);
    for (i, triangle) in all.iter_mut().enumerate() {
        match i % 4 {
            0 => triangle[2] = triangle[1],
            1 => *triangle = [triangle[0]; 3],
            2 => triangle[2] = std::array::from_fn(|k| triangle[0][k] * 0.5 + triangle[1][k] * 0.5),
            _ => {}
        }
    }
    all
}

fn slivers() -> Vec<Triangle> {
    let mut all = random(6, 300, 1.0, 1.0);
    for triangle in &mut all {
        let (a, b) = (triangle[0], triangle[1]);
        triangle[2] = std::array::from_fn(|k| a[k] * 0.3 + b[k] * 0.7 + triangle[2][k] * 1e-6);
    }
    all
}

fn huge_and_tiny() -> Vec<Triangle> {
    let sizes = [1e-30f32, 1e-12, 1e-3, 1.0, 1e6, 1e18, 1e37];
    sizes.iter().enumerate().flat_map(|(i, &size)| random(70 + i as u64, 40, size, size)).collect()
}

fn not_numbers() -> Vec<Triangle> {
    let mut all = random(8, 200, 1.0, 0.5);
    for (i, triangle) in all.iter_mut().enumerate().filter(|(i, _)| i % 3 == 0) {
        triangle[i % 2][i % 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][i / 3 % 3];
    }
    all
}

/// Each triangle is twice the size of the one before, which leads to deep trees.
fn nested() -> Vec<Triangle> {
    (0..100)
        .map(|i| {
            let s = f32::from_bits((90 + i) << 23);
            [[s, 0.0, 0.0], [s, s, 0.1 * s], [s, 0.0, s]]
        })
        .collect()
}

/// Every mesh, with its name.
pub fn all() -> Vec<(&'static str, TriangleMesh)> {
    let duplicated = random(9, 40, 1.0, 0.8).into_iter().flat_map(|t| [t; 8]).collect();
    let one = random(3, 1, 0.0, 1.0);
    let mut mixed = moved(sheet(1, 0.0, 2), 1000.0, [-500.0, 0.0, -500.0]);
    mixed.extend(random(10, 600, 1.0, 0.05));
    let grouped = mesh(random(11, 300, 1.0, 0.2)).with_groups(vec![0..100, 100..100, 100..250, 250..300]);
    vec![
        ("empty", mesh(Vec::new())),
        ("one", mesh(one.clone())),
        ("the same a hundred times", mesh(vec![one[0]; 100])),
        ("random", mesh(random(1, 500, 1.0, 0.2))),
        ("overlapping", mesh(random(2, 200, 0.2, 1.0))),
        ("degenerate", mesh(degenerate())),
        ("slivers", mesh(slivers())),
        ("huge and tiny", mesh(huge_and_tiny())),
        ("not numbers", mesh(not_numbers())),
        ("nested", mesh(nested())),
        ("duplicated", mesh(duplicated)),
        ("coplanar", mesh([sheet(2, 0.25, 12), sheet(2, 0.25, 5)].concat())),
        ("grid", mesh(grid(6))),
        ("grid far away", mesh(moved(grid(6), 1.0, [4096.0, -10_000.0, 333.3]))),
        ("random far away", mesh(moved(random(4, 500, 1.0, 0.3), 1.0, [1e5, 3e5, -2e5]))),
        ("small on large", mesh(mixed)),
        ("denormal", mesh(random(12, 60, 1e-40, 1e-40))),
        ("enormous", mesh(random(13, 100, 3e38, 3e37))),
        ("grouped", grouped.expect("the groups cover the triangles")),
    ]
}

//! Tables, chairs, shelves, an armchair and lamps. Each stands on y = 0, centred on its own axis.

use crate::modelling::parts::{between, joined, moved, placed, rounded, turned};
use bilux_math::Vec3;
use bilux_scene::Mesh;

/// The height of the table.
pub(super) const TABLE: f32 = 0.75;

/// A table, 1.9 m by 0.95 m, on four turned legs.
pub(crate) fn table(n: u32) -> Mesh {
    let leg = turned(
        &[
            [0.0, 0.70],
            [0.04, 0.70],
            [0.042, 0.60],
            [0.028, 0.57],
            [0.046, 0.52],
            [0.048, 0.44],
            [0.030, 0.30],
            [0.022, 0.10],
            [0.034, 0.06],
            [0.024, 0.01],
            [0.020, 0.0],
            [0.0, 0.0],
        ],
        8 * n,
        2 * n,
    );
    let legs = [[-0.84, -0.37], [-0.84, 0.37], [0.84, -0.37], [0.84, 0.37]];
    let apron = [
        between([-0.84, 0.62, -0.39], [0.84, 0.72, -0.36]),
        between([-0.84, 0.62, 0.36], [0.84, 0.72, 0.39]),
        between([-0.86, 0.62, -0.37], [-0.83, 0.72, 0.37]),
        between([0.83, 0.62, -0.37], [0.86, 0.72, 0.37]),
    ];
    let top = rounded(between([-0.95, 0.715, -0.475], [0.95, TABLE, 0.475]), 0.012, n + 1);
    let legs = legs.map(|[x, z]| moved(&leg, [x, 0.0, z]));
    joined(legs.into_iter().chain(apron.map(|b| rounded(b, 0.004, n))).chain([top]))
}

/// A chair, whose back is towards -z.
pub(crate) fn chair(n: u32) -> Mesh {
    let leg = turned(
        &[[0.0, 0.44], [0.017, 0.44], [0.019, 0.30], [0.015, 0.16], [0.012, 0.01], [0.0, 0.0]],
        5 * n,
        2 * n,
    );
    let splayed = [[-0.18, -0.18], [0.18, -0.18], [-0.19, 0.19], [0.19, 0.19]].map(|[x, z]| {
        let axis = Vec3::new(z, 0.0, -x).normalize();
        placed(&leg, (axis, -4.0), [x * 1.12, 0.0, z * 1.12])
    });
    let rung = turned(&[[0.0, 0.19], [0.008, 0.188], [0.011, 0.0], [0.008, -0.188], [0.0, -0.19]], 4 * n, n);
    let rungs = [[0.20, -0.2], [0.16, 0.2]].map(|[y, z]| placed(&rung, (Vec3::Z, 90.0), [0.0, y, z]));
    let post = rounded(between([-0.014, 0.0, -0.013], [0.014, 0.50, 0.013]), 0.011, n);
    let slat = rounded(between([-0.018, 0.0, -0.006], [0.018, 0.40, 0.006]), 0.005, n);
    let lean = |part: &Mesh, x: f32, y: f32| placed(part, (Vec3::X, -9.0), [x, y, -0.19]);
    let back = [-0.185, 0.185].map(|x| lean(&post, x, 0.45));
    let slats = [-0.11, -0.037, 0.037, 0.11].map(|x| lean(&slat, x, 0.45));
    let rail = rounded(between([-0.215, 0.385, -0.017], [0.215, 0.455, 0.017]), 0.014, n + 1);
    let seat = rounded(between([-0.22, 0.435, -0.21], [0.22, 0.468, 0.22]), 0.016, n + 1);
    let whole = splayed.into_iter().chain(rungs).chain(back).chain(slats);
    joined(whole.chain([lean(&rail, 0.0, 0.45), seat]))
}

/// A cushion for a chair's seat.
pub(crate) fn cushion(n: u32) -> Mesh {
    rounded(between([-0.19, 0.462, -0.18], [0.19, 0.515, 0.20]), 0.026, 3 * n)
}

/// The heights of a shelf's boards, and its width and depth.
pub(super) const BOARDS: [f32; 6] = [0.08, 0.46, 0.82, 1.16, 1.50, 1.86];
pub(super) const SHELF: [f32; 2] = [1.3, 0.3];

/// A shelf, open to the front, which is +z; its back is at z = 0.
pub(crate) fn shelf(n: u32) -> Mesh {
    let [width, depth] = SHELF;
    let (half, top) = (0.5 * width, BOARDS[5] + 0.02);
    let side = between([-0.012, 0.0, 0.0], [0.012, top, depth]);
    let sides = [-half, half].map(|x| moved(&rounded(side, 0.003, n), [x, 0.0, 0.0]));
    let boards = BOARDS.map(|y| {
        rounded(between([-half + 0.012, y - 0.022, 0.008], [half - 0.012, y, depth - 0.004]), 0.003, n)
    });
    let back = rounded(between([-half, 0.02, 0.0], [half, top - 0.01, 0.007]), 0.002, n);
    joined(sides.into_iter().chain(boards).chain([back]))
}

/// A soft armchair, facing +z.
pub(crate) fn armchair(n: u32) -> Mesh {
    let n = 3 * n;
    let arm = rounded(between([-0.085, 0.12, -0.38], [0.085, 0.60, 0.38]), 0.075, n);
    let back = rounded(between([-0.33, 0.0, -0.09], [0.33, 0.62, 0.09]), 0.085, n);
    joined([
        moved(&arm, [-0.39, 0.0, 0.0]),
        moved(&arm, [0.39, 0.0, 0.0]),
        rounded(between([-0.37, 0.12, -0.36], [0.37, 0.32, 0.36]), 0.05, n),
        rounded(between([-0.305, 0.30, -0.26], [0.305, 0.47, 0.40]), 0.075, n),
        placed(&back, (Vec3::X, -12.0), [0.0, 0.36, -0.28]),
    ])
}

/// The armchair's feet.
pub(crate) fn feet(n: u32) -> Mesh {
    let foot = turned(&[[0.0, 0.14], [0.03, 0.13], [0.024, 0.06], [0.016, 0.0], [0.0, 0.0]], 6 * n, n);
    joined([[-0.36, -0.3], [0.36, -0.3], [-0.36, 0.3], [0.36, 0.3]].map(|[x, z]| moved(&foot, [x, 0.0, z])))
}

/// The foot and pole of a lamp whose bulb is 1.48 m up.
pub(crate) fn lamp_stand(n: u32) -> Mesh {
    let outline = [
        [0.0, 1.46],
        [0.018, 1.455],
        [0.018, 1.40],
        [0.011, 1.385],
        [0.011, 0.80],
        [0.017, 0.78],
        [0.011, 0.76],
        [0.011, 0.07],
        [0.03, 0.035],
        [0.14, 0.022],
        [0.15, 0.01],
        [0.15, 0.0],
        [0.0, 0.0],
    ];
    turned(&outline, 12 * n, n)
}

/// A cone of cloth, open at the top and bottom, around a bulb at the origin.
pub(crate) fn shade(n: u32) -> Mesh {
    let outline = [
        [0.118, 0.16],
        [0.121, 0.16],
        [0.165, 0.02],
        [0.211, -0.13],
        [0.208, -0.13],
        [0.162, 0.02],
        [0.118, 0.16],
    ];
    turned(&outline, 20 * n, 2 * n)
}

/// A metal bell with a cord reaching 1 m above, around a bulb at the origin.
pub(crate) fn pendant(n: u32) -> Mesh {
    let bell = [
        [0.0, 0.17],
        [0.022, 0.168],
        [0.028, 0.13],
        [0.06, 0.10],
        [0.135, 0.035],
        [0.19, -0.06],
        [0.205, -0.10],
        [0.199, -0.10],
        [0.184, -0.055],
        [0.13, 0.03],
        [0.05, 0.09],
        [0.0, 0.10],
    ];
    let cord = [[0.0, 1.0], [0.003, 1.0], [0.003, 0.6], [0.003, 0.16], [0.0, 0.16]];
    joined([turned(&bell, 20 * n, 3 * n), turned(&cord, 3 * n, n)])
}

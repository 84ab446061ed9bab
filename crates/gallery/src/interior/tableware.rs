//! Tableware. Each piece stands on y = 0, centred on its own axis.

use crate::modelling::parts::{joined, moved, placed, turned};
use bilux_math::Vec3;
use bilux_scene::Mesh;
use bilux_scene::mesh::shapes::{torus, uv_sphere};

/// A plate, 26 cm wide.
pub(crate) fn plate(n: u32) -> Mesh {
    let outline = [
        [0.0, 0.006],
        [0.075, 0.006],
        [0.085, 0.009],
        [0.118, 0.018],
        [0.130, 0.021],
        [0.131, 0.019],
        [0.115, 0.012],
        [0.082, 0.002],
        [0.078, 0.0],
        [0.0, 0.0],
    ];
    // The outline runs from the centre of the top, around the rim, to the centre of the bottom.
    turned(&outline, 14 * n, 2 * n)
}

/// A cup with a handle.
pub(crate) fn cup(n: u32) -> Mesh {
    let outline = [
        [0.0, 0.008],
        [0.020, 0.010],
        [0.034, 0.035],
        [0.039, 0.078],
        [0.0415, 0.079],
        [0.037, 0.034],
        [0.024, 0.005],
        [0.022, 0.0],
        [0.0, 0.0],
    ];
    let handle = torus(Vec3::ZERO, 0.019, 0.0042, 8 * n, 4 * n);
    joined([turned(&outline, 10 * n, 2 * n), placed(&handle, (Vec3::X, 90.0), [0.054, 0.044, 0.0])])
}

/// A bowl for fruit, 30 cm wide.
pub(crate) fn bowl(n: u32) -> Mesh {
    let outline = [
        [0.0, 0.022],
        [0.05, 0.025],
        [0.105, 0.055],
        [0.142, 0.098],
        [0.148, 0.098],
        [0.112, 0.048],
        [0.062, 0.015],
        [0.058, 0.0],
        [0.0, 0.0],
    ];
    turned(&outline, 16 * n, 2 * n)
}

/// Oranges to fill the bowl.
pub(crate) fn oranges(n: u32) -> Mesh {
    let lower = [[0.045, 0.0], [-0.022, 0.04], [-0.022, -0.04]].map(|[x, z]| [x, 0.072, z]);
    let rim = [[0.085, 0.035], [0.0, 0.092], [-0.085, 0.035], [-0.06, -0.07], [0.06, -0.07]];
    let rim = rim.map(|[x, z]| [x, 0.102, z]);
    let all = lower.into_iter().chain(rim).chain([[0.0, 0.145, 0.0]]);
    joined(all.map(|p| uv_sphere(Vec3::from(p), 0.036, 8 * n, 5 * n)))
}

/// A bellied vase, 32 cm high.
pub(crate) fn vase(n: u32) -> Mesh {
    let outline = [
        [0.026, 0.32],
        [0.030, 0.32],
        [0.024, 0.27],
        [0.045, 0.21],
        [0.083, 0.13],
        [0.070, 0.05],
        [0.045, 0.006],
        [0.044, 0.0],
        [0.0, 0.0],
    ];
    turned(&outline, 14 * n, 3 * n)
}

/// A candlestick, and a candle.
pub(crate) fn candle(n: u32) -> [Mesh; 2] {
    let stick = [
        [0.0, 0.166],
        [0.020, 0.168],
        [0.021, 0.15],
        [0.009, 0.135],
        [0.015, 0.11],
        [0.008, 0.085],
        [0.013, 0.055],
        [0.010, 0.03],
        [0.045, 0.012],
        [0.048, 0.0],
        [0.0, 0.0],
    ];
    let wax = [[0.0, 0.36], [0.009, 0.36], [0.0112, 0.34], [0.0112, 0.17], [0.0, 0.17]];
    [turned(&stick, 10 * n, 3 * n), turned(&wax, 7 * n, n)]
}

/// A flower pot.
pub(crate) fn pot(n: u32) -> Mesh {
    let outline = [
        [0.0, 0.30],
        [0.165, 0.30],
        [0.172, 0.34],
        [0.190, 0.34],
        [0.188, 0.285],
        [0.172, 0.275],
        [0.128, 0.01],
        [0.12, 0.0],
        [0.0, 0.0],
    ];
    moved(&turned(&outline, 16 * n, n), [0.0; 3])
}

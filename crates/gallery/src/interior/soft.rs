//! Curtains, a rug and a plant: curved sheets.

use crate::modelling::parts::{chance, joined, placed, sheet};
use bilux_math::Vec3;
use bilux_math::transcendental::sin_cos;
use bilux_scene::Mesh;
use std::f32::consts::{PI, TAU};

/// A curtain, hanging from y = 0 down to -2.25, 0.75 wide along z, with folds along x.
pub(crate) fn curtain(n: u32) -> Mesh {
    sheet(112 * n, 16 * n, |u, v| {
        let phase = TAU * 6.5 * u + 0.7 * sin_cos(3.0 * v + 9.0 * u).0;
        let deep = 0.035 + 0.035 * v + 0.012 * sin_cos(23.0 * u).0;
        // Gathered by a cord at two thirds of the height.
        let waist = 1.0 - 0.35 * (1.0 - (6.0 * (v - 0.62)).clamp(-1.0, 1.0).abs());
        Vec3::new(
            deep * sin_cos(phase).0 * waist,
            -2.25 * v,
            (0.75 * u - 0.006 * sin_cos(phase * 2.0).0) * waist,
        )
    })
}

/// A rug, 2.6 m by 1.8 m, with the rough surface of wool.
pub(crate) fn rug(n: u32) -> Mesh {
    let (columns, rows) = (56 * n, 40 * n);
    sheet(columns, rows, |u, v| {
        let (i, j) = ((u * columns as f32) as u32, (v * rows as f32) as u32);
        let edge = (u.min(1.0 - u) * 2.6).min(v.min(1.0 - v) * 1.8);
        let pile = (edge * 60.0).min(1.0) * (0.010 + 0.005 * chance(71, j * (columns + 1) + i));
        Vec3::new(1.3 - 2.6 * u, 0.002 + pile, 1.8 * v - 0.9)
    })
}

/// Leaves on stalks, growing upwards and outwards from the middle of a pot.
pub(crate) fn leaves(n: u32) -> Mesh {
    const LEAVES: u32 = 72;
    let leaf = |k: u32| {
        let rise = k as f32 / LEAVES as f32;
        let (length, width) = (0.42 + 0.2 * chance(81, k), 0.05 + 0.022 * chance(82, k));
        let (lift, droop) = (0.30 + 1.1 * rise, 1.4 + 0.6 * chance(83, k));
        let blade = sheet(4 * n, 10 * n, |u, v| {
            let across = (u - 0.5) * 2.0;
            let angle = lift - droop * v * v;
            let (sin, cos) = sin_cos(angle);
            // A thin stalk, then a blade that tapers to a point.
            let broad = 0.06 + 0.94 * sin_cos(PI * ((v - 0.25) / 0.75).clamp(0.0, 1.0)).0;
            let along = length * v * (0.6 + 0.4 * cos);
            let up = length * v * (0.35 + sin);
            Vec3::new(along, up - 0.25 * width * broad * (1.0 - across * across), width * broad * across)
        });
        placed(&blade, (Vec3::Y, 137.5 * k as f32 + 20.0 * chance(84, k)), [0.0, 0.30 + 0.34 * rise, 0.0])
    };
    joined((0..LEAVES).map(leaf))
}

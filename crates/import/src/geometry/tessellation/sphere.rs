//! Spheres around the z axis.

use super::grid;
use bilux_math::glam::DVec3;
use bilux_math::transcendental::sin_cos_f64;
use bilux_scene::Mesh;
use std::f64::consts::PI;

/// Quads around a whole turn.
pub const AROUND: u32 = 192;

/// Quads from pole to pole.
pub const ALONG: u32 = 96;

/// A part of a sphere between two angles to the upper pole.
pub fn part_of_sphere(radius: f64, [from, to]: [f64; 2], turn: f64, around: u32) -> Mesh {
    let mut mesh = Mesh { name: "sphere".to_owned(), ..Mesh::default() };
    let rows = ((f64::from(ALONG) * (from - to).abs() / PI).ceil() as u32).max(1);
    grid::add(&mut mesh, around, rows, turn == 1.0, &|u, v| {
        let theta = from + (to - from) * v;
        let (sin, cos) = match theta {
            // Each pole is exactly one point.
            0.0 => (0.0, 1.0),
            PI => (0.0, -1.0),
            t => sin_cos_f64(t),
        };
        let (sin_phi, cos_phi) = sin_cos_f64(2.0 * PI * turn * u);
        let n = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
        (n * radius, n)
    });
    mesh
}

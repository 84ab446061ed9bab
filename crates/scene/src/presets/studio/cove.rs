//! A cyclorama: a floor that curves up into a wall, so that no edge is visible behind the model.

use super::framing::Framing;
use super::options::GROUND;
use crate::mesh::Mesh;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_2;

/// Lengths in radii of the model: to both sides, behind it before the bend, of the bend, and of the wall above that.
const WIDE: f64 = 20.0;
const BEHIND: f64 = 3.0;
const BEND: f64 = 4.0;
const WALL: f64 = 10.0;
/// The number of strips in the bend.
const STRIPS: u32 = 48;

/// Half of the width of a level floor, in units of the model's radius plus the distance of the camera.
const LEVEL: f64 = 60.0;

/// The height of the ground: slightly below the model, so that a floor of its own stays visible.
fn height(framing: &Framing) -> f64 {
    framing.lowest - framing.radius * 1e-3
}

/// A level floor below a model. Its front faces up, or down if `faces_down`.
pub(super) fn level(framing: &Framing, faces_down: bool) -> Mesh {
    let half = LEVEL * (framing.radius + framing.distance);
    let middle = DVec3::new(framing.middle.x, height(framing), framing.middle.z);
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    let corner = |(x, z): (f64, f64)| (middle + DVec3::new(x, 0.0, z) * half).as_vec3();
    let triangles = if faces_down { vec![[0, 2, 1], [0, 3, 2]] } else { vec![[0, 1, 2], [0, 2, 3]] };
    let positions = corners.map(corner).to_vec();
    Mesh { name: GROUND.to_owned(), positions, triangles, ..Mesh::default() }
}

/// The cove behind a model, as seen by the studio's camera; it also extends behind the camera.
pub(super) fn cove(framing: &Framing) -> Mesh {
    let radius = framing.radius;
    let [right, ..] = framing.axes;
    let away = DVec3::Y.cross(right);
    let foot = DVec3::new(framing.middle.x, height(framing), framing.middle.z);
    let front = -(framing.distance + radius * 8.0);
    let mut profile = vec![(front, 0.0, DVec3::Y)];
    for i in 0..=STRIPS {
        let (sin, cos) = sin_cos_f64(FRAC_PI_2 * f64::from(i) / f64::from(STRIPS));
        profile.push((
            (BEHIND + BEND * sin) * radius,
            BEND * (1.0 - cos) * radius,
            DVec3::Y * cos - away * sin,
        ));
    }
    profile.push(((BEHIND + BEND) * radius, (BEND + WALL) * radius, -away));
    let mut mesh = Mesh { name: GROUND.to_owned(), ..Mesh::default() };
    for (back, up, normal) in profile {
        for side in [-WIDE, WIDE] {
            let p = foot + away * back + DVec3::Y * up + right * (side * radius);
            mesh.positions.push(p.as_vec3());
            mesh.normals.push(normal.as_vec3());
        }
    }
    let strips = (mesh.positions.len() / 2 - 1) as u32;
    mesh.triangles =
        (0..strips).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]]).collect();
    debug_assert!(mesh.positions.iter().all(|p: &Vec3| !p.is_nan()));
    mesh
}

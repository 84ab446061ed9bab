//! Building blocks for furniture: boxes with rounded edges, turned shapes and sheets. All have normals.

use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Aabb, Mat3, Vec2, Vec3};
use bilux_scene::Mesh;
use bilux_scene::mesh::shapes::grid;
use std::f32::consts::{FRAC_PI_2, TAU};

/// A pseudo-random number in 0..1 for one object of a kind.
pub(crate) fn chance(kind: u64, index: u32) -> f32 {
    unit_f32(hash_words([kind, u64::from(index)]) as u32)
}

/// A box between two corners.
pub(crate) fn between(low: [f32; 3], high: [f32; 3]) -> Aabb {
    Aabb { min: Vec3::from(low), max: Vec3::from(high) }
}

/// A closed box with edges rounded to a radius, in `n` segments per quarter circle.
pub(crate) fn rounded(bounds: Aabb, radius: f32, n: u32) -> Mesh {
    let radius = radius.min(0.5 * bounds.extent().min_element());
    let (middle, inner) = (bounds.centre(), bounds.extent() * 0.5 - radius);
    let quarter =
        |k: u32| (k / (n + 1), FRAC_PI_2 * ((k % (n + 1)) as f32 / n as f32 + (k / (n + 1)) as f32));
    // The first and last rows are the centres of the top and bottom.
    let rows = 2 * (n + 1) + 1;
    grid("box", 4 * (n + 1), rows, |i, j| {
        let (side, phi) = quarter(i % (4 * (n + 1)));
        let (half, theta) = quarter(j.clamp(1, rows - 1) - 1);
        let signs = [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]][side as usize % 4];
        let up = if half == 0 { 1.0 } else { -1.0 };
        let ((st, ct), (sp, cp)) = (sin_cos(theta), sin_cos(phi));
        if j == 0 || j == rows {
            let normal = Vec3::Y * up;
            return (middle + normal * (inner.y + radius), normal);
        }
        let normal = Vec3::new(st * cp, ct, -st * sp);
        (middle + inner * Vec3::new(signs[0], up, signs[1]) + normal * radius, normal)
    })
}

/// A closed box with sharp edges: twelve triangles.
pub(crate) fn sharp(bounds: Aabb) -> Mesh {
    let mut mesh = Mesh { name: "box".to_owned(), ..Mesh::default() };
    let (middle, half) = (bounds.centre(), bounds.extent() * 0.5);
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let normal = Vec3::AXES[axis] * sign;
        let (u, v) = (Vec3::AXES[(axis + 1) % 3] * sign, Vec3::AXES[(axis + 2) % 3]);
        let first = mesh.positions.len() as u32;
        let corners = [-u - v, u - v, u + v, v - u];
        mesh.positions.extend(corners.map(|corner| middle + half * (normal + corner)));
        mesh.normals.extend([normal; 4]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

/// A surface of revolution: `outline` runs from the top down along the outside, as radius and height.
///
/// The outline is smooth between its points, in `steps` segments each.
pub(crate) fn turned(outline: &[[f32; 2]], around: u32, steps: u32) -> Mesh {
    let points = smooth(outline, steps.max(1));
    let last = points.len() - 1;
    grid("turned", around, last as u32, |i, j| {
        let j = j as usize;
        // Halfway between the segments on both sides, however short one is: less than a right angle from each.
        let piece = |a: usize| (points[(a + 1).min(last)] - points[a.min(last)]).normalize_or_zero();
        let slope = (piece(j) + if j > 0 { piece(j - 1) } else { Vec2::ZERO }).normalize_or(Vec2::NEG_Y);
        let (sin, cos) = sin_cos(TAU * (i % around) as f32 / around as f32);
        let place = |v: Vec2| Vec3::new(v.x * cos, v.y, -v.x * sin);
        (place(points[j]), place(Vec2::new(-slope.y, slope.x)))
    })
}

/// A smooth curve that passes through each point once.
fn smooth(points: &[[f32; 2]], steps: u32) -> Vec<Vec2> {
    let at = |i: usize| Vec2::from(points[i.min(points.len() - 1)]);
    let mut curve: Vec<Vec2> = (0..(points.len() - 1) as u32 * steps)
        .map(|k| {
            let (i, t) = ((k / steps) as usize, (k % steps) as f32 / steps as f32);
            let (p0, p1, p2, p3) = (at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2));
            let (a, b) = ((p2 - p0) * 0.5, (p3 - p1) * 0.5);
            let p = p1 + (a + ((p2 - p1) * 3.0 - a * 2.0 - b + ((p1 - p2) * 2.0 + a + b) * t) * t) * t;
            // The curve may overshoot, but a radius must not be negative.
            Vec2::new(p.x.max(0.0), p.y)
        })
        .collect();
    curve.push(at(points.len() - 1));
    curve.dedup();
    curve
}

/// A sheet over the unit square; counter-clockwise when seen from the side that ∂v × ∂u points to.
pub(crate) fn sheet(columns: u32, rows: u32, at: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let place = |i: u32, j: u32| at(i as f32 / columns as f32, j as f32 / rows as f32);
    let mut mesh = grid("sheet", columns, rows, |i, j| (place(i, j), Vec3::Y));
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// Joins several meshes into one.
pub(crate) fn joined(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut whole = Mesh::default();
    for part in parts {
        let first = whole.positions.len() as u32;
        whole.positions.extend(part.positions);
        whole.normals.extend(part.normals);
        whole.triangles.extend(part.triangles.iter().map(|t| t.map(|i| first + i)));
    }
    whole
}

/// A copy of the mesh, turned by degrees around an axis and then moved.
pub(crate) fn placed(mesh: &Mesh, turn: (Vec3, f32), by: [f32; 3]) -> Mesh {
    let turn = Mat3::from_axis_angle(turn.0, turn.1.to_radians());
    Mesh {
        name: mesh.name.clone(),
        positions: mesh.positions.iter().map(|&p| turn * p + Vec3::from(by)).collect(),
        normals: mesh.normals.iter().map(|&n| turn * n).collect(),
        triangles: mesh.triangles.clone(),
        ..Mesh::default()
    }
}

/// A copy of the mesh, moved.
pub(crate) fn moved(mesh: &Mesh, by: [f32; 3]) -> Mesh {
    placed(mesh, (Vec3::Y, 0.0), by)
}

//! Curves as tubes and ribbons.

use bilux_math::glam::DVec3;
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::f64::consts::TAU;

/// Raises a curve of degree 2 to degree 3.
pub fn raised(p: &[DVec3]) -> [DVec3; 4] {
    match *p {
        [a, b, c] => [a, a.lerp(b, 2.0 / 3.0), c.lerp(b, 2.0 / 3.0), c],
        [a, b, c, d] => [a, b, c, d],
        _ => [DVec3::ZERO; 4],
    }
}

/// The Bézier segment of uniform B-spline points. [Farin 2002, 8]
pub fn of_bspline(p: &[DVec3]) -> [DVec3; 4] {
    match *p {
        [a, b, c] => raised(&[a.midpoint(b), b, b.midpoint(c)]),
        [a, b, c, d] => {
            let (b1, b2) = (b.lerp(c, 1.0 / 3.0), b.lerp(c, 2.0 / 3.0));
            [a.lerp(b, 2.0 / 3.0).midpoint(b1), b1, b2, b2.midpoint(c.lerp(d, 1.0 / 3.0))]
        }
        _ => [DVec3::ZERO; 4],
    }
}

/// Points along a curve with unit tangents.
pub fn spine(segments: &[[DVec3; 4]], pieces: u32) -> Vec<(DVec3, DVec3)> {
    let mut spine: Vec<(DVec3, DVec3)> = Vec::with_capacity(segments.len() * pieces as usize + 1);
    for (s, [a, b, c, d]) in segments.iter().enumerate() {
        for i in u32::from(s > 0)..=pieces {
            let t = f64::from(i) / f64::from(pieces);
            let (ab, bc, cd) = (a.lerp(*b, t), b.lerp(*c, t), c.lerp(*d, t));
            let (abc, bcd) = (ab.lerp(bc, t), bc.lerp(cd, t));
            let before = spine.last().map_or(DVec3::Z, |(_, direction)| *direction);
            let direction = (bcd - abc).try_normalize().or((*d - *a).try_normalize()).unwrap_or(before);
            spine.push((abc.lerp(bcd, t), direction));
        }
    }
    spine
}

fn width_at(widths: [f64; 2], i: usize, count: usize) -> (f64, f64) {
    let t = i as f64 / (count - 1).max(1) as f64;
    (t, widths[0] + (widths[1] - widths[0]) * t)
}

/// Rings around the spine, with rotation-minimising frames. [Bishop 1975]
pub fn tube(spine: &[(DVec3, DVec3)], widths: [f64; 2], around: u32) -> Mesh {
    tube_of_widths(spine, |i| width_at(widths, i, spine.len()).1, around)
}

/// Rings as those of [`tube`], with a width at each point of the spine.
pub fn tube_of_widths(spine: &[(DVec3, DVec3)], width_of: impl Fn(usize) -> f64, around: u32) -> Mesh {
    let mut mesh = Mesh { name: "curve".to_owned(), ..Mesh::default() };
    let mut side = spine.first().map_or(DVec3::X, |(_, direction)| direction.any_orthonormal_vector());
    for (i, (p, direction)) in spine.iter().enumerate() {
        let flat = side - *direction * direction.dot(side);
        side = flat.try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector());
        let across = direction.cross(side);
        let (t, width) = (i as f64 / (spine.len() - 1).max(1) as f64, width_of(i));
        for k in 0..=around {
            let (sin, cos) = sin_cos_f64(TAU * f64::from(k % around) / f64::from(around));
            let n = side * cos + across * sin;
            mesh.positions.push((*p + n * (0.5 * width)).as_vec3());
            mesh.normals.push(n.as_vec3());
            mesh.uvs.push(Vec2::new(t as f32, k as f32 / around as f32));
        }
    }
    rows(&mut mesh, spine.len() as u32, around + 1);
    // Makes the surface face outwards.
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// A flat ribbon perpendicular to its normals.
pub fn strip(spine: &[(DVec3, DVec3)], widths: [f64; 2], normals: &[Vec3]) -> Mesh {
    let mut mesh = Mesh { name: "curve".to_owned(), ..Mesh::default() };
    for (i, (p, direction)) in spine.iter().enumerate() {
        let (t, width) = width_at(widths, i, spine.len());
        let place = t as f32 * (normals.len() - 1) as f32;
        let k = (place as usize).min(normals.len().saturating_sub(2));
        let n = normals[k].lerp(normals[(k + 1).min(normals.len() - 1)], place - k as f32).as_dvec3();
        let across =
            n.cross(*direction).try_normalize().unwrap_or_else(|| direction.any_orthonormal_vector());
        for (v, half) in [(0.0, -0.5), (1.0, 0.5)] {
            mesh.positions.push((*p + across * (half * width)).as_vec3());
            mesh.normals.push(direction.cross(across).as_vec3());
            mesh.uvs.push(Vec2::new(t as f32, v));
        }
    }
    rows(&mut mesh, spine.len() as u32, 2);
    mesh
}

/// Connects rows of `width` points with triangles.
fn rows(mesh: &mut Mesh, count: u32, width: u32) {
    for (row, i) in (0..count.saturating_sub(1)).flat_map(|row| (0..width - 1).map(move |i| (row, i))) {
        let at = |dr: u32, di: u32| (row + dr) * width + i + di;
        let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_tube_faces_outwards() {
        let line = raised(&[DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0]);
        let mesh = tube(&spine(&[line], 4), [1.0, 0.5], 8);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let outwards = ((a + b + c) / 3.0) * Vec3::new(1.0, 1.0, 0.0);
            assert!((b - a).cross(c - a).dot(outwards) > 0.0);
        }
    }

    #[test]
    fn bsplines_of_even_points_are_lines() {
        let p: Vec<DVec3> = (0..4).map(|i| DVec3::X * f64::from(i)).collect();
        let [a, _, _, d] = of_bspline(&p);
        assert!((a - DVec3::X).length() < 1e-12 && (d - DVec3::X * 2.0).length() < 1e-12);
        let [a, _, _, d] = of_bspline(&p[..3]);
        assert!((a.x - 0.5).abs() < 1e-12 && (d.x - 1.5).abs() < 1e-12);
    }
}

//! Tessellates curved surfaces into grids of triangles.

use bilux_math::Vec2;
use bilux_math::glam::DVec3;
use bilux_scene::Mesh;

/// The point and normal of a surface at two coordinates from 0 to 1.
pub type Surface<'s> = &'s dyn Fn(f64, f64) -> (DVec3, DVec3);

/// Adds a surface as a grid of quads with two triangles each.
///
/// It faces the cross product of its derivatives by the first and the second coordinate. Triangles with coinciding
/// corners are left out. If `closes` is set, the last column repeats the first exactly.
pub fn add(mesh: &mut Mesh, columns: u32, rows: u32, closes: bool, at: Surface) {
    let first = mesh.positions.len() as u32;
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
        let (position, normal) = at(if closes && i == columns { 0.0 } else { u }, v);
        mesh.positions.push(position.as_vec3());
        mesh.normals.push(normal.as_vec3());
        mesh.uvs.push(Vec2::new(u as f32, v as f32));
    }
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let corner = |di: u32, dj: u32| first + (j + dj) * (columns + 1) + i + di;
        let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|k| mesh.positions[k as usize]);
            if p != q && q != r && r != p {
                mesh.triangles.push(triangle);
            }
        }
    }
}

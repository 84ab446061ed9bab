//! Moves the vertices of a tessellated mesh.

use super::map::{Along, Displacement};
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::HashMap;

/// The mesh, moved as the map says, with the normals of its new shape.
///
/// Vertices at one place move together, whatever their normals and texture coordinates: what was closed stays closed.
pub fn moved(mut mesh: Mesh, map: &Displacement) -> Mesh {
    let places = numbered(mesh.positions.iter().map(|p| bits(*p)));
    let normals = if mesh.normals.is_empty() { face_normals(&mesh) } else { unit(&mesh.normals) };
    let shared = averages(&places, normals.iter().copied());
    let uvs = map.uvs(&mesh);
    let tangents = if map.along == Along::Tangents { tangents(&mesh, uvs) } else { Vec::new() };
    let steps = (0..mesh.positions.len()).map(|i| {
        let normal = shared[places[i] as usize].normalize_or_zero();
        let finite = |step: Vec3| if step.is_finite() { step } else { Vec3::ZERO };
        finite(
            match map.along {
                Along::Normal => normal * (map.map.number(uvs[i]) - map.middle),
                along => {
                    let values = map.map.at(uvs[i]).to_array().map(|value| value - map.middle);
                    let [x, y, z] = values;
                    if along == Along::Axes {
                        Vec3::from_array(values)
                    } else {
                        let [tangent, bitangent] = tangents[i];
                        tangent * x + normal * y + bitangent * z
                    }
                }
            } * map.scale,
        )
    });
    let steps: Vec<Vec3> = steps.collect();
    let steps = averages(&places, steps.into_iter());
    // Normals are shared where they were the same before, so that edges that were sharp still are.
    let smooth = numbered(places.iter().enumerate().map(|(i, place)| {
        let normal = mesh.normals.get(i).map_or([0; 3], |normal| bits(*normal));
        (*place, normal)
    }));
    for (position, place) in mesh.positions.iter_mut().zip(&places) {
        *position += steps[*place as usize];
    }
    let by_vertex = face_normals(&mesh);
    let mut sums = vec![Vec3::ZERO; smooth.iter().max().map_or(0, |last| *last as usize + 1)];
    smooth.iter().zip(&by_vertex).for_each(|(group, normal)| sums[*group as usize] += *normal);
    mesh.normals =
        smooth.iter().map(|group| sums[*group as usize].try_normalize().unwrap_or(Vec3::Y)).collect();
    mesh
}

/// Positions with the same bits are one place; minus zero is zero.
fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

/// Equal things get equal numbers, from zero on.
fn numbered<T: Eq + std::hash::Hash>(things: impl Iterator<Item = T>) -> Vec<u32> {
    let mut known = HashMap::new();
    things
        .map(|thing| {
            let next = known.len() as u32;
            *known.entry(thing).or_insert(next)
        })
        .collect()
}

/// The mean of what the vertices at each place have.
fn averages(places: &[u32], values: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
    let count = places.iter().max().map_or(0, |last| *last as usize + 1);
    let mut sums = vec![(Vec3::ZERO, 0.0f32); count];
    for (place, value) in places.iter().zip(values) {
        let (sum, count) = &mut sums[*place as usize];
        *sum += value;
        *count += 1.0;
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

fn unit(normals: &[Vec3]) -> Vec<Vec3> {
    normals.iter().map(|normal| normal.normalize_or_zero()).collect()
}

/// For each vertex the sum of the normals of its triangles, weighted by area.
fn face_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|&i| sums[i as usize] += normal);
    }
    sums
}

/// For each vertex the directions in which its texture coordinates grow, of unit length.
fn tangents(mesh: &Mesh, uvs: &[Vec2]) -> Vec<[Vec3; 2]> {
    let mut sums = vec![[Vec3::ZERO; 2]; mesh.positions.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize]);
        let [p, q, r] = corners.map(|i| uvs[i as usize]);
        let (e, f, s, t) = (b - a, c - a, q - p, r - p);
        let turn = s.perp_dot(t).signum();
        let directions = [(e * t.y - f * s.y) * turn, (f * s.x - e * t.x) * turn];
        for &i in corners {
            sums[i as usize][0] += directions[0];
            sums[i as usize][1] += directions[1];
        }
    }
    sums.into_iter().map(|pair| pair.map(Vec3::normalize_or_zero)).collect()
}

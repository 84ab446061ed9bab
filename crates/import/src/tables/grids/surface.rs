//! The surface of a level set: where the distance is 0. A net with a vertex in each cube of eight voxels that it passes
//! through, and one on each edge that it crosses, at the resolution of the grid. [Gibson 1998]

use bilux_math::{DMat4, DVec3, Vec3};
use bilux_scene::Mesh;
use bilux_scene::media::{BLOCK, BLOCK_VOXELS};
use std::collections::{BTreeMap, HashMap};

/// Voxels along the side of a block.
const SIDE: i64 = BLOCK as i64;

/// The voxels of a leaf with x varying slowest, as in the formats of trees.
pub type LeafValues = [f32; BLOCK_VOXELS];

/// Distances by block; those that no block has are unknown, and far from the surface.
pub(super) struct Distances {
    /// By the block's first voxel over [`SIDE`].
    pub(super) blocks: BTreeMap<[i64; 3], Box<LeafValues>>,
}

/// The corners of a cube of voxels, x varying fastest.
const CORNERS: [[i64; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

/// The distances of a block and of the voxels that follow it along each axis, x varying fastest; NaN where they are unknown.
struct Near([f32; NEAR * NEAR * NEAR]);

const NEAR: usize = BLOCK + 1;

impl Near {
    fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.0[(z * NEAR + y) * NEAR + x]
    }
}

/// An edge that the surface crosses: the voxel that it begins at, its axis, where on it, and whether it leads outwards.
type Crossing = ([i64; 3], usize, f64, bool);

impl Distances {
    /// The surface; `map` takes the indices of voxels to the space of the file. It faces where distances are positive.
    pub(super) fn surface(&self, map: &DMat4) -> Mesh {
        let mut net = Net { mesh: Mesh::default(), vertices: HashMap::new() };
        let mut crossings: Vec<Crossing> = Vec::new();
        let to_normals = map.inverse().transpose();
        for block in self.blocks.keys() {
            let near = self.near(*block);
            // Cubes and edges belong to the block of their first voxel.
            for i in 0..BLOCK_VOXELS {
                let within = [i % BLOCK, i / BLOCK % BLOCK, i / (BLOCK * BLOCK)];
                let voxel = [0, 1, 2].map(|axis: usize| block[axis] * SIDE + within[axis] as i64);
                let corners = CORNERS.map(|by| {
                    f64::from(near.at([0, 1, 2].map(|axis: usize| within[axis] + by[axis] as usize)))
                });
                for axis in 0..3 {
                    let (from, to) = (corners[0], corners[1 << axis]);
                    if !from.is_nan() && !to.is_nan() && (from < 0.0) != (to < 0.0) {
                        crossings.push((voxel, axis, from / (from - to), from < 0.0));
                    }
                }
                if let Some((place, slope)) = vertex(&corners) {
                    let at = map.transform_point3(DVec3::from(voxel.map(|x| x as f64)) + place);
                    net.vertices.insert(voxel, net.mesh.positions.len() as u32);
                    net.mesh.positions.push(at.as_vec3());
                    let normal = to_normals.transform_vector3(slope).normalize_or_zero();
                    net.mesh.normals.push(normal.as_vec3());
                }
            }
        }
        let is_mirrored = map.determinant() < 0.0;
        for (voxel, axis, part, is_outwards) in crossings {
            let mut at = DVec3::from(voxel.map(|x| x as f64));
            at[axis] += part;
            let middle = map.transform_point3(at).as_vec3();
            net.quad(voxel, axis, middle, is_outwards != is_mirrored);
        }
        net.mesh
    }

    fn near(&self, block: [i64; 3]) -> Near {
        let mut near = Near([f32::NAN; NEAR * NEAR * NEAR]);
        for by in CORNERS {
            let Some(values) = self.blocks.get(&moved(block, by)) else { continue };
            let [x, y, z] = by.map(|by| if by == 0 { 0..BLOCK } else { BLOCK..NEAR });
            for (x, y, z) in z
                .flat_map(|z| y.clone().map(move |y| (y, z)))
                .flat_map(|(y, z)| x.clone().map(move |x| (x, y, z)))
            {
                let value = values[((x % BLOCK) * BLOCK + y % BLOCK) * BLOCK + z % BLOCK];
                near.0[(z * NEAR + y) * NEAR + x] = if value.is_finite() { value } else { f32::NAN };
            }
        }
        near
    }
}

/// A mesh under construction.
struct Net {
    mesh: Mesh,
    /// The vertex in each cube that has one, by its first voxel.
    vertices: HashMap<[i64; 3], u32>,
}

impl Net {
    /// Adds the triangles around an edge from a voxel along an axis, which the surface crosses at `middle`: counter-clockwise seen
    /// from its end or from its start.
    fn quad(&mut self, voxel: [i64; 3], axis: usize, middle: Vec3, is_seen_from_end: bool) {
        let step = |axis: usize, by: i64| [0, 1, 2].map(|i: usize| if i == axis { by } else { 0 });
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let corner =
            |[a, b]: [i64; 2]| self.vertices.get(&moved(moved(voxel, step(u, a)), step(v, b))).copied();
        let [Some(a), Some(b), Some(c), Some(d)] = [[-1, -1], [0, -1], [0, 0], [-1, 0]].map(corner) else {
            return;
        };
        let around = if is_seen_from_end { [a, b, c, d] } else { [d, c, b, a] };
        let centre = self.mesh.positions.len() as u32;
        let normal = around.map(|i| self.mesh.normals[i as usize]).into_iter().sum::<Vec3>();
        self.mesh.positions.push(middle);
        self.mesh.normals.push(normal.normalize_or_zero());
        self.mesh.triangles.extend((0..4).map(|i| [around[i], around[(i + 1) % 4], centre]));
    }
}

fn moved(voxel: [i64; 3], by: [i64; 3]) -> [i64; 3] {
    [0, 1, 2].map(|axis: usize| voxel[axis] + by[axis])
}

/// Point where a surface passes through a cube, from 0 to 1 along each axis, and the slope of the distance there; `None` if
/// it does not.
fn vertex(corners: &[f64; 8]) -> Option<(DVec3, DVec3)> {
    let is_inside = corners.map(|distance| distance < 0.0);
    if corners.iter().any(|distance| distance.is_nan())
        || is_inside.iter().all(|inside| *inside == is_inside[0])
    {
        return None;
    }
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (i, from) in CORNERS.iter().enumerate() {
        for axis in (0..3).filter(|axis| from[*axis] == 0) {
            let j = i + (1 << axis);
            if is_inside[i] != is_inside[j] {
                let mut at = DVec3::from(from.map(|x| x as f64));
                at[axis] = corners[i] / (corners[i] - corners[j]);
                sum += at;
                count += 1.0;
            }
        }
    }
    let mean = sum / count;
    // The mean of the crossings lies inside of a bend: one step of Newton's method takes it to the surface.
    let (distance, slope) = interpolated(corners, mean);
    let place = mean - slope * (distance / slope.length_squared().max(f64::MIN_POSITIVE));
    let place = if place.is_finite() { place.clamp(DVec3::ZERO, DVec3::ONE) } else { mean };
    Some((place, interpolated(corners, place).1))
}

/// The trilinear interpolation of a cube, and its gradient.
fn interpolated(corners: &[f64; 8], at: DVec3) -> (f64, DVec3) {
    let (mut value, mut slope) = (0.0, DVec3::ZERO);
    for (corner, by) in corners.iter().zip(CORNERS) {
        let part = |axis: usize| if by[axis] == 1 { at[axis] } else { 1.0 - at[axis] };
        let sign = |axis: usize| if by[axis] == 1 { 1.0 } else { -1.0 };
        value += corner * part(0) * part(1) * part(2);
        slope +=
            DVec3::new(sign(0) * part(1) * part(2), part(0) * sign(1) * part(2), part(0) * part(1) * sign(2))
                * *corner;
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane that is askew: all vertices lie on it, all normals are its own, and the area is that of the closed form.
    #[test]
    fn a_plane_is_a_plane() {
        let normal = DVec3::new(2.0, -1.0, 2.0) / 3.0;
        let mut blocks = BTreeMap::new();
        for i in 0..8i64 {
            let block = [i & 1, i >> 1 & 1, i >> 2];
            let mut values = Box::new([f32::NAN; BLOCK_VOXELS]);
            for (i, value) in values.iter_mut().enumerate() {
                let within = [i / (BLOCK * BLOCK), i / BLOCK % BLOCK, i % BLOCK];
                let at = DVec3::from(
                    [0, 1, 2].map(|axis: usize| (block[axis] * SIDE) as f64 + within[axis] as f64),
                );
                *value = (normal.dot(at) - 7.25) as f32;
            }
            blocks.insert(block, values);
        }
        let map = DMat4::from_scale(DVec3::splat(0.5));
        let mesh = Distances { blocks }.surface(&map);
        assert!(mesh.triangles.len() > 100);
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((normal.dot(p.as_dvec3()) - 3.625).abs() < 1e-5, "{p}");
            assert!((n.as_dvec3() - normal).length() < 1e-5, "{n}");
        }
        let faces = mesh.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a)
        });
        assert!(
            faces.into_iter().all(|face: Vec3| face.as_dvec3().dot(normal) >= -1e-7),
            "they face outwards"
        );
    }
}

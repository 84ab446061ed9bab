//! New normals for a mesh whose points have moved in a way that only their places tell.

use super::layer::{Layer, Mapping};
use super::mesh::PolygonMesh;
use super::workshop::Workshop;
use crate::FormatError;
use bilux_math::Vec3;
use std::collections::HashMap;

impl PolygonMesh {
    /// Replaces normals by those of the places of the points: corners of a point that shared a normal share one again, the mean
    /// of their polygons by area, so that sharp edges stay sharp. A mesh without normals stays so.
    pub fn renew_normals(&mut self, workshop: &mut Workshop, file: &str) -> Result<(), FormatError> {
        if self.normals.is_empty() {
            return Ok(());
        }
        let corners = self.polygons.corners.len();
        let needed = corners * (size_of::<[(Vec3, [u32; 5]); 2]>() + size_of::<(Vec3, u32)>());
        workshop.budget.take_bytes(needed as u64, file)?;
        let mut sums: Vec<Vec3> = Vec::new();
        let mut of_corner: Vec<i32> = Vec::with_capacity(corners);
        let mut known: HashMap<(u32, [u32; 3]), i32> = HashMap::with_capacity(corners);
        for polygon in 0..self.polygons.len() {
            let range = self.polygons.start(polygon)..self.polygons.ends[polygon] as usize;
            let at = |corner: usize| self.positions[self.polygons.corners[corner] as usize];
            let first = at(range.start);
            let area = (range.start + 2..range.end)
                .fold(Vec3::ZERO, |sum, i| sum + (at(i - 1) - first).cross(at(i) - first));
            for corner in range {
                let point = self.polygons.corners[corner];
                let old = self.normals.at(corner, polygon, point as usize).unwrap_or(Vec3::ZERO);
                let next = sums.len() as i32;
                let number = *known.entry((point, old.to_array().map(f32::to_bits))).or_insert(next);
                if number == next {
                    sums.push(Vec3::ZERO);
                }
                sums[number as usize] += area;
                of_corner.push(number);
            }
        }
        sums.iter_mut().for_each(|sum| *sum = sum.normalize_or_zero());
        self.normals = Layer::indexed(sums, of_corner, Mapping::ByCorner);
        Ok(())
    }
}

//! A mesh as a file has it.

use super::layer::{Layer, Mapping};
use super::polygons::Polygons;
use super::workshop::Workshop;
use crate::FormatError;
use crate::geometry::colours::{Stored, decode};
use crate::geometry::deformation::{are_mirrored, move_points, turned};
use crate::geometry::normals::{BY_ANGLE, FLAT, Faces, Smoothing};
use bilux_math::{DMat4, Rgb, Vec2, Vec3};
use bilux_scene::Span;

/// The polygons of a mesh with what their corners have.
#[derive(Default)]
pub struct PolygonMesh {
    pub name: String,
    /// The control points.
    pub positions: Vec<Vec3>,
    pub polygons: Polygons,
    pub normals: Layer<Vec3>,
    /// The sets of texture coordinates in use.
    pub uvs: [Layer<Vec2>; 2],
    /// Diffuse reflectances.
    pub colours: Layer<Rgb>,
    /// The number of each polygon's material among those of its mesh.
    pub materials: Layer<i32>,
    pub smoothing: Layer<i32>,
    /// True if its transform has mirrored it, so that its corners run the other way round.
    pub is_mirrored: bool,
}

impl PolygonMesh {
    /// Adds normals if there are none, by smoothing groups or the crease angle.
    pub fn add_normals(&mut self, workshop: &mut Workshop, file: &str) -> Result<(), FormatError> {
        if !self.normals.is_empty() || workshop.crease_angle <= 0.0 {
            return Ok(());
        }
        let corners = self.polygons.corners.len();
        let needed = 24 * corners + 28 * self.polygons.len() + 24 * self.positions.len();
        workshop.budget.take_bytes(needed as u64, file)?;
        let smoothing = self.smoothing_of_faces();
        let faces = Faces {
            positions: &self.positions,
            corners: std::mem::take(&mut self.polygons.corners),
            ends: &self.polygons.ends,
            smoothing,
        };
        let (found, are_needed) = faces.normals_and_whether_needed(workshop.crease_angle);
        self.polygons.corners = found.corners().collect();
        if are_needed {
            let indices = found.of_corner.into_iter().map(|index| index as i32).collect();
            self.normals = Layer::indexed(found.normals, indices, Mapping::ByCorner);
        }
        Ok(())
    }

    /// Replaces each normal by what `turn` makes of it and of its control point.
    pub fn turn_normals(
        &mut self,
        workshop: &mut Workshop,
        file: &str,
        turn: impl Fn(Vec3, usize) -> Vec3,
    ) -> Result<(), FormatError> {
        if self.normals.is_empty() {
            return Ok(());
        }
        workshop.budget.take_bytes(12 * self.polygons.corners.len() as u64, file)?;
        let mut turned = Vec::with_capacity(self.polygons.corners.len());
        for polygon in 0..self.polygons.len() {
            for corner in self.polygons.start(polygon)..self.polygons.ends[polygon] as usize {
                let vertex = self.polygons.corners[corner] as usize;
                let normal = self.normals.at(corner, polygon, vertex).unwrap_or(Vec3::ZERO);
                turned.push(turn(normal, vertex));
            }
        }
        self.normals = Layer::indexed(turned, Vec::new(), Mapping::ByCorner);
        Ok(())
    }

    /// Groups of faces that are smooth towards each other, if the file has them.
    fn smoothing_of_faces(&self) -> Vec<Smoothing> {
        if self.smoothing.is_empty() || self.smoothing.mapping() != Mapping::ByPolygon {
            return vec![BY_ANGLE];
        }
        let group = |face: usize| self.smoothing.at(0, face, 0).map_or(FLAT, |group| group as Smoothing);
        (0..self.polygons.len()).map(group).collect()
    }

    /// The number of the material of each polygon; a single one if all have the same.
    pub fn materials_of_faces(&self) -> Vec<i32> {
        let of = |face: usize| {
            let (first, corner) =
                (self.polygons.start(face), self.polygons.corners.get(self.polygons.start(face)));
            self.materials.at(first, face, corner.map_or(0, |c| *c as usize)).unwrap_or(0).max(0)
        };
        if self.materials.is_empty() || self.materials.mapping() == Mapping::AllSame {
            return vec![of(0)];
        }
        (0..self.polygons.len()).map(of).collect()
    }

    /// Moves each control point by its own matrix, with the normals there.
    pub fn bend(&mut self, by: &[DMat4], workshop: &mut Workshop, file: &str) -> Result<(), FormatError> {
        move_points(&mut self.positions, by);
        self.turn_normals(workshop, file, |normal, vertex| turned(normal, &by[vertex]))?;
        if are_mirrored(by) {
            self.is_mirrored = true;
        }
        Ok(())
    }
}

/// Stored colours as reflectances. If all are black they are data of some program.
pub fn reflectances(mut colours: Layer<Rgb>, workshop: &mut Workshop, at: impl Fn() -> Span) -> Layer<Rgb> {
    if colours.values().iter().all(|colour| colour.is_black()) {
        if !colours.is_empty() {
            workshop.diagnostics.not_used("colours of vertices that are all black", at);
        }
        return Layer::default();
    }
    decode(colours.values_mut(), Stored::Numbers);
    colours
}

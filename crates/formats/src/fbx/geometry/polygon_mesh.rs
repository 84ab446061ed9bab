//! A mesh as the file has it.

use super::layers::{self, Layer, Mapping};
use super::polygons::Polygons;
use super::workshop::Workshop;
use crate::FormatError;
use crate::colours::{Stored, decode};
use crate::normals::{BY_ANGLE, FLAT, Faces, Smoothing};
use bilux_math::{Rgb, Vec2, Vec3};

use crate::fbx::tree::Node;

/// The polygons of a mesh with what their corners have.
pub(in crate::fbx) struct Geometry {
    pub(in crate::fbx) name: String,
    /// The control points.
    pub(in crate::fbx) positions: Vec<Vec3>,
    pub(in crate::fbx) polygons: Polygons,
    pub(in crate::fbx) normals: Layer<Vec3>,
    /// The sets of texture coordinates in use.
    pub(in crate::fbx) uvs: [Layer<Vec2>; 2],
    /// Diffuse reflectances.
    pub(in crate::fbx) colours: Layer<Rgb>,
    /// The number of each polygon's material among those of its node.
    materials: Layer<i32>,
    smoothing: Layer<i32>,
    /// True if its transform has mirrored it, so that its corners run the other way round.
    pub(in crate::fbx) is_mirrored: bool,
}

impl Geometry {
    /// The mesh at a node of the file; `None` if it has no polygons. `has_second_uvs` tells whether a second set of texture
    /// coordinates is wanted.
    pub(in crate::fbx) fn read(
        node: Node,
        name: String,
        has_second_uvs: bool,
        workshop: &mut Workshop,
    ) -> Result<Option<Geometry>, FormatError> {
        let (Some(vertices), Some(indices)) = (node.child("Vertices"), node.child("PolygonVertexIndex"))
        else {
            return Ok(None);
        };
        let numbers: Vec<f32> = vertices.numbers(workshop.budget)?;
        workshop.budget.take_bytes(4 * numbers.len() as u64, node.file())?;
        let positions: Vec<Vec3> = numbers.as_chunks::<3>().0.iter().copied().map(Vec3::from).collect();
        workshop.budget.release(4 * numbers.len() as u64);
        drop(numbers);
        if positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
            workshop.oddities.note(what, || vertices.at());
        }
        let polygons = Polygons::read(indices, positions.len(), workshop)?;
        if polygons.len() == 0 {
            return Ok(None);
        }
        let mut sets = layers::nodes(node, "LayerElementUV").into_iter();
        let mut uvs = |is_wanted: bool| match sets.next().filter(|_| is_wanted) {
            Some(layer) => Layer::read(layer, "UV", "UVIndex", |[u, v]: [f32; 2]| Vec2::new(u, v), workshop),
            None => Ok(Layer::default()),
        };
        let uvs = [uvs(true)?, uvs(has_second_uvs)?];
        let first = |element: &str| layers::nodes(node, element).into_iter().next();
        let normals = match first("LayerElementNormal") {
            Some(layer) => {
                Layer::read(layer, "Normals", "NormalsIndex", |n: [f32; 3]| Vec3::from(n), workshop)?
            }
            None => Layer::default(),
        };
        let integers = |element: &str, list: &'static str, workshop: &mut Workshop| match first(element) {
            Some(layer) => Layer::read(layer, list, "", |[number]: [i32; 1]| number, workshop),
            None => Ok(Layer::default()),
        };
        let materials = integers("LayerElementMaterial", "Materials", workshop)?;
        let smoothing = integers("LayerElementSmoothing", "Smoothing", workshop)?;
        let colours = match first("LayerElementColor") {
            Some(layer) => colours(layer, workshop)?,
            None => Layer::default(),
        };
        Ok(Some(Geometry {
            name,
            positions,
            polygons,
            normals,
            uvs,
            colours,
            materials,
            smoothing,
            is_mirrored: false,
        }))
    }

    /// Adds normals if there are none, by smoothing groups or the crease angle.
    pub(in crate::fbx) fn add_normals(
        &mut self,
        workshop: &mut Workshop,
        file: &str,
    ) -> Result<(), FormatError> {
        if !self.normals.is_empty() || workshop.crease_angle <= 0.0 {
            return Ok(());
        }
        let corners = self.polygons.corners.len();
        let needed = 24 * corners + 28 * self.polygons.len() + 24 * self.positions.len();
        workshop.budget.take_bytes(needed as u64, file)?;
        let faces = Faces {
            positions: &self.positions,
            corners: self.polygons.corners.clone(),
            ends: self.polygons.ends.clone(),
            smoothing: self.smoothing_of_faces(),
        };
        if let Some(found) = faces.corner_normals(workshop.crease_angle) {
            let indices = found.of_corner.into_iter().map(|index| index as i32).collect();
            self.normals = Layer::indexed(found.normals, indices, Mapping::ByCorner);
        }
        Ok(())
    }

    /// Replaces each normal by what `turn` makes of it and of its control point.
    pub(in crate::fbx) fn turn_normals(
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
    pub(super) fn materials_of_faces(&self) -> Vec<i32> {
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
}

/// The colours of a layer. If all are black they are data of some program.
fn colours(layer: Node, workshop: &mut Workshop) -> Result<Layer<Rgb>, FormatError> {
    let rgb = |[r, g, b, _]: [f32; 4]| Rgb::new(r, g, b);
    let mut colours = Layer::read(layer, "Colors", "ColorIndex", rgb, workshop)?;
    if colours.values().iter().all(|colour| colour.is_black()) {
        workshop.oddities.not_used("colours of vertices that are all black", || layer.at());
        return Ok(Layer::default());
    }
    decode(colours.values_mut(), Stored::Numbers);
    Ok(colours)
}

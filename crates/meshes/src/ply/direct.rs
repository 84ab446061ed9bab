//! Reads faces directly into triangles if vertices have normals: nothing has to be welded, and each list is read
//! once.

use super::body::Body;
use super::header::{Element, Scalar};
use super::reader::Ply;
use super::slots::lists_vertices;
use bilux_import::FormatError;
use bilux_import::geometry::polygon::Triangulator;
use bilux_import::input::reading::plain_material;
use bilux_import::meshes::indexed_faces::NONE;
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::collections::HashMap;
use std::sync::Arc;

/// True for faces with a single property, the list of vertices.
pub(super) fn can_be(element: &Element) -> bool {
    matches!(&element.properties[..], [only] if lists_vertices(only))
}

impl Ply<'_, '_, '_> {
    /// Reads the faces of an element as triangles.
    pub(super) fn triangles_of(&mut self, element: &Element) -> Result<Vec<[u32; 3]>, FormatError> {
        let (list, file) = (&element.properties[0], self.source.name);
        let known = self.indexed.positions.len() as u64;
        let mut triangles = Vec::new();
        // There are no more rows than bytes, so the size of the file bounds this.
        self.reading.budget.take_bytes(element.count * size_of::<[u32; 3]>() as u64, file)?;
        triangles.reserve_exact(element.count as usize);
        let mut triangulator = Triangulator::default();
        let mut corners: Vec<u32> = Vec::new();
        for _ in 0..element.count {
            let start = self.body.offset();
            if let Some(triangle) = self.body.triangle(list.count, list.scalar, known) {
                triangles.push(triangle);
                continue;
            }
            let count = self.body.integer(list.count.unwrap_or(list.scalar))?;
            corners.clear();
            for _ in 0..count {
                let index = self.body.integer(list.scalar)?;
                if !(0..known as i64).contains(&index) {
                    let message = match index < 0 {
                        true => format!("this face refers to vertex {index}: vertices are counted from 0"),
                        false => format!(
                            "this face refers to vertex {index}, but the file has only {known}, counted from 0"
                        ),
                    };
                    return Err(FormatError::malformed(message, self.places.at(start)));
                }
                self.reading.budget.take::<[u32; 3]>(usize::from(corners.len() > 2), file)?;
                corners.push(index as u32);
            }
            self.end_row(start);
            if corners.len() < 3 {
                let (places, what) = (self.places, "a face has fewer than 3 corners and is left out");
                self.diagnostics.note(what, || places.at(start));
                continue;
            }
            let points = corners.iter().map(|&i| self.indexed.positions[i as usize]);
            let cut = triangulator.triangulate(points, |t| triangles.push(t.map(|i| corners[i as usize])));
            if cut.is_none() {
                let what =
                    "a concave polygon has too many corners to triangulate exactly and is treated as convex";
                let places = self.places;
                self.diagnostics.note(what, || places.at(start));
            }
        }
        Ok(triangles)
    }

    /// Builds the scene if nothing has to be welded.
    pub(super) fn finish_triangles(
        mut self,
        textures: &[(String, usize)],
        mut scene: SceneBuilder,
        triangles: Vec<[u32; 3]>,
    ) -> Result<SceneBuilder, FormatError> {
        let mut materials = HashMap::new();
        self.only_texture(textures, &mut scene, &mut materials)?;
        let indexed = std::mem::take(&mut self.indexed);
        let material = materials.get("").copied().unwrap_or_else(|| {
            scene.add_material(plain_material(!indexed.colours.is_empty(), !indexed.specular.is_empty()))
        });
        self.reading.budget.take_bytes(indexed.positions.len() as u64 * 5, self.source.name)?;
        let mesh = without_unused(Mesh {
            name: self.source.stem(),
            positions: indexed.positions,
            normals: indexed.normals,
            uvs: indexed.uvs,
            vertex_kd: indexed.colours,
            vertex_ks: indexed.specular,
            triangles,
            ..Mesh::default()
        });
        scene.objects.push(Object::new(&self.source.stem(), Arc::new(mesh), material));
        self.diagnostics.into_warnings(&mut scene);
        Ok(scene)
    }
}

impl Body<'_> {
    /// Reads a triangle in the usual layout: a byte for the count, then three 32-bit indices below `known`.
    ///
    /// `None`, without consuming anything, for any other layout.
    #[inline]
    fn triangle(&mut self, count: Option<Scalar>, index: Scalar, known: u64) -> Option<[u32; 3]> {
        if !self.is_little() || count != Some(Scalar::U8) || !matches!(index, Scalar::I32 | Scalar::U32) {
            return None;
        }
        let row: &[u8; 13] = self.rest().first_chunk()?;
        if row[0] != 3 {
            return None;
        }
        let word = |i: usize| u32::from_le_bytes([row[i], row[i + 1], row[i + 2], row[i + 3]]);
        let triangle = [word(1), word(5), word(9)];
        // The general path reports the error.
        let most = known.min(i32::MAX as u64);
        if triangle.iter().any(|&corner| u64::from(corner) >= most) {
            return None;
        }
        self.pass(13);
        Some(triangle)
    }
}

/// Removes the vertices that no triangle uses.
fn without_unused(mut mesh: Mesh) -> Mesh {
    let mut places = vec![NONE; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&corner| places[corner as usize] = 0);
    if !places.contains(&NONE) {
        return mesh;
    }
    let used: Vec<bool> = places.iter().map(|&place| place != NONE).collect();
    for (next, place) in places.iter_mut().filter(|place| **place != NONE).enumerate() {
        *place = next as u32;
    }
    fn keep<T>(list: &mut Vec<T>, used: &[bool]) {
        let mut used = used.iter();
        list.retain(|_| used.next().copied().unwrap_or(false));
    }
    keep(&mut mesh.positions, &used);
    keep(&mut mesh.normals, &used);
    keep(&mut mesh.uvs, &used);
    keep(&mut mesh.vertex_kd, &used);
    keep(&mut mesh.vertex_ks, &used);
    mesh.triangles.iter_mut().flatten().for_each(|corner| *corner = places[*corner as usize]);
    mesh
}

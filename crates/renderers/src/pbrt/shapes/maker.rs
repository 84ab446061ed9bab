//! Cache and functions that the makers of shapes share.

use crate::pbrt::document::ShapeGeometry;
use crate::pbrt::loader::Loader;
use crate::pbrt::parameters::ParameterList;
use bilux_import::FormatError;
use bilux_math::{Vec2, Vec3};
use bilux_scene::{Mesh, SceneError, Warning};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Meshes that are built once and shared.
#[derive(Default)]
pub(in super::super) struct ShapeCache {
    /// The sphere of radius 1, facing outwards and inwards.
    pub(super) unit_spheres: [Option<Arc<Mesh>>; 2],
    /// Other quadrics, by the bits of their parameters.
    round: HashMap<Vec<u32>, Arc<Mesh>>,
    /// Meshes from files, by path and orientation.
    pub(super) files: HashMap<(PathBuf, bool), Arc<Mesh>>,
    /// The number of curves so far.
    pub(super) curves: usize,
    /// Faults in the files of meshes, and what is odd.
    pub(in super::super) warnings: Vec<Warning>,
    pub(in super::super) notes: Vec<Warning>,
}

/// Makes the shapes of directives.
pub(super) struct ShapeMaker<'m, 'o, 'r> {
    /// True if the graphics state reverses orientations.
    pub(super) reverses: bool,
    pub(super) cache: &'m mut ShapeCache,
    pub(super) loader: &'m mut Loader<'o, 'r>,
}

impl ShapeMaker<'_, '_, '_> {
    /// Finishes a mesh: reverses it if the state says so, and charges the budget.
    pub(super) fn finished(
        &mut self,
        mesh: Mesh,
        list: &ParameterList,
    ) -> Result<Option<ShapeGeometry>, FormatError> {
        self.loader.reading.budget.take_bytes(mesh.size(), &list.at.file)?;
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
            self.loader.note(what, || list.place("P"));
        }
        let mesh = if self.reverses { reversed(mesh) } else { mesh };
        Ok((!mesh.triangles.is_empty()).then(|| ShapeGeometry::Mesh(Arc::new(mesh))))
    }

    /// One of the quadrics, shared by all that have the same parameters.
    pub(super) fn round(
        &mut self,
        list: &ParameterList,
        key: Vec<u32>,
        make: impl FnOnce() -> Mesh,
    ) -> Result<Option<ShapeGeometry>, FormatError> {
        if let Some(mesh) = self.cache.round.get(&key) {
            return Ok(Some(ShapeGeometry::Mesh(mesh.clone())));
        }
        let form = self.finished(make(), list)?;
        if let Some(ShapeGeometry::Mesh(mesh)) = &form {
            self.cache.round.insert(key, mesh.clone());
        }
        Ok(form)
    }

    /// Vertex normals; none if their number is wrong.
    pub(super) fn normals_of(
        &mut self,
        list: &ParameterList,
        vertices: usize,
    ) -> Result<Vec<Vec3>, FormatError> {
        let normals = list.triples("N")?;
        Ok(self.as_many(list, "N", normals, vertices))
    }

    /// Vertex texture coordinates; none if their number is wrong.
    pub(super) fn uvs_of(&mut self, list: &ParameterList, vertices: usize) -> Result<Vec<Vec2>, FormatError> {
        let name = if list.has("uv") { "uv" } else { "st" };
        let uvs = list.pairs(name)?;
        Ok(self.as_many(list, name, uvs, vertices))
    }

    fn as_many<T>(&mut self, list: &ParameterList, name: &str, values: Vec<T>, vertices: usize) -> Vec<T> {
        if values.is_empty() || values.len() == vertices {
            return values;
        }
        let what = format!("'{name}' does not have one entry per point and is not used");
        self.loader.note(&what, || list.place(name));
        Vec::new()
    }
}

/// The mesh with reversed orientation.
pub(super) fn reversed(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

/// The vertex indices of triangles or patches, checked.
pub(super) fn corners<const N: usize>(
    list: &ParameterList,
    vertices: usize,
) -> Result<Vec<[u32; N]>, FormatError> {
    let given = list.integers("indices")?;
    if given.is_empty() && vertices == N {
        return Ok(vec![std::array::from_fn(|i| i as u32)]);
    }
    let at = || list.place("indices");
    if !given.len().is_multiple_of(N) {
        let message = format!("'indices' has {} numbers, which is not a multiple of {N}", given.len());
        return Err(FormatError::malformed(message, at()));
    }
    let in_range = |&&index: &&i32| usize::try_from(index).is_ok_and(|i| i < vertices);
    if let Some(bad) = given.iter().find(|index| !in_range(index)) {
        let message =
            format!("'indices' refers to vertex {bad}, but there are only {vertices}, counted from 0");
        return Err(FormatError::malformed(message, at()));
    }
    if given.is_empty() {
        return Err(
            SceneError::Missing { what: "indices (corners of the shape)".to_owned(), at: at() }.into()
        );
    }
    Ok(given.chunks_exact(N).map(|c| std::array::from_fn(|i| c[i] as u32)).collect())
}

/// The points of a required parameter.
pub(super) fn needed_points(list: &ParameterList) -> Result<Vec<Vec3>, FormatError> {
    let points = list.triples("P")?;
    if points.is_empty() {
        let what = "P (points of the shape)".to_owned();
        return Err(SceneError::Missing { what, at: list.at.clone() }.into());
    }
    Ok(points)
}

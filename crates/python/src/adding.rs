//! Additions to a scene: meshes from arrays, and the materials and textures that specs name.

use crate::arrays;
use crate::texture::Texture;
use crate::values::{Resolve, Spec};
use bilux::math::{Rgb, Vec3};
use bilux::scene::{Mesh, Object, SceneBuilder};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

/// Adds textures and materials to the scene when they are first named.
pub(crate) struct Adding<'s>(pub(crate) &'s mut SceneBuilder);

impl Resolve for Adding<'_> {
    fn texture(&mut self, texture: &Texture) -> usize {
        let textures = &mut self.0.textures;
        textures.iter().position(|known| Arc::ptr_eq(known, &texture.0)).unwrap_or_else(|| {
            textures.push(texture.0.clone());
            textures.len() - 1
        })
    }

    fn material(&mut self, material: &Bound<'_, Spec>) -> PyResult<usize> {
        let spec = of_table(material, "materials")?.resolved(material.py(), self)?;
        let materials = &mut self.0.materials;
        Ok(materials.iter().position(|known| *known == spec).unwrap_or_else(|| {
            materials.push(spec);
            materials.len() - 1
        }))
    }
}

/// The spec, if it is one of this table.
pub(crate) fn of_table<'s>(spec: &'s Bound<'_, Spec>, table: &str) -> PyResult<&'s Spec> {
    let found = spec.get();
    if found.table == table {
        return Ok(found);
    }
    Err(PyTypeError::new_err(format!(
        "{} is one of bilux.{}, but this needs one of bilux.{table}",
        found.kind, found.table
    )))
}

/// A mesh from arrays.
///
/// # Errors
/// If an array has a wrong shape, or holds what is not finite or out of range.
pub(crate) fn mesh(
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    [normals, uvs, colors]: [Option<&Bound<'_, PyAny>>; 3],
    name: &str,
) -> PyResult<Mesh> {
    let positions = arrays::vectors("vertices", vertices)?;
    let triangles = arrays::triangles("triangles", triangles, positions.len())?;
    if triangles.is_empty() {
        return Err(PyValueError::new_err(
            "triangles: a mesh without triangles cannot be seen: leave it out",
        ));
    }
    let normals = normals.map_or(Ok(Vec::new()), |normals| arrays::vectors("normals", normals))?;
    let uvs = uvs.map_or(Ok(Vec::new()), |uvs| arrays::pairs("uvs", uvs))?;
    let colors = colors.map_or(Ok(Vec::new()), |colors| arrays::vectors("colors", colors))?;
    for (argument, count) in [("normals", normals.len()), ("uvs", uvs.len()), ("colors", colors.len())] {
        if count != 0 && count != positions.len() {
            return Err(PyValueError::new_err(format!(
                "{argument}: there are {count} rows for {} vertices: give one for each vertex",
                positions.len()
            )));
        }
    }
    if let Some(row) =
        colors.iter().position(|colour| !(colour.cmpge(Vec3::ZERO).all() && colour.cmple(Vec3::ONE).all()))
    {
        return Err(PyValueError::new_err(format!(
            "colors: row {row} is {:?}, but colours are from 0 to 1",
            colors[row].to_array()
        )));
    }
    let vertex_kd = colors.iter().map(|colour| Rgb::new(colour.x, colour.y, colour.z)).collect();
    Ok(Mesh { name: name.to_owned(), positions, normals, uvs, vertex_kd, triangles, ..Mesh::default() })
}

/// Specs of a table, for the scene.
pub(crate) fn resolved(
    specs: &[Bound<'_, Spec>],
    table: &'static str,
    builder: &mut SceneBuilder,
) -> PyResult<Vec<bilux::scene::Spec>> {
    specs.iter().map(|spec| of_table(spec, table)?.resolved(spec.py(), &mut Adding(builder))).collect()
}

/// An object of a scene, by its index.
pub(crate) fn object(builder: &SceneBuilder, index: usize) -> PyResult<&Object> {
    builder.objects.get(index).ok_or_else(|| {
        let count = builder.objects.len();
        PyIndexError::new_err(format!("there is no object {index}: the scene has {count}, counted from 0"))
    })
}

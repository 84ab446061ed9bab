//! Shapes, one per file; the table is [`SHAPES`].

mod bilinear;
mod curve;
mod files;
mod grid;
mod loop_subdivision;
mod quadrics;
mod triangles;

use super::parameters::ParameterList;
use super::reader::{Alpha, Entity, Pbrt, Piece, ShapeGeometry, SurfaceAttributes};
use super::unknown;
use crate::FormatError;
use bilux_math::{Vec2, Vec3};
use bilux_scene::{Mesh, SceneError};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Builds a shape; `None` if it is invisible.
type Make = fn(&mut Pbrt, &ParameterList) -> Result<Option<ShapeGeometry>, FormatError>;

/// Every supported shape.
const SHAPES: &[(&str, Make)] = &[
    ("bilinearmesh", bilinear::make),
    ("curve", curve::make),
    ("cylinder", quadrics::cylinder),
    ("disk", quadrics::disk),
    ("loopsubdiv", loop_subdivision::make),
    ("plymesh", files::make),
    ("sphere", quadrics::sphere),
    ("trianglemesh", triangles::make),
];

/// Shapes of version 3 that are not supported.
const LEFT_OUT: [&str; 5] = ["cone", "paraboloid", "hyperboloid", "heightfield", "nurbs"];

/// Meshes that are built once and shared.
#[derive(Default)]
pub(super) struct ShapeCache {
    /// The sphere of radius 1, facing outwards and inwards.
    pub(super) unit_spheres: [Option<Arc<Mesh>>; 2],
    /// Other quadrics, by the bits of their parameters.
    round: HashMap<Vec<u32>, Arc<Mesh>>,
    /// Meshes from files, by path and orientation.
    files: HashMap<(PathBuf, bool), Arc<Mesh>>,
    /// The number of curves so far.
    curves: usize,
}

impl Pbrt<'_, '_> {
    /// Builds the shape of a directive.
    pub(super) fn shape(&mut self, entity: &Entity) -> Result<Option<Piece>, FormatError> {
        let list = &entity.parameters;
        let alpha = alpha(list)?;
        let made = match SHAPES.iter().find(|(name, _)| *name == entity.kind) {
            Some((_, make)) => make(self, list)?,
            None if LEFT_OUT.contains(&entity.kind.as_str()) => {
                let what = format!("the pbrt-v3 shape '{}' is left out", entity.kind);
                self.oddities.note(&what, || entity.at.clone());
                None
            }
            None => {
                let names = SHAPES.iter().map(|(name, _)| *name);
                return Err(unknown("shape", &entity.kind, names, &entity.at));
            }
        };
        self.reading.budget.take::<Piece>(1, &entity.at.file)?;
        let attributes = SurfaceAttributes {
            material: self.state.material.clone(),
            area_light: self.state.area_light,
            alpha,
            media: self.state.media.clone(),
        };
        let (matrices, at) = (self.state.matrices, entity.at.clone());
        Ok(made.map(|form| Piece { shapes: count(entity, &form), form, matrices, attributes, at }))
    }

    /// Finishes a mesh: reverses it if the state says so, and charges the budget.
    fn finished(&mut self, mesh: Mesh, list: &ParameterList) -> Result<Option<ShapeGeometry>, FormatError> {
        self.reading.budget.take_bytes(mesh.size(), &list.at.file)?;
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
            self.oddities.note(what, || list.place("P"));
        }
        let mesh = if self.state.reverses { reversed(mesh) } else { mesh };
        Ok((!mesh.triangles.is_empty()).then(|| ShapeGeometry::Mesh(Arc::new(mesh))))
    }

    /// One of the quadrics, shared by all that have the same parameters.
    fn round(
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
}

/// The mesh with reversed orientation.
fn reversed(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

/// The number of shapes that pbrt counts for a directive.
fn count(entity: &Entity, form: &ShapeGeometry) -> u32 {
    let count = match (entity.kind.as_str(), form) {
        ("bilinearmesh", _) => entity.parameters.integers("indices").map_or(1, |list| list.len() / 4),
        ("trianglemesh" | "plymesh" | "loopsubdiv", ShapeGeometry::Mesh(mesh)) => mesh.triangles.len(),
        _ => 1,
    };
    u32::try_from(count).unwrap_or(u32::MAX).max(1)
}

/// The opacity of a shape from its alpha parameter.
fn alpha(list: &ParameterList) -> Result<Alpha, FormatError> {
    if let Some((name, at)) = list.texture("alpha") {
        return Ok(Alpha::Texture(name.into(), at.line, at.column));
    }
    let number = list.finite("alpha", 1.0)?;
    Ok(if number == 1.0 { Alpha::Whole } else { Alpha::Even(number.to_bits()) })
}

/// The vertex indices of triangles or patches, checked.
fn corners<const N: usize>(list: &ParameterList, vertices: usize) -> Result<Vec<[u32; N]>, FormatError> {
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
fn needed_points(list: &ParameterList) -> Result<Vec<Vec3>, FormatError> {
    let points = list.triples("P")?;
    if points.is_empty() {
        let what = "P (points of the shape)".to_owned();
        return Err(SceneError::Missing { what, at: list.at.clone() }.into());
    }
    Ok(points)
}

impl Pbrt<'_, '_> {
    /// Vertex normals; none if their number is wrong.
    fn normals_of(&mut self, list: &ParameterList, vertices: usize) -> Result<Vec<Vec3>, FormatError> {
        let normals = list.triples("N")?;
        Ok(self.as_many(list, "N", normals, vertices))
    }

    /// Vertex texture coordinates; none if their number is wrong.
    fn uvs_of(&mut self, list: &ParameterList, vertices: usize) -> Result<Vec<Vec2>, FormatError> {
        let name = if list.has("uv") { "uv" } else { "st" };
        let uvs = list.pairs(name)?;
        Ok(self.as_many(list, name, uvs, vertices))
    }

    fn as_many<T>(&mut self, list: &ParameterList, name: &str, values: Vec<T>, vertices: usize) -> Vec<T> {
        if values.is_empty() || values.len() == vertices {
            return values;
        }
        let what = format!("'{name}' does not have one entry per point and is not used");
        self.oddities.note(&what, || list.place(name));
        Vec::new()
    }
}

//! Shapes. One a file; the table is [`SHAPES`].

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

/// What a shape becomes; none where nothing can be seen of it.
type Make = fn(&mut Pbrt, &ParameterList) -> Result<Option<ShapeGeometry>, FormatError>;

/// Every shape that is drawn.
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

/// Those of version 3 that are left out.
const LEFT_OUT: [&str; 5] = ["cone", "paraboloid", "hyperboloid", "heightfield", "nurbs"];

/// Meshes that are made once.
#[derive(Default)]
pub(super) struct ShapeCache {
    /// The sphere of radius 1, seen from outside and from inside.
    pub(super) unit_spheres: [Option<Arc<Mesh>>; 2],
    /// Other round shapes, by the bits of their parameters.
    round: HashMap<Vec<u32>, Arc<Mesh>>,
    /// Files, with whether they are turned inside out.
    files: HashMap<(PathBuf, bool), Arc<Mesh>>,
    /// Curves so far.
    curves: usize,
}

impl Pbrt<'_, '_> {
    /// What a shape directive makes.
    pub(super) fn shape(&mut self, entity: &Entity) -> Result<Option<Piece>, FormatError> {
        let list = &entity.parameters;
        let alpha = alpha(list)?;
        let made = match SHAPES.iter().find(|(name, _)| *name == entity.kind) {
            Some((_, make)) => make(self, list)?,
            None if LEFT_OUT.contains(&entity.kind.as_str()) => {
                let what = format!("the shape '{}' of version 3 is left out", entity.kind);
                self.oddities.note(&what, || entity.at.clone());
                None
            }
            None => {
                let names = SHAPES.iter().map(|(name, _)| *name);
                return Err(unknown("shape", &entity.kind, names, &entity.at));
            }
        };
        self.reading.budget.take::<Piece>(1, &entity.at.file)?;
        let dress = SurfaceAttributes {
            material: self.state.material.clone(),
            area_light: self.state.area_light,
            alpha,
            media: self.state.media.clone(),
        };
        let (matrices, at) = (self.state.matrices, entity.at.clone());
        Ok(made.map(|form| Piece { shapes: count(entity, &form), form, matrices, dress, at }))
    }

    /// A mesh as the state has it: turned inside out or not, and counted in the budget.
    fn finished(&mut self, mesh: Mesh, list: &ParameterList) -> Result<Option<ShapeGeometry>, FormatError> {
        self.reading.budget.take_bytes(mesh.size(), &list.at.file)?;
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            let what = "positions have numbers that are infinite or no numbers; they are kept";
            self.oddities.note(what, || list.place("P"));
        }
        let mesh = if self.state.reverses { reversed(mesh) } else { mesh };
        Ok((!mesh.triangles.is_empty()).then(|| ShapeGeometry::Mesh(Arc::new(mesh))))
    }

    /// One of the round shapes, which look alike wherever they stand.
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

/// The same, seen from its other side.
fn reversed(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = -*n);
    mesh
}

/// How many shapes a directive is for pbrt.
fn count(entity: &Entity, form: &ShapeGeometry) -> u32 {
    let count = match (entity.kind.as_str(), form) {
        ("bilinearmesh", _) => entity.parameters.integers("indices").map_or(1, |list| list.len() / 4),
        ("trianglemesh" | "plymesh" | "loopsubdiv", ShapeGeometry::Mesh(mesh)) => mesh.triangles.len(),
        _ => 1,
    };
    u32::try_from(count).unwrap_or(u32::MAX).max(1)
}

/// How much of a shape is there, as its parameter says.
fn alpha(list: &ParameterList) -> Result<Alpha, FormatError> {
    if let Some((name, at)) = list.texture("alpha") {
        return Ok(Alpha::Texture(name.into(), at.line, at.column));
    }
    let number = list.finite("alpha", 1.0)?;
    Ok(if number == 1.0 { Alpha::Whole } else { Alpha::Even(number.to_bits()) })
}

/// The numbers of the corners of triangles or of patches, checked.
fn corners<const N: usize>(list: &ParameterList, vertices: usize) -> Result<Vec<[u32; N]>, FormatError> {
    let given = list.integers("indices")?;
    if given.is_empty() && vertices == N {
        return Ok(vec![std::array::from_fn(|i| i as u32)]);
    }
    let at = || list.place("indices");
    if !given.len().is_multiple_of(N) {
        let message = format!("'indices' has {} numbers, which {N} do not divide", given.len());
        return Err(FormatError::malformed(message, at()));
    }
    let in_range = |&&index: &&i32| usize::try_from(index).is_ok_and(|i| i < vertices);
    if let Some(bad) = given.iter().find(|index| !in_range(index)) {
        let message = format!("'indices' names vertex {bad}, but there are {vertices}, counted from 0");
        return Err(FormatError::malformed(message, at()));
    }
    if given.is_empty() {
        return Err(
            SceneError::Missing { what: "indices (corners of the shape)".to_owned(), at: at() }.into()
        );
    }
    Ok(given.chunks_exact(N).map(|c| std::array::from_fn(|i| c[i] as u32)).collect())
}

/// Points under a name, which have to be there.
fn needed_points(list: &ParameterList) -> Result<Vec<Vec3>, FormatError> {
    let points = list.triples("P")?;
    if points.is_empty() {
        let what = "P (points of the shape)".to_owned();
        return Err(SceneError::Missing { what, at: list.at.clone() }.into());
    }
    Ok(points)
}

impl Pbrt<'_, '_> {
    /// Normals of vertices; none where they are not as many.
    fn normals_of(&mut self, list: &ParameterList, vertices: usize) -> Result<Vec<Vec3>, FormatError> {
        let normals = list.triples("N")?;
        Ok(self.as_many(list, "N", normals, vertices))
    }

    /// Texture coordinates of vertices; none where they are not as many.
    fn uvs_of(&mut self, list: &ParameterList, vertices: usize) -> Result<Vec<Vec2>, FormatError> {
        let name = if list.has("uv") { "uv" } else { "st" };
        let uvs = list.pairs(name)?;
        Ok(self.as_many(list, name, uvs, vertices))
    }

    fn as_many<T>(&mut self, list: &ParameterList, name: &str, values: Vec<T>, vertices: usize) -> Vec<T> {
        if values.is_empty() || values.len() == vertices {
            return values;
        }
        let what = format!("'{name}' is not as many as the points, and not used");
        self.oddities.note(&what, || list.place(name));
        Vec::new()
    }
}

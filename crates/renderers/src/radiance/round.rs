//! Spheres, cones and rings: each form is built once, and placed.

use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::tessellation::grid;
use bilux_import::geometry::tessellation::sphere::{AROUND, part_of_sphere};
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat4, DVec3};
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A form around the z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// Of radius 1 around the origin.
    Sphere,
    /// From radius 1 at z = 0 to this one, which is no greater, at z = 1; without ends.
    Cone(f64),
    /// From radius 1 to this one, at z = 0; it faces +z.
    Ring(f64),
}

/// The meshes of forms so far, by the bits of their radii, outwards and inwards.
#[derive(Default)]
pub(super) struct RoundShapes(HashMap<(u8, u64, bool), Arc<Mesh>>);

impl RoundShapes {
    /// The mesh of a form.
    pub(super) fn mesh(
        &mut self,
        form: Form,
        inwards: bool,
        budget: &mut Budget,
        file: &str,
    ) -> Result<Arc<Mesh>, FormatError> {
        let (kind, radius) = match form {
            Form::Sphere => (0, 0.0),
            Form::Cone(radius) => (1, radius),
            Form::Ring(radius) => (2, radius),
        };
        let key = (kind, radius.to_bits(), inwards);
        if let Some(mesh) = self.0.get(&key) {
            return Ok(mesh.clone());
        }
        let mut mesh = made(form);
        budget.take_bytes(mesh.size(), file)?;
        if inwards {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            mesh.normals.iter_mut().for_each(|n| *n = -*n);
        }
        let mesh = Arc::new(mesh);
        self.0.insert(key, mesh.clone());
        Ok(mesh)
    }
}

fn made(form: Form) -> Mesh {
    let (name, top, height) = match form {
        Form::Sphere => return part_of_sphere(1.0, [PI, 0.0], 1.0, AROUND),
        Form::Cone(top) => (if top == 1.0 { "cylinder" } else { "cone" }, top, 1.0),
        Form::Ring(inner) => ("ring", inner, 0.0),
    };
    let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
    grid::add(&mut mesh, AROUND, 1, true, &|u, v| {
        let (sin, cos) = sin_cos_f64(TAU * u);
        let radius = if v == 0.0 { 1.0 } else { top };
        let normal = DVec3::new(cos * height, sin * height, 1.0 - top);
        (DVec3::new(radius * cos, radius * sin, v * height), normal.normalize_or(DVec3::Z))
    });
    mesh
}

/// Places a form: the point that its origin comes to, what its z axis comes to, and its radius.
pub(super) fn placed(origin: DVec3, along: DVec3, radius: f64) -> DMat4 {
    let axis = along.try_normalize().unwrap_or(DVec3::Z);
    let (side, across) = axis.any_orthonormal_pair();
    let column = |v: DVec3| v.extend(0.0);
    DMat4::from_cols(column(side * radius), column(across * radius), column(along), origin.extend(1.0))
}

//! What OBJ and PLY files hold, and meshes made of it.

mod assemble;

pub(crate) use assemble::assemble;

use crate::normals::Smoothing;
use bilux_math::{Rgb, Vec2, Vec3};

/// An index that is not given.
pub(crate) const NONE: u32 = u32::MAX;

/// Position, texture coordinates and normal of a corner, as indices from 0; or [`NONE`].
pub(crate) type Corner = [u32; 3];

/// Faces over lists of positions, texture coordinates and normals, before they are cut into objects.
#[derive(Default)]
pub(crate) struct Soup {
    pub(crate) positions: Vec<Vec3>,
    /// As many as positions, or none.
    pub(crate) colours: Vec<Rgb>,
    /// The same for specular colours.
    pub(crate) specular: Vec<Rgb>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) corners: Vec<Corner>,
    /// Where each face's corners end.
    pub(crate) ends: Vec<u32>,
    /// Where in the file each face stands.
    pub(crate) offsets: Vec<usize>,
    pub(crate) smoothing: Vec<Smoothing>,
    pub(crate) runs: Vec<Run>,
    /// What the format calls its first vertex: 1 in OBJ, 0 elsewhere.
    pub(crate) first_vertex: u32,
}

/// Faces one after another that have the same name and material.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) first_face: usize,
    pub(crate) name: String,
    /// The material's name and where it is asked for; `None` for a plain one.
    pub(crate) material: Option<(String, usize)>,
}

impl Run {
    pub(crate) fn material_name(&self) -> Option<&str> {
        self.material.as_ref().map(|(name, _)| name.as_str())
    }
}

//! `trianglemesh`.

use super::super::parameters::ParameterList;
use super::super::reader::{Pbrt, ShapeGeometry};
use super::{corners, needed_points};
use crate::FormatError;
use bilux_scene::Mesh;

pub(super) fn make(pbrt: &mut Pbrt, list: &ParameterList) -> Result<Option<ShapeGeometry>, FormatError> {
    let positions = needed_points(list)?;
    let triangles = corners::<3>(list, positions.len())?;
    let normals = pbrt.normals_of(list, positions.len())?;
    let uvs = pbrt.uvs_of(list, positions.len())?;
    for name in ["S", "faceIndices"] {
        // Tangents are derived from texture coordinates; face indices matter only to Ptex.
        list.has(name);
    }
    pbrt.finished(Mesh { positions, normals, uvs, triangles, ..Mesh::default() }, list)
}

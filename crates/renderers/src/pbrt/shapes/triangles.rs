//! `trianglemesh`.

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, corners, needed_points};
use bilux_import::FormatError;
use bilux_scene::Mesh;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let positions = needed_points(list)?;
    let triangles = corners::<3>(list, positions.len())?;
    let normals = maker.normals_of(list, positions.len())?;
    let uvs = maker.uvs_of(list, positions.len())?;
    for name in ["S", "faceIndices"] {
        // Tangents are derived from texture coordinates; face indices matter only to Ptex.
        list.has(name);
    }
    maker.finished(Mesh { positions, normals, uvs, triangles, ..Mesh::default() }, list)
}

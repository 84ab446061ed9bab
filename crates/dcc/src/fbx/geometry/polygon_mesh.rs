//! A mesh as the file has it.

use super::layers::Surface;
use super::{layers, nurbs, polygons};
use crate::fbx::tree::Node;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{Layer, PolygonMesh, Workshop, reflectances};
use bilux_math::{Rgb, Vec2, Vec3};

/// The mesh at a node of the file, or its NURBS surface as polygons; `None` if it has neither. `has_second_uvs` tells whether a second set of texture
/// coordinates is wanted.
pub(in crate::fbx) fn read(
    node: Node,
    name: String,
    has_second_uvs: bool,
    workshop: &mut Workshop,
) -> Result<Option<PolygonMesh>, FormatError> {
    if node.child("NurbsSurfaceOrder").is_some() {
        return nurbs::read(node, name, workshop);
    }
    let (Some(vertices), Some(indices)) = (node.child("Vertices"), node.child("PolygonVertexIndex")) else {
        return Ok(None);
    };
    let count = vertices.most_numbers()? / 3;
    workshop.budget.take_bytes((count * size_of::<Vec3>()) as u64, node.file())?;
    let mut positions = Vec::with_capacity(count);
    vertices.each_number(|some: &[f32]| {
        positions.extend(some.as_chunks::<3>().0.iter().copied().map(Vec3::from));
    })?;
    if positions.iter().any(|p| !p.is_finite()) {
        let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
        workshop.diagnostics.note(what, || vertices.at());
    }
    let polygons = polygons::read(indices, positions.len(), workshop)?;
    if polygons.is_empty() {
        return Ok(None);
    }
    let surface = Surface { corners: &polygons.corners, positions: positions.len() };
    let mut sets = layers::nodes(node, "LayerElementUV").into_iter();
    let mut uvs = |is_wanted: bool| match sets.next().filter(|_| is_wanted) {
        Some(layer) => layers::read(layer, "UV", "UVIndex", Vec2::from_array, surface, workshop),
        None => Ok(Layer::default()),
    };
    let uvs = [uvs(true)?, uvs(has_second_uvs)?];
    let first = |element: &str| layers::nodes(node, element).into_iter().next();
    let normals = match first("LayerElementNormal") {
        Some(layer) => layers::read(layer, "Normals", "NormalsIndex", Vec3::from_array, surface, workshop)?,
        None => Layer::default(),
    };
    let integers = |element: &str, list: &'static str, workshop: &mut Workshop| match first(element) {
        Some(layer) => layers::read(layer, list, "", |[number]: [i32; 1]| number, surface, workshop),
        None => Ok(Layer::default()),
    };
    let materials = integers("LayerElementMaterial", "Materials", workshop)?;
    let smoothing = integers("LayerElementSmoothing", "Smoothing", workshop)?;
    let colours = match first("LayerElementColor") {
        Some(layer) => colours(layer, surface, workshop)?,
        None => Layer::default(),
    };
    Ok(Some(PolygonMesh {
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

/// The colours of a layer.
fn colours(layer: Node, surface: Surface, workshop: &mut Workshop) -> Result<Layer<Rgb>, FormatError> {
    let rgb = |[r, g, b, _]: [f32; 4]| Rgb::new(r, g, b);
    let colours = layers::read(layer, "Colors", "ColorIndex", rgb, surface, workshop)?;
    Ok(reflectances(colours, workshop, || layer.at()))
}

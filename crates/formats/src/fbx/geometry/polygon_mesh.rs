//! A mesh as the file has it.

use super::{layers, polygons};
use crate::FormatError;
use crate::fbx::tree::Node;
use crate::polygon_mesh::{Layer, PolygonMesh, Workshop, reflectances};
use bilux_math::{Rgb, Vec2, Vec3};

/// The mesh at a node of the file; `None` if it has no polygons. `has_second_uvs` tells whether a second set of texture
/// coordinates is wanted.
pub(in crate::fbx) fn read(
    node: Node,
    name: String,
    has_second_uvs: bool,
    workshop: &mut Workshop,
) -> Result<Option<PolygonMesh>, FormatError> {
    let (Some(vertices), Some(indices)) = (node.child("Vertices"), node.child("PolygonVertexIndex")) else {
        return Ok(None);
    };
    let numbers: Vec<f32> = vertices.numbers(workshop.budget)?;
    workshop.budget.take_bytes(4 * numbers.len() as u64, node.file())?;
    let positions: Vec<Vec3> = numbers.as_chunks::<3>().0.iter().copied().map(Vec3::from).collect();
    workshop.budget.release(4 * numbers.len() as u64);
    drop(numbers);
    if positions.iter().any(|p| !p.is_finite()) {
        let what = "positions have numbers that are infinite or not numbers (NaN); they are kept";
        workshop.oddities.note(what, || vertices.at());
    }
    let polygons = polygons::read(indices, positions.len(), workshop)?;
    if polygons.len() == 0 {
        return Ok(None);
    }
    let mut sets = layers::nodes(node, "LayerElementUV").into_iter();
    let mut uvs = |is_wanted: bool| match sets.next().filter(|_| is_wanted) {
        Some(layer) => layers::read(layer, "UV", "UVIndex", |[u, v]: [f32; 2]| Vec2::new(u, v), workshop),
        None => Ok(Layer::default()),
    };
    let uvs = [uvs(true)?, uvs(has_second_uvs)?];
    let first = |element: &str| layers::nodes(node, element).into_iter().next();
    let normals = match first("LayerElementNormal") {
        Some(layer) => layers::read(layer, "Normals", "NormalsIndex", |n: [f32; 3]| Vec3::from(n), workshop)?,
        None => Layer::default(),
    };
    let integers = |element: &str, list: &'static str, workshop: &mut Workshop| match first(element) {
        Some(layer) => layers::read(layer, list, "", |[number]: [i32; 1]| number, workshop),
        None => Ok(Layer::default()),
    };
    let materials = integers("LayerElementMaterial", "Materials", workshop)?;
    let smoothing = integers("LayerElementSmoothing", "Smoothing", workshop)?;
    let colours = match first("LayerElementColor") {
        Some(layer) => colours(layer, workshop)?,
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
fn colours(layer: Node, workshop: &mut Workshop) -> Result<Layer<Rgb>, FormatError> {
    let rgb = |[r, g, b, _]: [f32; 4]| Rgb::new(r, g, b);
    let colours = layers::read(layer, "Colors", "ColorIndex", rgb, workshop)?;
    Ok(reflectances(colours, workshop, || layer.at()))
}

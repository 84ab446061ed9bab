//! Subdivision surfaces: programs show them in levels, and here they are as fine as the picture needs. [Catmull 1978]

use super::geometry::layers_named;
use super::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::geometry::subdivision::{Cage, Scheme};
use bilux_import::meshes::polygon_mesh::{PolygonMesh, Workshop};
use bilux_math::{Rgb, Vec2};

/// Levels for which an edge with a crease of 1 stays sharp.
const SHARPEST: f32 = 10.0;

/// True if the programs show a mesh refined.
pub(super) fn is_smooth(mesh: Node) -> bool {
    let number = |name: &str| mesh.child_value(name).and_then(Value::integer);
    let levels = ["RenderDivisionLevels", "PreviewDivisionLevels"].map(number);
    number("Smoothness").is_some_and(|kind| kind > 0) && levels != [Some(0), Some(0)]
}

/// The `BoundaryRule` for which corners of the border, points of a single polygon, are round: the SDK's `eCreaseEdge`.
const ROUND_CORNERS: i64 = 2;

/// The polygons of a mesh as a cage, and the number of the material of each of its groups.
pub(super) fn cage(
    node: Node,
    geometry: &PolygonMesh,
    workshop: &mut Workshop,
) -> Result<(Cage, Vec<usize>), FormatError> {
    let (polygons, count) = (&geometry.polygons, geometry.positions.len());
    workshop
        .budget
        .take_bytes((count * 64 + polygons.corners.len() * 16 + polygons.len() * 12) as u64, node.file())?;
    let mut cage = Cage::new(Scheme::CatmullClark, &geometry.positions);
    if node.child_value("BoundaryRule").and_then(Value::integer) == Some(ROUND_CORNERS) {
        cage.round_corners();
    }
    let of_faces = geometry.materials_of_faces();
    let mut materials = of_faces.clone();
    materials.sort_unstable();
    materials.dedup();
    let mut colours = vec![Rgb::WHITE; if geometry.colours.is_empty() { 0 } else { count }];
    let (mut points, mut uvs) = (Vec::new(), Vec::new());
    for polygon in (0..polygons.len()).filter(|&polygon| polygons.is_drawn(polygon)) {
        points.clear();
        uvs.clear();
        for corner in polygons.start(polygon)..polygons.ends[polygon] as usize {
            let point = polygons.corners[corner];
            points.push(point);
            if !geometry.uvs[0].is_empty() {
                uvs.push(geometry.uvs[0].at(corner, polygon, point as usize).unwrap_or(Vec2::ZERO));
            }
            if let Some(colour) = geometry.colours.at(corner, polygon, point as usize) {
                colours[point as usize] = colour;
            }
        }
        if geometry.is_mirrored {
            points.reverse();
            uvs.reverse();
        }
        let material = of_faces.get(polygon).or(of_faces.first()).copied().unwrap_or(0);
        cage.add_face(&points, &uvs, materials.binary_search(&material).unwrap_or(0) as u32);
    }
    if !colours.is_empty() {
        cage.set_colours(&colours);
    }
    sharpen(node, geometry, &mut cage, workshop)?;
    Ok((cage, materials.into_iter().map(|material| material as usize).collect()))
}

/// Sets the creases of edges, which the file names by the corner that each begins at, and of vertices.
fn sharpen(
    node: Node,
    geometry: &PolygonMesh,
    cage: &mut Cage,
    workshop: &mut Workshop,
) -> Result<(), FormatError> {
    let mut list = |layer: &str, name: &str| -> Result<Vec<f32>, FormatError> {
        let layer = layers_named(node, layer).into_iter().next();
        layer.and_then(|layer| layer.child(name)).map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))
    };
    let of_edges = list("LayerElementEdgeCrease", "EdgeCrease")?;
    let of_vertices = list("LayerElementVertexCrease", "VertexCrease")?;
    let edges: Vec<i32> = node.child("Edges").map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))?;
    workshop.budget.take::<[u64; 6]>(of_edges.len() + of_vertices.len(), node.file())?;
    let polygons = &geometry.polygons;
    for (&first, crease) in edges.iter().zip(of_edges).filter(|(_, crease)| crease.is_finite()) {
        let Some(first) = usize::try_from(first).ok().filter(|&first| first < polygons.corners.len()) else {
            continue;
        };
        let polygon = polygons.ends.partition_point(|&end| end as usize <= first);
        let next =
            if first + 1 == polygons.ends[polygon] as usize { polygons.start(polygon) } else { first + 1 };
        cage.crease([first, next].map(|corner| polygons.corners[corner]), SHARPEST * crease);
    }
    for (vertex, crease) in of_vertices.into_iter().enumerate().take(geometry.positions.len()) {
        if crease.is_finite() {
            cage.sharpen(vertex as u32, SHARPEST * crease);
        }
    }
    Ok(())
}

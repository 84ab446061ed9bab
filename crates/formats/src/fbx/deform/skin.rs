//! Skins: each vertex follows several bones, by weights.

use crate::FormatError;
use crate::budget::Budget;
use crate::deformation::Blends;
use crate::fbx::document::Index;
use crate::polygon_mesh::{PolygonMesh, Workshop};

use crate::fbx::graph::{Graph, Placed};
use crate::fbx::posed::Posed;
use crate::fbx::tree::Node;
use bilux_math::DMat4;

/// Moves a mesh to where its bones are, in world space. Vertices without weights stay on their node.
pub(super) fn bend(
    skin: Index,
    geometry: &mut PolygonMesh,
    placed: &Placed,
    posed: &Posed,
    graph: &Graph,
    workshop: &mut Workshop,
) -> Result<(), FormatError> {
    let document = posed.document;
    let (node, count) = (document.object(skin).node, geometry.positions.len());
    workshop.budget.take_bytes(Blends::bytes(count), node.file())?;
    let mut blends = Blends::new(count);
    for cluster in document.sources_of_class(skin, "Deformer") {
        let cluster_node = document.object(cluster).node;
        let bone = document.sources_of_class(cluster, "Model").next();
        let bound = matrix(cluster_node, "TransformLink", workshop.budget)?;
        let bound = bound.map(|bound| graph.to_world * bound);
        let Some(world) = bone.and_then(|bone| graph.world_of(bone)).or(bound) else {
            workshop.oddities.note("a bone is missing, and does not move its vertices", || cluster_node.at());
            continue;
        };
        let to_bone = matrix(cluster_node, "Transform", workshop.budget)?.unwrap_or(DMat4::IDENTITY);
        let whole = world * to_bone * placed.geometric;
        let list = |name: &str| cluster_node.child(name);
        let (Some(indices), Some(weights)) = (list("Indexes"), list("Weights")) else { continue };
        let spent = workshop.budget.spent();
        let (indices, weights): (Vec<i32>, Vec<f64>) =
            (indices.numbers(workshop.budget)?, weights.numbers(workshop.budget)?);
        for (index, weight) in indices.iter().zip(&weights) {
            let vertex = usize::try_from(*index).ok().filter(|&vertex| vertex < count);
            let Some(vertex) = vertex else {
                workshop
                    .oddities
                    .note("a bone moves a vertex that the mesh does not have", || cluster_node.at());
                continue;
            };
            blends.add(vertex, &whole, *weight);
        }
        workshop.budget.release(workshop.budget.spent() - spent);
    }
    let kind = node.child_value("SkinningType").and_then(|value| value.text());
    if kind.is_some_and(|kind| matches!(kind, b"DualQuaternion" | b"Blend")) {
        let what = "skins that blend dual quaternions are blended linearly";
        workshop.oddities.note(what, || node.at());
    }
    let still = placed.world * placed.geometric;
    geometry.bend(&blends.matrices(|_| still), workshop, node.file())?;
    workshop.budget.release(Blends::bytes(count));
    Ok(())
}

/// A matrix of a node, which the file has in columns.
fn matrix(node: Node, name: &str, budget: &mut Budget) -> Result<Option<DMat4>, FormatError> {
    let Some(list) = node.child(name) else { return Ok(None) };
    let numbers: Vec<f64> = list.numbers(budget)?;
    Ok(numbers.first_chunk::<16>().map(DMat4::from_cols_array).filter(|matrix| matrix.is_finite()))
}

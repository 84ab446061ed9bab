//! Skins: each vertex follows several bones, by weights.

use crate::fbx::document::Index;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::geometry::deformation::{Blends, DualBlends, DualJoint};
use bilux_import::meshes::polygon_mesh::{PolygonMesh, Workshop};

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
    let kind = node.child_value("SkinningType").and_then(|value| value.text()).unwrap_or_default();
    // How much of each vertex is the blend of dual quaternions.
    let shares = match kind {
        b"DualQuaternion" => vec![1.0],
        b"Blend" => shares(node, count, workshop)?,
        _ => Vec::new(),
    };
    let needed = Blends::bytes(count) + if shares.is_empty() { 0 } else { DualBlends::bytes(count) };
    workshop.budget.take_bytes(needed, node.file())?;
    let mut blends = Blends::new(count);
    let mut duals = DualBlends::new(if shares.is_empty() { 0 } else { count });
    for cluster in document.sources_of_class(skin, "Deformer") {
        let cluster_node = document.object(cluster).node;
        let bone = document.sources_of_class(cluster, "Model").next();
        let bound = matrix(cluster_node, "TransformLink", workshop.budget)?;
        let bound = bound.map(|bound| graph.to_world * bound);
        let Some(world) = bone.and_then(|bone| graph.world_of(bone)).or(bound) else {
            workshop
                .diagnostics
                .note("a bone is missing, and does not move its vertices", || cluster_node.at());
            continue;
        };
        let to_bone = matrix(cluster_node, "Transform", workshop.budget)?.unwrap_or(DMat4::IDENTITY);
        let whole = world * to_bone * placed.geometric;
        let joint = DualJoint::of(&whole);
        for_each_weight(cluster_node, count, workshop, |vertex, weight| {
            blends.add(vertex, &whole, weight);
            if !shares.is_empty() {
                duals.add(vertex, &joint, weight);
            }
        })?;
    }
    let still = placed.world * placed.geometric;
    let mut matrices = blends.matrices(|_| still);
    if !shares.is_empty() {
        for (vertex, (matrix, dual)) in matrices.iter_mut().zip(duals.matrices(|_| still)).enumerate() {
            let share = shares.get(vertex).or(shares.last()).copied().unwrap_or(1.0).clamp(0.0, 1.0);
            *matrix = *matrix * (1.0 - share) + dual * share;
        }
    }
    geometry.bend(&matrices, workshop, node.file())?;
    workshop.budget.release(needed);
    Ok(())
}

/// Calls with each vertex that a bone moves, and its weight.
fn for_each_weight(
    cluster: Node,
    count: usize,
    workshop: &mut Workshop,
    mut add: impl FnMut(usize, f64),
) -> Result<(), FormatError> {
    let (Some(indices), Some(weights)) = (cluster.child("Indexes"), cluster.child("Weights")) else {
        return Ok(());
    };
    let spent = workshop.budget.spent();
    let (indices, weights): (Vec<i32>, Vec<f64>) =
        (indices.numbers(workshop.budget)?, weights.numbers(workshop.budget)?);
    for (index, weight) in indices.iter().zip(&weights) {
        match usize::try_from(*index).ok().filter(|&vertex| vertex < count) {
            Some(vertex) => add(vertex, *weight),
            None => {
                let what = "a bone moves a vertex that the mesh does not have";
                workshop.diagnostics.note(what, || cluster.at());
            }
        }
    }
    workshop.budget.release(workshop.budget.spent() - spent);
    Ok(())
}

/// Share of dual-quaternion blending at each vertex of a skin.
fn shares(skin: Node, count: usize, workshop: &mut Workshop) -> Result<Vec<f64>, FormatError> {
    workshop.budget.take::<f64>(count.max(1), skin.file())?;
    let mut shares = vec![0.0; count.max(1)];
    if let (Some(indices), Some(weights)) = (skin.child("Indexes"), skin.child("BlendWeights")) {
        let (indices, weights): (Vec<i32>, Vec<f64>) =
            (indices.numbers(workshop.budget)?, weights.numbers(workshop.budget)?);
        for (index, weight) in indices.iter().zip(weights).filter(|(_, weight)| weight.is_finite()) {
            let slot = usize::try_from(*index).ok().and_then(|vertex| shares.get_mut(vertex));
            slot.into_iter().for_each(|slot| *slot = weight);
        }
    }
    Ok(shares)
}

/// A matrix of a node, which the file has in columns.
fn matrix(node: Node, name: &str, budget: &mut Budget) -> Result<Option<DMat4>, FormatError> {
    let Some(list) = node.child(name) else { return Ok(None) };
    let numbers: Vec<f64> = list.numbers(budget)?;
    Ok(numbers.first_chunk::<16>().map(DMat4::from_cols_array).filter(|matrix| matrix.is_finite()))
}

//! Skins: vertices that several nodes move. [glTF 2.0, 3.7.3]

use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use crate::graph::place;
use crate::graph::posed::Posed;
use bilux_import::FormatError;
use bilux_import::geometry::deformation::{Blends, are_mirrored, move_points, turned};
use bilux_math::DMat4;
use bilux_scene::Mesh;

/// For each joint of a skin, the matrix from the mesh in its rest pose to world space.
pub(crate) struct Joints(Vec<DMat4>);

impl Joints {
    /// The joints of a skin in the current pose; the transform of the skinned node itself is ignored.
    pub(crate) fn read<'d>(
        skin: JsonNode<'d>,
        posed: &Posed<'d>,
        data: &mut DataReader<'d, '_>,
    ) -> Result<Joints, FormatError> {
        let skin = data.document.named("skins", skin)?;
        let list = skin.need("joints")?.items()?;
        let count = list.len();
        data.take_bytes((count * size_of::<DMat4>()) as u64)?;
        let mut matrices = Vec::with_capacity(count);
        for joint in list {
            let node = data.document.named("nodes", joint)?;
            matrices.push(match posed.graph.world_of(joint.as_count()?) {
                Some(world) => world,
                None => {
                    data.note(
                        "a joint is not in the scene that is shown; it is placed without parents",
                        || joint.at(),
                    );
                    place::local(node, joint.as_count()?, &posed.pose)?
                }
            });
        }
        if let Some(index) = skin.get("inverseBindMatrices") {
            let bind = data.attribute::<16>(index, None)?;
            if bind.len() < count {
                let message =
                    format!("there must be a matrix for each of the {count} joints, not {}", bind.len());
                return Err(index.error(message));
            }
            for (matrix, bind) in matrices.iter_mut().zip(bind) {
                *matrix *= DMat4::from_cols_array(&bind.map(f64::from));
            }
        }
        Ok(Joints(matrices))
    }
}

/// Skins a mesh: moves it from its rest pose to its joints, in world space.
pub(crate) fn bend<'d>(
    primitive: JsonNode<'d>,
    joints: &Joints,
    mesh: &mut Mesh,
    data: &mut DataReader<'d, '_>,
) -> Result<(), FormatError> {
    let attributes = primitive.need("attributes")?;
    let count = mesh.positions.len();
    data.take_bytes(Blends::bytes(count) + (count * size_of::<f32>()) as u64)?;
    let mut blends = Blends::new(count);
    let mut firsts: Vec<f32> = Vec::new();
    for (key, index) in attributes.entries() {
        let Some(set) = key.strip_prefix("JOINTS_") else { continue };
        let weights = attributes.entries().find(|(key, _)| key.strip_prefix("WEIGHTS_") == Some(set));
        let Some((_, weights)) = weights else {
            return Err(index.error(format!("WEIGHTS_{set} are missing for these joints")));
        };
        let weights = data.attribute::<4>(weights, Some(count))?;
        let accessor = data.accessor(index)?;
        let indices = data.attribute::<4>(index, Some(count))?;
        if set == "0" {
            firsts = indices.iter().map(|joints| joints[0]).collect();
        }
        for (vertex, (indices, weights)) in indices.into_iter().zip(weights).enumerate() {
            for (joint, weight) in indices.into_iter().zip(weights) {
                if weight == 0.0 || !weight.is_finite() {
                    continue;
                }
                let Some(matrix) = joints.0.get(joint as usize) else {
                    let message = format!(
                        "vertex {vertex} refers to joint {joint}, but there are only {}",
                        joints.0.len()
                    );
                    return Err(accessor.node.error(message));
                };
                blends.add(vertex, matrix, f64::from(weight));
            }
        }
    }
    // Weights that are not finite were skipped, so they are among these.
    if blends.are_uneven() {
        let what = "the weights of a skin do not add up to 1; they are normalised";
        data.note(what, || attributes.at());
    }
    if blends.lack_some() {
        let what = "some vertices of a skin have no weights; they follow the first joint that they name";
        data.note(what, || attributes.at());
    }
    // The specification does not say where vertices without weights are; this is where three.js and its kin put them.
    let first = |vertex: usize| Some(*joints.0.get(*firsts.get(vertex)? as usize)?);
    moved(mesh, &blends.matrices(|vertex| first(vertex).unwrap_or(DMat4::IDENTITY)));
    Ok(())
}

/// Transforms each vertex by its own matrix.
fn moved(mesh: &mut Mesh, by: &[DMat4]) {
    move_points(&mut mesh.positions, by);
    for (n, m) in mesh.normals.iter_mut().zip(by) {
        *n = turned(*n, m);
    }
    for (t, m) in mesh.tangents.iter_mut().zip(by) {
        let along = m.transform_vector3(t.truncate().as_dvec3()).normalize_or_zero();
        *t = along.as_vec3().extend(if m.determinant() < 0.0 { -t.w } else { t.w });
    }
    // A mirrored mesh has the opposite winding. [glTF 2.0, 3.7.4]
    if are_mirrored(by) {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
}

//! Skins: each vertex follows several joints, by weights.

use crate::dae::data::{Table, input, inputs, names_with_spaces};
use crate::dae::element::Element;
use crate::dae::graph::{Graph, Placed};
use crate::dae::posed::Posed;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{PolygonMesh, Workshop};
use bilux_math::DMat4;
use std::collections::HashMap;

/// The most skeletons of an instance in which joints are looked for.
const MAX_SKELETONS: usize = 64;

/// Moves a mesh to where its joints are, in world space. Vertices without weights stay on their node.
pub(super) fn bend<'d>(
    skin: Element<'d>,
    instance: Element<'d>,
    mesh: &mut PolygonMesh,
    placed: &Placed<'d>,
    posed: &Posed<'_, 'd>,
    graph: &Graph<'d>,
    workshop: &mut Workshop,
) -> Result<(), FormatError> {
    let (document, count) = (posed.document, mesh.positions.len());
    let shape = match skin.child("bind_shape_matrix") {
        Some(element) => matrix(&element.numbers::<f64>(workshop.budget)?).unwrap_or(DMat4::IDENTITY),
        None => DMat4::IDENTITY,
    };
    let still = placed.world * shape;
    workshop.budget.take_bytes((count * size_of::<(DMat4, f64)>()) as u64, skin.file())?;
    let (mut blends, mut sums) = (vec![DMat4::ZERO; count], vec![0f64; count]);
    let joints = skin.child("joints").map(|joints| inputs(joints, document)).unwrap_or_default();
    let joints = match input(&joints, "JOINT") {
        Some(source) => {
            let places = places(source, skin, instance, placed, posed, graph, workshop)?;
            let bind = input(&joints, "INV_BIND_MATRIX");
            let bind = bind.map(|bind| Table::<f64>::read(bind, document, workshop.budget)).transpose()?;
            let inverse = |i: usize| bind.as_ref().and_then(|bind| matrix(bind.row(i)?));
            let whole = |(i, place): (usize, &Option<DMat4>)| {
                place.map_or(still, |place| place * inverse(i).unwrap_or(DMat4::IDENTITY) * shape)
            };
            places.iter().enumerate().map(whole).collect()
        }
        None => Vec::new(),
    };
    add_weights(skin, &joints, still, &mut blends, &mut sums, posed, workshop)?;
    for (blend, sum) in blends.iter_mut().zip(&sums) {
        *blend = if *sum == 0.0 { still } else { *blend * (1.0 / sum) };
    }
    mesh.bend(&blends, workshop, skin.file())?;
    workshop.budget.release((count * size_of::<(DMat4, f64)>()) as u64);
    Ok(())
}

/// Adds the matrix of each joint to its vertices, by weight.
fn add_weights(
    skin: Element,
    joints: &[DMat4],
    still: DMat4,
    blends: &mut [DMat4],
    sums: &mut [f64],
    posed: &Posed,
    workshop: &mut Workshop,
) -> Result<(), FormatError> {
    let Some(element) = skin.child("vertex_weights") else { return Ok(()) };
    let inputs = inputs(element, posed.document);
    let offset_of = |semantic: &str| {
        inputs.iter().find(|input| input.semantic == semantic).map(|input| (input.source, input.offset))
    };
    let (Some((_, joint_at)), Some((weights, weight_at))) = (offset_of("JOINT"), offset_of("WEIGHT")) else {
        return Ok(());
    };
    let weights = Table::<f64>::read(weights, posed.document, workshop.budget)?;
    let list = |name: &str, workshop: &mut Workshop| -> Result<Vec<i32>, FormatError> {
        element.child(name).map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))
    };
    let (counts, indices) = (list("vcount", workshop)?, list("v", workshop)?);
    let stride = inputs.iter().map(|input| input.offset + 1).max().unwrap_or(1);
    let mut pairs = indices.chunks_exact(stride);
    for (vertex, &number) in counts.iter().enumerate().take(blends.len()) {
        for pair in pairs.by_ref().take(usize::try_from(number).unwrap_or(0)) {
            let weight =
                usize::try_from(pair[weight_at]).ok().and_then(|row| weights.row(row)?.first().copied());
            // A joint of -1 is the mesh as it was bound.
            let joint = match pair[joint_at] {
                -1 => Some(&still),
                joint => usize::try_from(joint).ok().and_then(|joint| joints.get(joint)),
            };
            match joint.zip(weight.filter(|weight| weight.is_finite())) {
                Some((joint, weight)) => {
                    blends[vertex] += *joint * weight;
                    sums[vertex] += weight;
                }
                None => {
                    let what = "a vertex follows a joint or has a weight that does not exist";
                    workshop.diagnostics.note(what, || element.at());
                }
            }
        }
    }
    if counts.len() < blends.len() {
        let what = "some vertices of a skin have no weights, and stay on their node";
        workshop.diagnostics.note(what, || element.at());
    }
    workshop.budget.release(4 * (counts.len() + indices.len()) as u64);
    Ok(())
}

/// Transform of each joint; `None` for one that is missing. A name is a sid in the skeletons of the instance, or else
/// anywhere in the scene, or an id, or even just a name.
fn places<'d>(
    source: Element<'d>,
    skin: Element<'d>,
    instance: Element<'d>,
    placed: &Placed<'d>,
    posed: &Posed<'_, 'd>,
    graph: &Graph<'d>,
    workshop: &mut Workshop,
) -> Result<Vec<Option<DMat4>>, FormatError> {
    let document = posed.document;
    let skeletons = instance
        .children_named("skeleton")
        .take(MAX_SKELETONS)
        .filter_map(|skeleton| document.target(skeleton.text()));
    let mut known: HashMap<&str, DMat4> = HashMap::new();
    let mut learn = |key: Option<&'d str>, node: Element<'d>| {
        if let (Some(key), Some(world)) = (key, graph.world_of(node)) {
            known.entry(key).or_insert(world);
        }
    };
    workshop.budget.take::<(&str, DMat4)>(2 * graph.nodes.len(), skin.file())?;
    for skeleton in skeletons {
        let nodes = skeleton.descendants().filter(|element| element.name() == "node");
        nodes.for_each(|node| learn(node.attribute("sid"), node));
    }
    for attribute in ["sid", "id", "name"] {
        graph.nodes.iter().for_each(|placed| learn(placed.node.attribute(attribute), placed.node));
    }
    let names = names_with_spaces(source, document, workshop.budget, |name| known.contains_key(name))?;
    let places: Vec<Option<DMat4>> = names.iter().map(|name| known.get(name).copied()).collect();
    if places.contains(&None) {
        let what = "a joint of a skin is not in the scene; its vertices stay on their node";
        workshop.diagnostics.note(what, || placed.node.at());
    }
    Ok(places)
}

/// A matrix, whose rows follow each other.
fn matrix(numbers: &[f64]) -> Option<DMat4> {
    let matrix = DMat4::from_cols_array(numbers.first_chunk::<16>()?).transpose();
    Some(matrix).filter(|matrix| matrix.is_finite())
}

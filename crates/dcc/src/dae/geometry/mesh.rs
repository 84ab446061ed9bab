//! A mesh as the file has it.

use super::builder::{Builder, Symbol};
use super::primitives::{LINES, Primitive, SURFACES};
use crate::dae::data::{Input, inputs};
use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::{PolygonMesh, Workshop};

/// Polygons, and the names by which nodes give them materials.
pub(in crate::dae) struct Mesh<'d> {
    pub(in crate::dae) polygons: PolygonMesh,
    /// The symbol of each number of a material.
    pub(in crate::dae) symbols: Vec<Symbol<'d>>,
}

/// The mesh of a geometry; `None` if it has no polygons.
pub(in crate::dae) fn read<'d>(
    geometry: Element<'d>,
    document: &Document<'d>,
    workshop: &mut Workshop,
) -> Result<Option<Mesh<'d>>, FormatError> {
    for name in ["convex_mesh", "spline", "brep"] {
        if let Some(other) = geometry.child(name) {
            workshop.diagnostics.not_shown(&format!("<{name}>"), || other.at());
        }
    }
    let Some(mesh) = geometry.child("mesh") else { return Ok(None) };
    let elements = mesh.children().filter(|element| SURFACES.contains(&element.name()));
    let all: Vec<(Element, Vec<Input>)> =
        elements.map(|element| (element, corners_inputs(element, document))).collect();
    // The edges of surfaces; lines alone are shown.
    let edges = mesh.children().find(|element| LINES.contains(&element.name())).filter(|_| !all.is_empty());
    if let Some(edges) = edges {
        workshop.diagnostics.not_shown("lines", || edges.at());
    }
    let mut builder = Builder::for_inputs(all.iter().map(|(_, inputs)| &inputs[..]));
    let mut symbols: Vec<Symbol> = Vec::new();
    for (element, inputs) in &all {
        builder.begin(*element, inputs, &mut symbols, document, workshop)?;
        if builder.has_positions() {
            let stride = stride_of(*element, inputs);
            Primitive { element: *element, stride }.add(&mut builder, workshop)?;
        } else {
            workshop.diagnostics.note("polygons without positions are left out", || element.at());
        }
    }
    Ok(builder.finish(geometry, workshop).map(|polygons| Mesh { polygons, symbols }))
}

/// The number of indices of each vertex of a primitive.
pub(super) fn stride_of(element: Element, inputs: &[Input]) -> usize {
    let stride = inputs.iter().map(|input| input.offset + 1).max().unwrap_or(1);
    stride.max(declared_stride(element))
}

/// The inputs of a primitive, with those of its vertices in place of the vertices themselves.
pub(super) fn corners_inputs<'d>(element: Element<'d>, document: &Document<'d>) -> Vec<Input<'d>> {
    let mut all = Vec::new();
    for direct in inputs(element, document) {
        if direct.semantic == "VERTEX" {
            let of_vertex = inputs(direct.source, document).into_iter();
            all.extend(of_vertex.map(|inner| Input { offset: direct.offset, ..inner }));
        } else {
            all.push(direct);
        }
    }
    all
}

/// The number of indices of a vertex by the offsets that are stated, even of inputs that do not exist.
fn declared_stride(element: Element) -> usize {
    let offsets = element.children_named("input").filter_map(|input| input.attribute("offset"));
    // An offset beyond this is none of a vertex.
    let known = offsets.filter_map(|offset| offset.trim().parse::<usize>().ok()).filter(|&o| o < 1024);
    known.map(|offset| offset + 1).max().unwrap_or(1)
}

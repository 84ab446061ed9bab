//! Lines, of geometries that have nothing else.

use super::builder::Symbol;
use super::channel::Channel;
use super::mesh::{corners_inputs, stride_of};
use super::primitives::LINES;
use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::Workshop;
use bilux_math::Vec3;
use bilux_scene::Mesh;

/// The lines of a geometry, and the name by which nodes give them a material; `None` if it has none.
pub(in crate::dae) fn lines<'d>(
    geometry: Element<'d>,
    document: &Document<'d>,
    workshop: &mut Workshop,
) -> Result<Option<(Mesh, Symbol<'d>)>, FormatError> {
    let Some(mesh) = geometry.child("mesh") else { return Ok(None) };
    let mut positions = Channel::new();
    let (mut lines, mut symbol) = (Vec::new(), None);
    for element in mesh.children().filter(|element| LINES.contains(&element.name())) {
        let inputs = corners_inputs(element, document);
        let Some(found) = inputs.iter().find(|input| input.semantic == "POSITION") else { continue };
        let place = |row: &[f32]| {
            let at = |i: usize| row.get(i).copied().unwrap_or(0.0);
            Vec3::new(at(0), at(1), at(2))
        };
        let range = positions.range(found.source, found.offset, place, document, workshop.budget)?;
        let stride = stride_of(element, &inputs);
        symbol = symbol.or(Some(Symbol { name: element.attribute("material"), sets: Vec::new() }));
        for list in element.children_named("p") {
            let indices: Vec<i32> = list.numbers(workshop.budget)?;
            let vertices: Vec<Option<u32>> = indices.chunks_exact(stride).map(|v| range.place(v)).collect();
            workshop.budget.take::<[u32; 4]>(vertices.len(), list.file())?;
            let step = if element.name() == "lines" { 2 } else { 1 };
            for ends in vertices.windows(2).step_by(step) {
                match ends {
                    [Some(a), Some(b)] => lines.push([*a, *b]),
                    _ => workshop
                        .diagnostics
                        .note("a line refers to a vertex that does not exist", || list.at()),
                }
            }
            workshop.budget.release(4 * indices.len() as u64);
        }
    }
    let mesh = Mesh { name: geometry.label(), positions: positions.into_values(), lines, ..Mesh::default() };
    Ok(symbol.filter(|_| !mesh.lines.is_empty()).map(|symbol| (mesh, symbol)))
}

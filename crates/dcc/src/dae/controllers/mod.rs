//! Deformers of meshes: skins on bones, and morphs between shapes.

mod morph;
mod skin;

use super::element::Element;
use super::geometry::{self, Mesh};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::meshes::polygon_mesh::Workshop;

/// A mesh after what deforms it.
pub(super) struct Shaped<'d> {
    pub(super) mesh: Mesh<'d>,
    /// True if bones have moved it to world space.
    pub(super) is_in_world: bool,
}

/// Controllers of controllers of controllers are refused.
const MAX_DEPTH: usize = 16;

/// The mesh of a geometry or a controller on a node; `None` if it has no polygons.
pub(super) fn shaped<'d>(
    target: Element<'d>,
    instance: Element<'d>,
    placed: &Placed<'d>,
    posed: &Posed<'_, 'd>,
    graph: &Graph<'d>,
    workshop: &mut Workshop,
) -> Result<Option<Shaped<'d>>, FormatError> {
    let document = posed.document;
    // From the controller of the node to the geometry.
    let mut chain = Vec::new();
    let mut current = target;
    while current.name() == "controller" {
        let child = current.children().find(|child| matches!(child.name(), "skin" | "morph"));
        let Some(child) = child else {
            return Err(current.error("this controller has no skin and no morph"));
        };
        if chain.len() >= MAX_DEPTH {
            return Err(current.error("this controller deforms itself, or too many others"));
        }
        chain.push(child);
        let Some(next) = document.referred(child, "source", workshop.diagnostics) else { return Ok(None) };
        current = next;
    }
    let Some(mesh) = geometry::read(current, document, workshop)? else { return Ok(None) };
    let mut shaped = Shaped { mesh, is_in_world: false };
    for controller in chain.into_iter().rev() {
        if controller.name() == "morph" && shaped.is_in_world {
            // Its shapes are where the mesh was before its bones moved it.
            workshop.diagnostics.not_shown("morphs of meshes that bones have moved", || controller.at());
        } else if controller.name() == "morph" {
            morph::blend(controller, &mut shaped.mesh.polygons, posed, workshop)?;
        } else {
            skin::bend(controller, instance, &mut shaped.mesh.polygons, placed, posed, graph, workshop)?;
            shaped.is_in_world = true;
        }
    }
    Ok(Some(shaped))
}

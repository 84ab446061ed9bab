//! The meshes of nodes. One that several nodes share is made once, unless something deforms it.

use super::controllers::{self, Shaped};
use super::effects::{Bindings, Materials};
use super::element::Element;
use super::geometry::{Symbol, lines};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use bilux_import::FormatError;
use bilux_import::geometry::flat;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_import::meshes::polygon_mesh::{Part, Workshop, parts};
use bilux_math::DMat4;
use bilux_scene::Object;
use roxmltree::NodeId;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// The meshes that have been read, and the materials that they are of.
#[derive(Default)]
pub(super) struct Meshes<'d> {
    /// Meshes that nothing deforms.
    made: HashMap<NodeId, Rc<Made<'d>>>,
    materials: Materials<'d>,
}

/// A mesh in parts of one material each.
struct Made<'d> {
    parts: Vec<Part>,
    symbols: Vec<Symbol<'d>>,
    /// True if bones have moved it to world space.
    is_in_world: bool,
}

impl<'d> Meshes<'d> {
    /// Adds the meshes of a node to the scene.
    pub(super) fn place(
        &mut self,
        placed: &Placed<'d>,
        posed: &Posed<'_, 'd>,
        graph: &Graph<'d>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        for instance in placed.node.children() {
            let is_controller = instance.name() == "instance_controller";
            if !is_controller && instance.name() != "instance_geometry" {
                continue;
            }
            let found = posed.document.referred(instance, "url", &mut sink.diagnostics);
            let Some(target) = found else { continue };
            let made = match self.made.get(&target.key()) {
                Some(made) => made.clone(),
                None => {
                    let made = Rc::new(make(target, instance, placed, posed, graph, reading, sink)?);
                    if target.name() == "geometry" {
                        self.made.insert(target.key(), made.clone());
                    }
                    made
                }
            };
            let own = placed.frame.within(target, &mut sink.diagnostics);
            let world = placed.world * placed.frame.from(own);
            let world = if made.is_in_world { DMat4::IDENTITY } else { world };
            self.place_parts(&made, &world, instance, placed.node, posed, reading, sink)?;
        }
        Ok(())
    }

    /// Adds the parts of a mesh to the scene.
    #[expect(clippy::too_many_arguments, reason = "a mesh, where it is, and all that a read needs")]
    fn place_parts(
        &mut self,
        made: &Made<'d>,
        world: &DMat4,
        instance: Element<'d>,
        node: Element<'d>,
        posed: &Posed<'_, 'd>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        let name = node.label();
        let each = size_of::<[Object; 2]>() + name.len();
        reading.budget.take_bytes((each * made.parts.len()) as u64, node.file())?;
        let bindings = Bindings::of(instance, posed.document, &mut sink.diagnostics);
        for part in &made.parts {
            let worn = bindings.worn(&made.symbols[part.material], posed.document);
            let material = self.materials.index(worn, posed, reading, sink)?;
            let Some((mesh, motion)) = flat::placed(&part.mesh, world, &mut reading.budget, node.file())?
            else {
                sink.diagnostics.remark("a node with a scale of zero is not shown", || node.at());
                continue;
            };
            let object = Object::new(&name, mesh, material);
            sink.scene.objects.push(Object { motion, ..object });
        }
        Ok(())
    }
}

/// Makes the parts of a geometry, or of what a controller makes of one.
fn make<'d>(
    target: Element<'d>,
    instance: Element<'d>,
    placed: &Placed<'d>,
    posed: &Posed<'_, 'd>,
    graph: &Graph<'d>,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<Made<'d>, FormatError> {
    let (file, spent) = (target.file(), reading.budget.spent());
    let crease_angle = reading.crease_angle;
    let mut workshop =
        Workshop { budget: &mut reading.budget, diagnostics: &mut sink.diagnostics, crease_angle };
    let shaped = controllers::shaped(target, instance, placed, posed, graph, &mut workshop)?;
    let Some(Shaped { mesh, is_in_world }) = shaped else {
        let found =
            if target.name() == "geometry" { lines(target, posed.document, &mut workshop)? } else { None };
        let part = |(mesh, symbol)| (Part { mesh: Arc::new(mesh), material: 0 }, symbol);
        let (parts, symbols) = found.map(part).into_iter().unzip();
        return Ok(Made { parts, symbols, is_in_world: false });
    };
    let mut polygons = mesh.polygons;
    polygons.add_normals(&mut workshop, file)?;
    let parts = parts(polygons, &mut workshop, file)?;
    // What is left of all that was needed meanwhile.
    let kept: u64 = parts.iter().map(|part| part.mesh.size() + size_of::<Part>() as u64).sum();
    reading.budget.release((reading.budget.spent() - spent).saturating_sub(kept));
    Ok(Made { parts, symbols: mesh.symbols, is_in_world })
}

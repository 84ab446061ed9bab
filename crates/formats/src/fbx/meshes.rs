//! The meshes of nodes. One that several nodes share is made once.

use super::document::{Document, Index, display_name};
use super::geometry::{Geometry, Part, Workshop, parts};
use super::graph::{Graph, Placed};
use super::posed::Posed;
use super::tree::Value;
use crate::FormatError;
use crate::flat;
use crate::oddities::Oddities;
use crate::reading::{Reading, default_material};
use crate::sink::Sink;
use bilux_math::Transform;
use bilux_math::motion::Motion;
use bilux_scene::Object;
use std::collections::HashMap;
use std::sync::Arc;

/// The meshes that have been read.
#[derive(Default)]
pub(super) struct Meshes {
    parts: HashMap<Index, Arc<Vec<Part>>>,
}

impl Meshes {
    /// Adds the meshes of a node to the scene.
    pub(super) fn place(
        &mut self,
        placed: &Placed,
        posed: &Posed,
        _graph: &Graph,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        let document = posed.document;
        for geometry in geometries(document, placed.model) {
            let parts = self.parts(geometry, posed, reading, sink)?;
            let world = placed.world * placed.geometric;
            let name = display_name(document.object(placed.model).name);
            if sink.scene.materials.is_empty() {
                sink.scene.add_material(default_material());
            }
            let motion = Transform::from_matrix(world).map(Motion::still);
            let each = size_of::<[Object; 2]>() + name.len() + motion.as_ref().map_or(0, Motion::heap_bytes);
            reading.budget.take_bytes((each * parts.len()) as u64, document.file())?;
            for part in parts.iter() {
                let material = 0;
                let object = match &motion {
                    Some(motion) => {
                        Object { motion: motion.clone(), ..Object::new(&name, part.mesh.clone(), material) }
                    }
                    None if flat::rank(&world) == 2 => {
                        reading.budget.take_bytes(part.mesh.size(), document.file())?;
                        Object::new(&name, Arc::new(flat::flattened(&part.mesh, &world)), material)
                    }
                    None => {
                        note_vanished(document, placed.model, &mut sink.oddities);
                        continue;
                    }
                };
                sink.scene.objects.push(object);
            }
        }
        Ok(())
    }

    /// The parts of a mesh.
    fn parts(
        &mut self,
        index: Index,
        posed: &Posed,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Arc<Vec<Part>>, FormatError> {
        if let Some(parts) = self.parts.get(&index) {
            return Ok(parts.clone());
        }
        let document = posed.document;
        let object = document.object(index);
        let spent = reading.budget.spent();
        let crease_angle = reading.crease_angle;
        let mut workshop =
            Workshop { budget: &mut reading.budget, oddities: &mut sink.oddities, crease_angle };
        let name = display_name(object.name);
        let parts = match Geometry::read(object.node, name, false, &mut workshop)? {
            Some(mut geometry) => {
                geometry.add_normals(&mut workshop, document.file())?;
                parts(geometry, &mut workshop, document.file())?
            }
            None => {
                let kind = if object.kind.is_empty() {
                    "a geometry without polygons".into()
                } else {
                    display_name(object.kind)
                };
                workshop.oddities.not_shown(&kind, || object.node.at());
                Vec::new()
            }
        };
        if object.node.child_value("Smoothness").and_then(Value::integer).is_some_and(|kind| kind > 0) {
            workshop.oddities.not_shown("subdivision of meshes", || object.node.at());
        }
        // What is left of all that was needed meanwhile.
        let kept: u64 = parts.iter().map(|part| part.mesh.size() + size_of::<Part>() as u64).sum();
        reading.budget.release((reading.budget.spent() - spent).saturating_sub(kept));
        let parts = Arc::new(parts);
        self.parts.insert(index, parts.clone());
        Ok(parts)
    }
}

/// The meshes of a node: objects of their own, or before version 7 the node itself.
fn geometries(document: &Document, model: Index) -> Vec<Index> {
    let mut geometries: Vec<Index> = document.sources_of_class(model, "Geometry").collect();
    if document.object(model).node.child("Vertices").is_some() {
        geometries.push(model);
    }
    geometries
}

fn note_vanished(document: &Document, model: Index, oddities: &mut Oddities) {
    let what = "a node with a scale of zero is not shown";
    oddities.remark(what, || document.object(model).node.at());
}

//! The meshes of nodes. One that several nodes share is made once, unless bones move it.

use super::deform::Deformers;
use super::document::{Document, Index, display_name};
use super::geometry::{self, layers_named};
use super::graph::{Graph, Placed};
use super::materials::{Materials, Worn};
use super::posed::Posed;
use super::subdivision;
use super::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::geometry::flat;
use bilux_import::geometry::subdivision::{Cage, PendingCage};
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use bilux_import::meshes::polygon_mesh::{Part, Workshop, parts};
use bilux_math::DMat4;
use bilux_scene::Object;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The meshes that have been read, and the materials that they are of.
pub(super) struct Meshes<'d> {
    /// Parts of meshes that do not deform.
    parts: HashMap<Index, Arc<Vec<Part>>>,
    materials: Materials<'d>,
    /// The sets of texture coordinates that textures name.
    named_sets: HashSet<&'d [u8]>,
}

impl<'d> Meshes<'d> {
    pub(super) fn new(document: &Document<'d>) -> Meshes<'d> {
        let textures = document.indices().filter(|&index| document.class(index) == b"Texture");
        let named_sets = textures.filter_map(|texture| document.properties(texture).text("UVSet")).collect();
        Meshes { parts: HashMap::new(), materials: Materials::default(), named_sets }
    }

    /// Adds the meshes of a node to the scene.
    pub(super) fn place(
        &mut self,
        placed: &Placed,
        posed: &Posed<'d>,
        graph: &Graph,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        let document = posed.document;
        for geometry in geometries(document, placed.model) {
            let deformers = Deformers::of(geometry, posed, reading, &mut sink.diagnostics)?;
            // What bones move is in world space, wherever its node is.
            let world = if deformers.has_skin() { DMat4::IDENTITY } else { placed.world * placed.geometric };
            let parts = match self.parts.get(&geometry).filter(|_| deformers.is_empty()) {
                Some(parts) => parts.clone(),
                None => {
                    let made = self.make(geometry, &deformers, placed, posed, graph, reading, sink)?;
                    let made = Arc::new(made);
                    reading.budget.release(deformers.bytes());
                    if deformers.is_empty() {
                        self.parts.insert(geometry, made.clone());
                    }
                    made
                }
            };
            self.place_parts(&parts, &world, geometry, placed, posed, reading, sink)?;
        }
        Ok(())
    }

    /// Adds the parts of a mesh to the scene.
    #[expect(clippy::too_many_arguments, reason = "a mesh, where it is, and all that a read needs")]
    fn place_parts(
        &mut self,
        parts: &[Part],
        world: &DMat4,
        geometry: Index,
        placed: &Placed,
        posed: &Posed<'d>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<(), FormatError> {
        let document = posed.document;
        let node = document.object(placed.model).node;
        let name = display_name(document.object(placed.model).name);
        let each = size_of::<[Object; 2]>() + name.len();
        reading.budget.take_bytes((each * parts.len()) as u64, document.file())?;
        let choice = self.choice(geometry, placed.model, document);
        for part in parts {
            let worn = choice.worn(part.material);
            let material = self.materials.index(worn, posed, reading, sink)?;
            let Some((mesh, motion)) = flat::placed(&part.mesh, world, &mut reading.budget, document.file())?
            else {
                sink.diagnostics.remark("a node with a scale of zero is not shown", || node.at());
                continue;
            };
            let object = Object::new(&name, mesh, material);
            sink.scene.objects.push(Object { motion, ..object });
        }
        Ok(())
    }

    /// The materials and textures among which those of a mesh are chosen.
    fn choice(&self, geometry: Index, model: Index, document: &Document<'d>) -> Choice<'d> {
        let second_set = second_set(document.object(geometry).node).and_then(|(_, name)| name);
        Choice {
            materials: document.sources_of_class(model, "Material").collect(),
            textures: document.sources_of_class(model, "Texture").collect(),
            second_set: second_set.filter(|name| self.named_sets.contains(name)),
        }
    }

    /// Makes the parts of a mesh.
    #[expect(clippy::too_many_arguments, reason = "a mesh, what deforms it, and all that a read needs")]
    fn make(
        &self,
        index: Index,
        deformers: &Deformers,
        placed: &Placed,
        posed: &Posed,
        graph: &Graph,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Vec<Part>, FormatError> {
        let document = posed.document;
        let object = document.object(index);
        let spent = reading.budget.spent();
        let crease_angle = reading.crease_angle;
        let mut workshop =
            Workshop { budget: &mut reading.budget, diagnostics: &mut sink.diagnostics, crease_angle };
        let has_second = second_set(object.node).and_then(|(_, name)| name);
        let has_second = has_second.is_some_and(|name| self.named_sets.contains(name));
        let made = match geometry::read(object.node, display_name(object.name), has_second, &mut workshop)? {
            Some(mut geometry) => {
                deformers.apply(&mut geometry, placed, posed, graph, &mut workshop)?;
                if subdivision::is_smooth(object.node) {
                    if !reading.options.whole_movement {
                        let (cage, materials) = subdivision::cage(object.node, &geometry, &mut workshop)?;
                        return Ok(waiting(cage, materials, &geometry.name, object.node, reading));
                    }
                    workshop.diagnostics.not_shown("subdivision of meshes that move", || object.node.at());
                }
                geometry.add_normals(&mut workshop, document.file())?;
                parts(geometry, &mut workshop, document.file())?
            }
            None => {
                let kind =
                    if object.kind.is_empty() { &b"a geometry without polygons"[..] } else { object.kind };
                workshop.diagnostics.not_shown(&display_name(kind), || object.node.at());
                Vec::new()
            }
        };
        // What is left of all that was needed meanwhile.
        let kept: u64 = made.iter().map(|part| part.mesh.size() + size_of::<Part>() as u64).sum();
        reading.budget.release((reading.budget.spent() - spent).saturating_sub(kept));
        Ok(made)
    }
}

/// The parts of a mesh whose cage is refined when the whole scene is known.
fn waiting(cage: Cage, materials: Vec<usize>, name: &str, node: Node, reading: &mut Reading) -> Vec<Part> {
    let pending = PendingCage::new(cage, materials.iter().map(|_| name.to_owned()), node.at());
    let parts = materials.into_iter().enumerate();
    let parts = parts.map(|(group, material)| Part { mesh: pending.mesh(group).clone(), material });
    let parts = parts.collect();
    reading.cages.push(pending);
    parts
}

/// The materials of a node, and before version 7 its textures.
struct Choice<'d> {
    materials: Vec<Index>,
    textures: Vec<Index>,
    second_set: Option<&'d [u8]>,
}

impl<'d> Choice<'d> {
    /// The material of a part with this number; the last one if there are fewer.
    fn worn(&self, number: usize) -> Worn<'d> {
        let of = |all: &[Index]| all.get(number).or(all.last()).copied();
        Worn { material: of(&self.materials), second_set: self.second_set, texture: of(&self.textures) }
    }
}

/// The second set of texture coordinates of a mesh, with its name.
fn second_set<'d>(mesh: Node<'d>) -> Option<(Node<'d>, Option<&'d [u8]>)> {
    let layer = layers_named(mesh, "LayerElementUV").into_iter().nth(1)?;
    Some((layer, layer.child_value("Name").and_then(Value::text)))
}

/// The meshes of a node: objects of their own, or before version 7 the node itself.
fn geometries(document: &Document, model: Index) -> Vec<Index> {
    let mut geometries: Vec<Index> = document.sources_of_class(model, "Geometry").collect();
    if document.object(model).node.child("Vertices").is_some() {
        geometries.push(model);
    }
    geometries
}

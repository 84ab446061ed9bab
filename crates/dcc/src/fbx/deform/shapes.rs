//! Blend shapes: offsets of vertices, as far as their channel says.

use crate::fbx::document::Index;
use bilux_import::FormatError;
use bilux_import::geometry::deformation::amounts;
use bilux_import::meshes::polygon_mesh::{PolygonMesh, Workshop};

use crate::fbx::posed::Posed;
use crate::fbx::tree::{Node, Value};
use bilux_math::Vec3;

/// A channel with the shapes that it runs through.
pub(super) struct Channel<'d> {
    /// Position of the channel, in percent.
    pub(super) percent: f64,
    /// The list of the percentages at which each shape is reached.
    full: Option<Node<'d>>,
    /// The list of how much each offset of the only shape counts, in percent.
    of_offsets: Option<Node<'d>>,
    shapes: Vec<Node<'d>>,
}

/// The channels of a deformer.
pub(super) fn channels<'d>(deformer: Index, posed: &Posed<'d>) -> Vec<Channel<'d>> {
    let document = posed.document;
    let channels = document.sources_of_class(deformer, "Deformer");
    channels
        .map(|channel| {
            let node = document.object(channel).node;
            let stated = node.child_value("DeformPercent").and_then(Value::number);
            let percent = posed.properties(channel).number("DeformPercent").or(stated).unwrap_or(0.0);
            let shapes = document.sources_of_class(channel, "Geometry");
            let shapes = shapes.map(|shape| document.object(shape).node).collect();
            let (full, of_offsets) = match node.child("FullWeights") {
                // Blender has no shapes in between, and writes the weights of its vertices here.
                list if document.settings.is_of_blender => (None, list),
                list => (list, None),
            };
            Channel { percent, full, of_offsets, shapes }
        })
        .collect()
}

/// Before version 7, the shapes are in the mesh, and each has a property with its name.
pub(super) fn old_channels<'d>(mesh: Index, posed: &Posed<'d>) -> Vec<Channel<'d>> {
    let node = posed.document.object(mesh).node;
    if node.child("Shape").is_none() {
        return Vec::new();
    }
    let properties = posed.properties(mesh);
    let channel = |shape: Node<'d>| {
        let name = shape.value(0)?.text()?;
        let percent = properties.number(std::str::from_utf8(name).ok()?).unwrap_or(0.0);
        Some(Channel { percent, full: None, of_offsets: None, shapes: vec![shape] })
    };
    node.children_named("Shape").filter_map(channel).collect()
}

impl Channel<'_> {
    /// Weight of each shape.
    fn weights(&self, workshop: &mut Workshop) -> Result<Vec<f64>, FormatError> {
        let mut full: Vec<f64> = self.full.map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))?;
        full.resize(self.shapes.len(), 100.0);
        Ok(amounts(&full, self.percent))
    }

    /// Adds what there is of the shapes to a mesh, and how they turn the normals at each control point to `turns`.
    pub(super) fn add(
        &self,
        geometry: &mut PolygonMesh,
        turns: &mut Vec<Vec3>,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        for (shape, weight) in self.shapes.iter().zip(self.weights(workshop)?) {
            if weight == 0.0 {
                continue;
            }
            let list = |name: &str, workshop: &mut Workshop| -> Result<Vec<f32>, FormatError> {
                shape.child(name).map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))
            };
            let indices: Vec<i32> =
                shape.child("Indexes").map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))?;
            let (moved, turned) = (list("Vertices", workshop)?, list("Normals", workshop)?);
            let own: Vec<f32> =
                self.of_offsets.map_or(Ok(Vec::new()), |list| list.numbers(workshop.budget))?;
            let own = if own.len() == indices.len() { own } else { Vec::new() };
            let offset = |number: usize, offset: &[f32; 3]| {
                Vec3::from(*offset) * weight as f32 * own.get(number).map_or(1.0, |percent| percent / 100.0)
            };
            for (number, (&index, by)) in indices.iter().zip(moved.as_chunks::<3>().0).enumerate() {
                let position =
                    usize::try_from(index).ok().and_then(|index| geometry.positions.get_mut(index));
                match position {
                    Some(position) => *position += offset(number, by),
                    None => {
                        let what = "a blend shape moves a vertex that the mesh does not have";
                        workshop.diagnostics.note(what, || shape.at());
                    }
                }
            }
            if turned.len() >= 3 * indices.len() && turned.iter().any(|x| *x != 0.0) {
                if turns.is_empty() {
                    workshop.budget.take_bytes(12 * geometry.positions.len() as u64, shape.file())?;
                    turns.resize(geometry.positions.len(), Vec3::ZERO);
                }
                for (number, (&index, by)) in indices.iter().zip(turned.as_chunks::<3>().0).enumerate() {
                    let slot = usize::try_from(index).ok().and_then(|index| turns.get_mut(index));
                    slot.into_iter().for_each(|slot| *slot += offset(number, by));
                }
            }
        }
        Ok(())
    }
}

//! The meshes of a file in the poses that its nodes give them.

use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use crate::geometry::primitive::{self, NodeMesh, Part};
use crate::graph::nodes::Placed;
use crate::graph::posed::Posed;
use crate::graph::skin::Joints;
use crate::materials::material::Materials;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_import::input::sink::Sink;
use std::collections::HashMap;
use std::sync::Arc;

/// The parts of each mesh that has been read, and the materials that they are of.
#[derive(Default)]
pub(crate) struct Meshes {
    parts: HashMap<PosedMesh, Arc<Vec<Part>>>,
    pub(crate) materials: Materials,
}

/// A mesh, the bits of its weights, and its skin.
type PosedMesh = (usize, Vec<u64>, Option<usize>);

impl Meshes {
    /// The parts of a node's mesh, made once for each combination of weights and skin.
    pub(crate) fn parts<'d>(
        &mut self,
        index: JsonNode<'d>,
        user: &Placed<'d>,
        posed: &Posed<'d>,
        reading: &mut Reading,
        sink: &mut Sink,
    ) -> Result<Arc<Vec<Part>>, FormatError> {
        let mesh = posed.document.named("meshes", index)?;
        let holder = if user.node.get("weights").is_some() { user.node } else { mesh };
        let weights: Vec<f64> = match posed.pose.weights(user.index) {
            Some(posed) => posed.to_vec(),
            None => holder.list("weights")?.iter().map(JsonNode::as_number).collect::<Result<_, _>>()?,
        };
        let skin = user.node.get("skin");
        let bits = weights.iter().map(|w| w.to_bits()).collect();
        let key = (index.as_count()?, bits, skin.map(|skin| skin.as_count()).transpose()?);
        if let Some(parts) = self.parts.get(&key) {
            return Ok(parts.clone());
        }
        let mut data = DataReader::new(posed.document, &mut reading.budget, &mut sink.diagnostics);
        let joints = skin.map(|skin| Joints::read(skin, posed, &mut data)).transpose()?;
        let worn = NodeMesh { name: mesh.name(), weights: &weights, joints: joints.as_ref() };
        let mut parts = Vec::new();
        for node in mesh.need("primitives")?.items()? {
            parts.extend(primitive::part(node, &worn, posed, &mut self.materials, reading, sink)?);
        }
        let parts = Arc::new(parts);
        self.parts.insert(key, parts.clone());
        Ok(parts)
    }

    /// Forgets the meshes with skins, since their keys do not include the time.
    pub(crate) fn forget_skinned(&mut self) {
        self.parts.retain(|(_, _, skin), _| skin.is_none());
    }
}

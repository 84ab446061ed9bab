//! Which materials the parts of a mesh have on a node, and which sets of texture coordinates their textures use.

use crate::dae::document::Document;
use crate::dae::element::Element;
use crate::dae::geometry::Symbol;
use bilux_import::input::diagnostics::Diagnostics;
use roxmltree::NodeId;
use std::hash::{Hash, Hasher};

/// A material on a mesh.
#[derive(Clone)]
pub(in crate::dae) struct Worn<'d> {
    pub(in crate::dae) material: Option<Element<'d>>,
    /// The names by which textures call the second set of texture coordinates.
    pub(in crate::dae) second_set: Vec<&'d str>,
    /// The names by which textures call sets after the second, which meshes here do not have.
    pub(in crate::dae) further_sets: Vec<&'d str>,
}

impl Worn<'_> {
    fn key(&self) -> (Option<NodeId>, &[&str], &[&str]) {
        (self.material.map(Element::key), &self.second_set, &self.further_sets)
    }
}

impl PartialEq for Worn<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Worn<'_> {}

impl Hash for Worn<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

/// The materials of a node's mesh by their symbols.
pub(in crate::dae) struct Bindings<'d> {
    /// The elements that bind them, and the materials.
    bound: Vec<(&'d str, Element<'d>, Element<'d>)>,
}

/// The most names of texture coordinates of a binding.
const MAX_NAMES: usize = 64;

impl<'d> Bindings<'d> {
    pub(in crate::dae) fn of(
        instance: Element<'d>,
        document: &Document<'d>,
        diagnostics: &mut Diagnostics,
    ) -> Bindings<'d> {
        let common = instance.path(&["bind_material", "technique_common"]);
        let elements = common.into_iter().flat_map(|common| common.children_named("instance_material"));
        let mut bound = Vec::new();
        for element in elements {
            let Some(symbol) = element.attribute("symbol") else { continue };
            let material = document.referred(element, "target", diagnostics);
            bound.extend(material.map(|material| (symbol, element, material)));
        }
        Bindings { bound }
    }

    /// The material of a part with this symbol, which may be that of a material itself.
    pub(in crate::dae) fn worn(&self, symbol: &Symbol<'d>, document: &Document<'d>) -> Worn<'d> {
        let found = self.bound.iter().find(|(name, ..)| Some(*name) == symbol.name);
        let Some((_, binding, material)) = found else {
            let direct = symbol.name.and_then(|name| document.target(name));
            let material = direct.filter(|element| element.name() == "material");
            return Worn { material, second_set: Vec::new(), further_sets: Vec::new() };
        };
        let (mut second_set, mut further_sets) = (Vec::new(), Vec::new());
        for input in binding.children_named("bind_vertex_input").take(MAX_NAMES) {
            let set = input.attribute("input_set").and_then(|set| set.trim().parse::<u32>().ok());
            let is_uv = input.attribute("input_semantic") == Some("TEXCOORD");
            let place = symbol.sets.iter().position(|known| is_uv && Some(*known) == set);
            match place {
                Some(1) => second_set.extend(input.attribute("semantic")),
                Some(2..) => further_sets.extend(input.attribute("semantic")),
                _ => {}
            }
        }
        Worn { material: Some(*material), second_set, further_sets }
    }
}

//! Chooses variants.

use super::layers::Layers;
use super::node::Node;
use crate::layers::value::{Text, Value};

/// The way to the first node with a set that was not chosen from, and the set.
pub(super) fn next(node: &Node, layers: &Layers) -> Option<(Vec<usize>, Text)> {
    let own = node.specs.iter().find_map(|(layer, prim, _)| {
        let sets = &layers.all[*layer as usize].prims[*prim as usize].variant_sets;
        sets.iter().map(|set| &set.name).find(|name| !node.chosen.contains(name))
    });
    if let Some(set) = own {
        return Some((Vec::new(), set.clone()));
    }
    node.children.iter().enumerate().find_map(|(i, child)| {
        let (mut place, set) = next(child, layers)?;
        place.insert(0, i);
        Some((place, set))
    })
}

/// The node at the end of a way.
pub(super) fn at<'n>(node: &'n mut Node, place: &[usize]) -> &'n mut Node {
    place.iter().fold(node, |node, &i| &mut node.children[i])
}

/// The variant of a set: what the user asks for, or else the strongest opinion.
pub(super) fn selected(node: &Node, set: &Text, layers: &Layers, known: &mut Vec<String>) -> Option<Text> {
    let mut variants: Vec<&Text> = Vec::new();
    let mut selected: Option<&Text> = None;
    node.visit(&mut |node: &Node| {
        for (layer, prim, _) in &node.specs {
            let spec = &layers.all[*layer as usize].prims[*prim as usize];
            for found in spec.variant_sets.iter().filter(|found| found.name == *set) {
                variants.extend(found.variants.iter().map(|(name, _)| name));
            }
            if let Some(Value::Selections(list)) = spec.fields.find("variants") {
                selected = selected.or(list.iter().find(|(of, _)| of == set).map(|(_, variant)| variant));
            }
        }
    });
    /// Names in the list of what can be chosen.
    const LISTED: usize = 256;
    for variant in &variants {
        let name = format!("{set}={variant}");
        if known.len() < LISTED && !known.contains(&name) {
            known.push(name);
        }
    }
    let asked = layers.reading.options.variant.as_deref();
    let asked = asked.and_then(|asked| match asked.split_once('=') {
        Some((of, variant)) => (of == &**set).then_some(variant),
        None => Some(asked),
    });
    let asked = asked.and_then(|asked| variants.iter().find(|name| &****name == asked).copied());
    asked.or(selected).filter(|name| !name.is_empty()).cloned()
}

//! Brings in what nodes are composed with.

use super::arcs::{Target, targets};
use super::layers::Layers;
use super::node::{ArcKind, Node, is_within, names_in};
use super::variants;
use crate::layers::layer::MAX_DEPTH;
use crate::layers::value::{Text, TimeOffset};
use bilux_import::FormatError;

/// References of references of references.
const MAX_CHAIN: usize = 48;
/// The number of places that are looked at for one prim, and for all: references of references can double them.
const MAX_PLACES: [usize; 2] = [5_000, 5_000_000];

/// Largest number of places that all places may have been brought through, beyond what is usual.
const MAX_DEEP: usize = 1_000_000;

/// The sites that are being brought in, to find circles.
pub(super) type Chain = Vec<(u32, String)>;

/// Brings in what a node and those below it are composed with in their own right.
pub(super) fn expand(node: &mut Node, chain: &mut Chain, layers: &mut Layers) -> Result<(), FormatError> {
    let mut children = std::mem::take(&mut node.children);
    for child in &mut children {
        chain.push((child.site.stack, child.site.path.clone()));
        expand(child, chain, layers)?;
        chain.pop();
    }
    let known = children.len();
    node.children = children;
    for i in 0..known {
        add_implied(node, i, chain, layers)?;
    }
    if !node.specs.is_empty() {
        for (arc, target) in targets(node, layers)? {
            if let Some(child) = bring_in(node, arc, &target, chain, layers)? {
                node.children.push(child);
                let last = node.children.len() - 1;
                add_implied(node, last, chain, layers)?;
            }
        }
    }
    node.sort();
    Ok(())
}

/// Brings in the chosen variant of every set, the strongest first; each can bring in more. Adds what can be chosen to `known`.
pub(super) fn choose(
    node: &mut Node,
    chain: &mut Chain,
    layers: &mut Layers,
    known: &mut Vec<String>,
) -> Result<(), FormatError> {
    while let Some((place, set)) = variants::next(node, layers) {
        let selected = variants::selected(node, &set, layers, known);
        let at = variants::at(node, &place);
        at.chosen.push(set.clone());
        let Some(variant) = selected else { continue };
        let spec = |&(layer, prim, offset): &(u32, u32, _)| {
            let sets = &layers.all[layer as usize].prims[prim as usize].variant_sets;
            let alternatives = &sets.iter().find(|known| known.name == set)?.variants;
            let (_, found) = alternatives.iter().find(|(name, _)| *name == variant)?;
            Some((layer, *found, offset))
        };
        let specs: Vec<_> = at.specs.iter().filter_map(spec).collect();
        if specs.is_empty() {
            continue;
        }
        let depth = names_in(&at.site.path);
        let mut found = Node {
            specs,
            arc: ArcKind::Variant,
            depth,
            children: Vec::new(),
            chosen: Vec::new(),
            ..at.clone()
        };
        chain.push((found.site.stack, found.site.path.clone()));
        let expanded = expand(&mut found, chain, layers);
        chain.pop();
        expanded?;
        let at = variants::at(node, &place);
        at.children.push(found);
        at.sort();
    }
    Ok(())
}

/// Counts a place.
fn count(node: &Node, layers: &mut Layers) -> Result<(), FormatError> {
    let is_within = layers.places.iter().zip(MAX_PLACES).all(|(count, most)| *count < most);
    layers.places = layers.places.map(|count| count + 1);
    if is_within {
        return Ok(());
    }
    let message = format!("{} is composed of too many places: {} at most", node.site.path, MAX_PLACES[0]);
    Err(FormatError::malformed(message, layers.all[0].at(0)))
}

/// The node of a target, with all that it is composed with; `None`, with a warning, if there is none.
fn bring_in(
    node: &Node,
    arc: ArcKind,
    target: &Target,
    chain: &mut Chain,
    layers: &mut Layers,
) -> Result<Option<Node>, FormatError> {
    count(node, layers)?;
    let (mut stack, mut scale) = (node.site.stack, 1.0);
    if let Some(file) = &target.file {
        let Some(layer) = layers.open(file, &target.at)? else { return Ok(None) };
        stack = layers.stack(layer)?;
        let rate = |stack: u32| layers.stacks[stack as usize].time_codes_per_second;
        scale = rate(node.site.stack) / rate(stack);
    }
    let mut path = target.path.clone();
    if path.is_empty() {
        let layer = layers.stacks[stack as usize].layers[0].0;
        let fields = &layers.all[layer as usize].root().fields;
        let Some(name) = fields.text("defaultPrim").filter(|name| !name.is_empty()) else {
            let what = "a reference names no prim, and its layer has no defaultPrim: left out";
            layers.diagnostics.note(what, || target.at.clone());
            return Ok(None);
        };
        path = if name.starts_with('/') { name.to_string() } else { format!("/{name}") };
    }
    let offset = node.offset.after(target.offset).after(TimeOffset { offset: 0.0, scale });
    let circular =
        |(other, site): &(u32, String)| *other == stack && (is_within(site, &path) || is_within(&path, site));
    if chain.iter().any(circular) {
        let what = format!("{} is composed with itself or with a prim above it: left out there", path);
        layers.diagnostics.note(&what, || target.at.clone());
        return Ok(None);
    }
    let Some(found) = node_at(stack, &path, chain, layers)? else {
        // Classes need not exist.
        if matches!(arc, ArcKind::Reference | ArcKind::Payload) {
            let what = format!("there is no prim {path} in the layer that is referred to: left out");
            layers.diagnostics.note(&what, || target.at.clone());
        }
        return Ok(None);
    };
    let found = found.brought_in(arc, node, offset);
    layers.deep += found.depth_beyond();
    if layers.deep > MAX_DEEP {
        let message = format!(
            "references of references multiply: {} is one of very many places that they bring in; remove some",
            node.site.path
        );
        return Err(FormatError::malformed(message, target.at.clone()));
    }
    Ok(Some(found))
}

/// Classes that a node was composed with count in the layers around it too: a prim there with the same name overrides them.
fn add_implied(
    node: &mut Node,
    index: usize,
    chain: &mut Chain,
    layers: &mut Layers,
) -> Result<(), FormatError> {
    let child = &node.children[index];
    if matches!(child.arc, ArcKind::Inherit | ArcKind::Specialize) || child.site.stack == node.site.stack {
        return Ok(());
    }
    let here = names_in(&child.site.path);
    let is_class = |n: &&Node| matches!(n.arc, ArcKind::Inherit | ArcKind::Specialize) && n.depth == here;
    let classes: Vec<(ArcKind, String)> = child
        .children
        .iter()
        .filter(is_class)
        .map(|class| {
            let path = class.site.path.clone();
            (class.arc, child.outwards(&path).unwrap_or(path))
        })
        .collect();
    for (arc, path) in classes {
        let own = names_in(&node.site.path);
        let known = |n: &Node| n.arc == arc && n.depth == own && n.site.path == path;
        if node.children.iter().any(known) {
            continue;
        }
        let at = layers.all[0].at(0);
        let target = Target { file: None, path, offset: TimeOffset::default(), at };
        if let Some(implied) = bring_in(node, arc, &target, chain, layers)? {
            node.children.push(implied);
        }
    }
    Ok(())
}

/// The prim at a path of a stack of layers, with all that it is composed with except for its own variants, which whoever refers to it
/// chooses.
fn node_at(
    stack: u32,
    path: &str,
    chain: &mut Chain,
    layers: &mut Layers,
) -> Result<Option<Node>, FormatError> {
    let names: Vec<Text> = path.split('/').skip(1).map(Text::from).collect();
    if chain.len() >= MAX_CHAIN || names.len() > MAX_DEPTH {
        let what = format!("references are nested more than {MAX_CHAIN} levels deep: the rest is left out");
        let at = layers.all[0].at(0);
        layers.diagnostics.note(&what, || at);
        return Ok(None);
    }
    let mut node = Node::root(stack, layers);
    chain.push((stack, path.to_owned()));
    for (i, name) in names.iter().enumerate() {
        let Some(mut child) = node.child(name, layers) else {
            chain.pop();
            return Ok(None);
        };
        expand(&mut child, chain, layers)?;
        if i + 1 < names.len() {
            choose(&mut child, chain, layers, &mut Vec::new())?;
        }
        node = child;
    }
    chain.pop();
    Ok(Some(node))
}

//! Composition arcs of a prim, as it states them.

use super::layers::Layers;
use super::node::{ArcKind, Node, absolute};
use crate::layers::value::{Reference, TimeOffset, Value};
use bilux_import::FormatError;
use bilux_scene::Span;
use std::path::PathBuf;

/// Something that a prim is composed with.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Target {
    /// The file; `None` for the same layers.
    pub(super) file: Option<PathBuf>,
    /// The prim; empty for the default one.
    pub(super) path: String,
    /// Map of its time codes to those of the layers of the node.
    pub(super) offset: TimeOffset,
    /// Place where it is named.
    pub(super) at: Span,
}

/// The fields that name what a prim is composed with.
const FIELDS: [(&str, ArcKind); 4] = [
    ("inherits", ArcKind::Inherit),
    ("references", ArcKind::Reference),
    ("payload", ArcKind::Payload),
    ("specializes", ArcKind::Specialize),
];

/// Arcs and targets that a node is composed with, the strongest of each kind first.
pub(super) fn targets(node: &Node, layers: &mut Layers) -> Result<Vec<(ArcKind, Target)>, FormatError> {
    let mut all = Vec::new();
    for (field, arc) in FIELDS {
        let mut list: Vec<Target> = Vec::new();
        for &(layer, prim, offset) in node.specs.iter().rev() {
            let spec = &layers.all[layer as usize].prims[prim as usize];
            let Some(value) = spec.fields.find(field).cloned() else { continue };
            let at = layers.all[layer as usize].at(prim);
            // The offset of the layer in its stack.
            let own = TimeOffset {
                offset: node.offset.inverse(offset.offset),
                scale: offset.scale / node.offset.scale,
            };
            let mut failed = Ok(());
            match value {
                Value::References(list_op) => list_op
                    .map(|reference| {
                        let target = target(layer, reference, own, &at, &node.site.path, layers);
                        target.unwrap_or_else(|error| {
                            failed = Err(error);
                            None
                        })
                    })
                    .apply(&mut list),
                Value::Paths(paths) => paths
                    .map(|path| {
                        let path = absolute(path, &node.site.path);
                        Some(Target { file: None, path, offset: TimeOffset::default(), at: at.clone() })
                    })
                    .apply(&mut list),
                _ => {}
            }
            failed?;
        }
        all.extend(list.into_iter().map(|target| (arc, target)));
    }
    Ok(all)
}

fn target(
    layer: u32,
    reference: &Reference,
    own: TimeOffset,
    at: &Span,
    prim: &str,
    layers: &mut Layers,
) -> Result<Option<Target>, FormatError> {
    let file = match &*reference.asset {
        "" => None,
        asset => {
            let Some(file) = layers.locate(layer, asset, at)? else { return Ok(None) };
            Some(file)
        }
    };
    let path = if reference.path.is_empty() { String::new() } else { absolute(&reference.path, prim) };
    Ok(Some(Target { file, path, offset: own.after(reference.offset), at: at.clone() }))
}

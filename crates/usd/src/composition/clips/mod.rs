//! Value clips: layers whose samples take turns, as metadata of a prim says. [OpenUSD, UsdClipsAPI]

mod stated;
mod turns;

pub(crate) use turns::Clipped;

use super::layers::Layers;
use super::node::{Node, Opinion};
use crate::layers::value::{Text, Value};
use bilux_import::FormatError;
use stated::{Reader, Stated, stronger};
use std::collections::BTreeMap;

/// The clips of a prim: its own before those of the prims above it.
pub(super) fn of(
    node: &Node,
    opinions: &[Opinion],
    above: &[Clipped],
    layers: &mut Layers,
) -> Result<Vec<Clipped>, FormatError> {
    let mut all = own(node, opinions, layers)?;
    let name = node.site.path.rsplit('/').next().unwrap_or_default();
    for clipped in above {
        let anchor = (clipped.anchor.0, format!("{}/{name}", clipped.anchor.1));
        let stronger = stronger(node, &anchor).unwrap_or(opinions.len());
        let path = format!("{}/{name}", clipped.path).into();
        all.push(Clipped { set: clipped.set.clone(), stronger, path, anchor });
    }
    all.sort_by_key(|clipped| clipped.stronger);
    Ok(all)
}
fn own(node: &Node, opinions: &[Opinion], layers: &mut Layers) -> Result<Vec<Clipped>, FormatError> {
    let field = |opinion: &Opinion, key: &str, layers: &Layers| {
        layers.all[opinion.layer as usize].prims[opinion.prim as usize].fields.find(key).cloned()
    };
    if opinions.iter().any(|o| field(o, "clipAssetPaths", layers).is_some()) {
        let at = layers.all[0].at(0);
        layers.diagnostics.not_shown("value clips in the form without sets", || at);
    }
    let mut sets: BTreeMap<Text, Stated> = BTreeMap::new();
    for opinion in opinions {
        let stated = field(opinion, "clips", layers).map(|value| layers.unpacked(opinion.layer, value));
        let Some(Value::Dictionary(stated)) = stated.transpose()? else { continue };
        for (name, value) in stated {
            if let Value::Dictionary(entries) = layers.unpacked(opinion.layer, value)? {
                sets.entry(name).or_default().push((opinion, entries));
            }
        }
    }
    let mut all = Vec::new();
    for stated in sets.values() {
        match (Reader { stated, layers: &mut *layers }).read(node)? {
            Some(clipped) => all.push(clipped),
            None => {
                let opinion = stated[0].0;
                let at = layers.all[opinion.layer as usize].at(opinion.prim);
                let what = "value clips need assetPaths with active, or a template with start, end and stride, and a primPath: \
                            they are left out";
                layers.diagnostics.note(what, || at);
            }
        }
    }
    Ok(all)
}

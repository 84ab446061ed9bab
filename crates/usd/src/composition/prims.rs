//! The prims of a stage.

use super::clips::{self, Clipped};
use super::expand::{choose, expand};
use super::layers::Layers;
use super::node::{Node, Opinion};
use crate::layers::layer::{MAX_DEPTH, Specifier};
use crate::layers::value::Text;
use bilux_import::FormatError;
use std::collections::HashSet;

/// A composed prim.
#[derive(Debug)]
pub(crate) struct Prim {
    pub(crate) path: Text,
    pub(crate) type_name: Text,
    /// Opinions of all layers, the strongest first.
    pub(crate) opinions: Vec<Opinion>,
    /// Indices of prims.
    pub(crate) children: Vec<u32>,
    /// Values that are weaker than some of them, the strongest first.
    pub(crate) clips: Vec<Clipped>,
    /// False for classes and for what is only overridden, whatever the prims above it are.
    pub(crate) is_defined: bool,
}

/// Bytes of an opinion's place with what it has been brought through, without its path.
const SITE: usize = 160;

/// More prims than anybody draws one by one.
const MAX_PRIMS: usize = 4_000_000;

/// Composes all prims; the first is the root. Also returns the variants that can be chosen.
pub(crate) fn compose(layers: &mut Layers) -> Result<(Vec<Prim>, Vec<String>), FormatError> {
    let root = Node::root(0, layers);
    let mut composer = Composer { prims: Vec::new(), variants: Vec::new() };
    composer.prims.push(Prim {
        path: Text::from(""),
        type_name: Text::default(),
        opinions: root.opinions(),
        clips: Vec::new(),
        children: Vec::new(),
        is_defined: true,
    });
    composer.children(0, &root, 0, layers)?;
    Ok((composer.prims, composer.variants))
}

struct Composer {
    prims: Vec<Prim>,
    variants: Vec<String>,
}

impl Composer {
    fn children(
        &mut self,
        parent: u32,
        node: &Node,
        depth: usize,
        layers: &mut Layers,
    ) -> Result<(), FormatError> {
        if depth >= MAX_DEPTH {
            let at = layers.all[0].at(0);
            layers.diagnostics.note("prims are nested too deeply: those further down are left out", || at);
            return Ok(());
        }
        for name in names(node, layers) {
            let Some(mut child) = node.child(&name, layers) else { continue };
            layers.places[0] = 0;
            let mut chain = vec![(child.site.stack, child.site.path.clone())];
            expand(&mut child, &mut chain, layers)?;
            choose(&mut child, &mut chain, layers, &mut self.variants)?;
            let opinions = child.opinions();
            let index = self.prims.len() as u32;
            let site = SITE + child.site.path.len();
            let bytes = size_of::<Prim>() + opinions.len() * (size_of::<Opinion>() + site) + site;
            layers.reading.budget.take_bytes(bytes as u64, &layers.all[0].name)?;
            if self.prims.len() >= MAX_PRIMS {
                let message = format!("there are more than {MAX_PRIMS} prims once everything is composed");
                return Err(FormatError::malformed(message, layers.all[0].at(0)));
            }
            let field = |key: &str| {
                let spec = |o: &Opinion| &layers.all[o.layer as usize].prims[o.prim as usize];
                opinions.iter().find_map(|o| spec(o).fields.number(key)).map(|value| value != 0.0)
            };
            if field("active") == Some(false) {
                continue;
            }
            if field("instanceable") == Some(true) && child.children.iter().any(|arc| !arc.specs.is_empty()) {
                child.as_instance();
            }
            let clips = clips::of(&child, &opinions, &self.prims[parent as usize].clips, layers)?;
            layers.reading.budget.take::<[Clipped; 2]>(clips.len(), &layers.all[0].name)?;
            let is_defined = is_defined(&opinions, layers);
            let type_name = type_name(&opinions, layers);
            let path = child.site.path.as_str().into();
            self.prims.push(Prim { path, type_name, opinions, clips, children: Vec::new(), is_defined });
            self.prims[parent as usize].children.push(index);
            self.children(index, &child, depth + 1, layers)?;
        }
        Ok(())
    }
}

/// The names of all children.
fn names(node: &Node, layers: &Layers) -> Vec<Text> {
    let (mut known, mut names) = (HashSet::new(), Vec::new());
    node.visit(&mut |node: &Node| {
        for (layer, prim, _) in &node.specs {
            let layer = &layers.all[*layer as usize];
            for child in &layer.prims[*prim as usize].children {
                let name = &layer.prims[*child as usize].name;
                if known.insert(name.clone()) {
                    names.push(name.clone());
                }
            }
        }
    });
    names
}

/// True if a prim is defined by what it says about itself, whatever others are.
fn is_defined(opinions: &[Opinion], layers: &Layers) -> bool {
    let specifiers =
        || opinions.iter().map(|o| layers.all[o.layer as usize].prims[o.prim as usize].specifier);
    let first = specifiers().find(|specifier| *specifier != Specifier::Over);
    match first {
        Some(Specifier::Def) => true,
        // A class that was inherited does not make a class of what inherits it.
        Some(_) => {
            opinions[0].site.path != opinions.last().map_or("", |o| &o.site.path)
                && specifiers().any(|specifier| specifier == Specifier::Def)
        }
        None => false,
    }
}

fn type_name(opinions: &[Opinion], layers: &Layers) -> Text {
    let names = opinions.iter().map(|o| &layers.all[o.layer as usize].prims[o.prim as usize].type_name);
    names.into_iter().find(|name| !name.is_empty()).cloned().unwrap_or_default()
}

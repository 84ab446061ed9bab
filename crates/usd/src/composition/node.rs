//! Opinions of several places about one prim, as a tree: a node is a prim in a stack of layers, and the nodes below it are what it
//! is composed with.

use super::layers::Layers;
use crate::layers::value::{Text, TimeOffset};
use std::sync::Arc;

/// Kind of arc that brought a node in, the strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ArcKind {
    Root,
    Inherit,
    Variant,
    Reference,
    Payload,
    Specialize,
}

/// Mapping of a node's paths to those of the whole stage.
#[derive(Debug)]
pub(crate) struct Mapping {
    from: String,
    to: String,
    /// Paths elsewhere are the same there, since both nodes are in the same layers.
    keeps_others: bool,
    outer: Option<Arc<Mapping>>,
}

/// A prim's place in its own layers.
#[derive(Debug)]
pub(crate) struct Site {
    pub(super) stack: u32,
    pub(super) path: String,
    mapping: Option<Arc<Mapping>>,
}

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) site: Arc<Site>,
    /// Layer and prim there, the strongest first, and what its time codes are on the stage.
    pub(super) specs: Vec<(u32, u32, TimeOffset)>,
    /// Map of the time codes of its layers to those of the stage.
    pub(super) offset: TimeOffset,
    pub(super) arc: ArcKind,
    /// The number of names in the path of the node above when it was brought in: what comes with a prim itself is stronger
    /// than what comes with a prim above it.
    pub(super) depth: usize,
    pub(super) children: Vec<Node>,
    /// Sets of variants that were chosen from.
    pub(super) chosen: Vec<Text>,
}

/// Opinion of a layer about a prim of the stage.
#[derive(Clone, Debug)]
pub(crate) struct Opinion {
    pub(crate) layer: u32,
    pub(crate) prim: u32,
    pub(crate) offset: TimeOffset,
    pub(super) site: Arc<Site>,
}

/// True if a path is another one or below it.
pub(super) fn is_within(path: &str, other: &str) -> bool {
    other.is_empty()
        || path.strip_prefix(other).is_some_and(|rest| rest.is_empty() || rest.starts_with(['/', '.']))
}

/// The number of names in a path.
pub(super) fn names_in(path: &str) -> usize {
    path.bytes().filter(|byte| *byte == b'/').count()
}

impl Mapping {
    /// A path one node further out.
    pub(super) fn once(&self, path: &str) -> Option<String> {
        if is_within(path, &self.from) {
            return Some(format!("{}{}", self.to, &path[self.from.len()..]));
        }
        self.keeps_others.then(|| path.to_owned())
    }

    /// A path on the stage.
    fn whole(&self, path: &str) -> Option<String> {
        let mapped = self.once(path)?;
        self.outer.as_ref().map_or(Some(mapped.clone()), |outer| outer.whole(&mapped))
    }
}

/// An absolute path, from one that may be relative to a prim.
pub(super) fn absolute(path: &str, prim: &str) -> String {
    if path.starts_with('/') {
        return path.to_owned();
    }
    let mut at = prim;
    let mut rest = path;
    while let Some(after) = rest.strip_prefix("..") {
        at = at.rsplit_once('/').map_or("", |(above, _)| above);
        rest = after.strip_prefix('/').unwrap_or(after);
    }
    rest = rest.strip_prefix("./").unwrap_or(rest);
    let separator = if rest.is_empty() || rest.starts_with('.') { "" } else { "/" };
    format!("{at}{separator}{rest}")
}

impl Opinion {
    /// A target that this layer names, on the stage; `None` for what is outside of what was referred to.
    pub(crate) fn on_stage(&self, path: &str) -> Option<Text> {
        let path = absolute(path, &self.site.path);
        match &self.site.mapping {
            Some(mapping) => mapping.whole(&path).map(Text::from),
            None => Some(path.into()),
        }
    }
}

impl Node {
    /// The root of a stack of layers.
    pub(super) fn root(stack: u32, layers: &Layers) -> Node {
        let all = layers.stacks[stack as usize].layers.iter();
        Node {
            site: Arc::new(Site { stack, path: String::new(), mapping: None }),
            specs: all.map(|(layer, offset)| (*layer, 0, *offset)).collect(),
            offset: TimeOffset::default(),
            arc: ArcKind::Root,
            depth: 0,
            children: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// Node of a child, with what this node and those below it say about it; `None` if nothing.
    pub(super) fn child(&self, name: &Text, layers: &Layers) -> Option<Node> {
        let of = |&(layer, prim, offset): &(u32, u32, TimeOffset)| {
            let child = layers.all[layer as usize].by_name.get(&(prim, name.clone()))?;
            Some((layer, *child, offset))
        };
        let specs: Vec<_> = self.specs.iter().filter_map(of).collect();
        let children: Vec<Node> = self.children.iter().filter_map(|node| node.child(name, layers)).collect();
        if specs.is_empty() && children.is_empty() {
            return None;
        }
        let Site { stack, path, mapping } = &*self.site;
        let site = Site { stack: *stack, path: format!("{path}/{name}"), mapping: mapping.clone() };
        Some(Node { site: Arc::new(site), specs, children, chosen: Vec::new(), ..*self })
    }

    /// Makes it part of another one, which brings it in.
    pub(super) fn brought_in(mut self, arc: ArcKind, by: &Node, offset: TimeOffset) -> Node {
        let mapping = Arc::new(Mapping {
            from: self.site.path.clone(),
            to: by.site.path.clone(),
            keeps_others: self.site.stack == by.site.stack,
            outer: by.site.mapping.clone(),
        });
        self.move_in(&mapping, offset);
        (self.arc, self.depth) = (arc, names_in(&by.site.path));
        self
    }

    fn move_in(&mut self, mapping: &Arc<Mapping>, offset: TimeOffset) {
        let Site { stack, path, mapping: own } = &*self.site;
        let whole = own.as_ref().map_or_else(|| mapping.clone(), |own| own.within(mapping));
        self.site = Arc::new(Site { stack: *stack, path: path.clone(), mapping: Some(whole) });
        self.offset = offset.after(self.offset);
        self.specs.iter_mut().for_each(|(_, _, own)| *own = offset.after(*own));
        self.children.iter_mut().for_each(|child| child.move_in(mapping, offset));
    }

    /// The number of places that its places have been brought through, beyond what stages have that people make.
    pub(super) fn depth_beyond(&self) -> usize {
        /// References of references of references.
        const USUAL: usize = 4;
        let through = std::iter::successors(self.site.mapping.as_ref(), |mapping| mapping.outer.as_ref());
        let inner = self.children.iter().map(Node::depth_beyond).sum::<usize>();
        through.count().saturating_sub(USUAL) + inner
    }

    /// The path of something in this node in the node above.
    pub(super) fn outwards(&self, path: &str) -> Option<String> {
        self.site.mapping.as_ref()?.once(path)
    }

    /// Calls `visit` with this node and all below it, the strongest first.
    pub(super) fn visit<'n>(&'n self, visit: &mut impl FnMut(&'n Node)) {
        let mut weakest = Vec::new();
        self.visit_all(visit, &mut weakest);
        // Specialized prims are weaker than everything else.
        let mut next = 0;
        while next < weakest.len() {
            let node: &Node = weakest[next];
            node.visit_all(visit, &mut weakest);
            next += 1;
        }
    }

    fn visit_all<'n>(&'n self, visit: &mut impl FnMut(&'n Node), weakest: &mut Vec<&'n Node>) {
        visit(self);
        for child in &self.children {
            match child.arc {
                ArcKind::Specialize => weakest.push(child),
                _ => child.visit_all(visit, weakest),
            }
        }
    }

    /// Sorts what was brought in, the strongest first.
    pub(super) fn sort(&mut self) {
        self.children.sort_by_key(|child| (child.arc, usize::MAX - child.depth));
    }

    /// Opinions of all layers, the strongest first.
    pub(super) fn opinions(&self) -> Vec<Opinion> {
        let mut all = Vec::new();
        self.visit(&mut |node: &Node| {
            let of = |&(layer, prim, offset): &(u32, u32, TimeOffset)| Opinion {
                layer,
                prim,
                offset,
                site: node.site.clone(),
            };
            all.extend(node.specs.iter().map(of));
        });
        all
    }

    /// Forgets what is said of the prims of an instance where it is placed: only what it is an instance of counts.
    pub(super) fn as_instance(&mut self) {
        self.specs.clear();
        let here = names_in(&self.site.path);
        self.children.iter_mut().filter(|child| child.depth < here).for_each(Node::as_instance);
    }
}

impl Mapping {
    /// Mapping like this one, below another one.
    fn within(self: &Arc<Mapping>, outermost: &Arc<Mapping>) -> Arc<Mapping> {
        let outer = self.outer.as_ref().map_or_else(|| outermost.clone(), |outer| outer.within(outermost));
        Arc::new(Mapping {
            from: self.from.clone(),
            to: self.to.clone(),
            keeps_others: self.keeps_others,
            outer: Some(outer),
        })
    }
}

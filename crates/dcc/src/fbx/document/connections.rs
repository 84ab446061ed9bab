//! Which object belongs to which.

use super::keys::{Index, Key};
use crate::fbx::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::collections::HashMap;

/// A connection from an object to another one, or to a property of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::fbx) struct Link<'d> {
    pub(in crate::fbx) source: Index,
    pub(in crate::fbx) target: Index,
    /// The property of the target; `None` for the object as a whole.
    pub(in crate::fbx) property: Option<&'d [u8]>,
}

/// All connections.
pub(super) struct Connections<'d> {
    /// By target, each in the order of the file.
    links: Vec<Link<'d>>,
    /// For each object the first of its links, and the end of the last one's.
    first: Vec<u32>,
    /// The links by source.
    by_source: Vec<u32>,
}

impl<'d> Connections<'d> {
    pub(super) fn read(
        root: Node<'d>,
        keys: &HashMap<Key<'d>, Index>,
        objects: usize,
        budget: &mut Budget,
    ) -> Result<Connections<'d>, FormatError> {
        let mut links = Vec::new();
        let lists = root.children_named("Connections").flat_map(|list| list.children());
        for node in lists.filter(|node| matches!(node.name(), b"C" | b"Connect")) {
            budget.take::<(Link, u32)>(1, node.file())?;
            let mut values = node.values();
            let kind = values.next().and_then(Value::text).unwrap_or_default();
            let mut object = || keys.get(&Key::of(values.next()?)?).copied();
            // An object that is not in the file is one of the program, such as its standard cameras.
            let (Some(source), Some(target)) = (object(), object()) else { continue };
            match kind {
                b"OO" => links.push(Link { source, target, property: None }),
                b"OP" => {
                    let property = values.next().and_then(Value::text);
                    links.push(Link { source, target, property });
                }
                // From a property: constraints and expressions.
                _ => {}
            }
        }
        budget.take::<u32>(objects, root.file())?;
        links.sort_by_key(|link: &Link| link.target);
        let mut first = Vec::with_capacity(objects + 1);
        for object in 0..=objects as Index {
            first.push(links.partition_point(|link| link.target < object) as u32);
        }
        let mut by_source: Vec<u32> = (0..links.len() as u32).collect();
        by_source.sort_by_key(|&link| links[link as usize].source);
        Ok(Connections { links, first, by_source })
    }

    pub(super) fn sources(&self, target: Index) -> &[Link<'d>] {
        let [start, end] = [target, target + 1].map(|object| self.first[object as usize] as usize);
        &self.links[start..end]
    }

    pub(super) fn targets(&self, source: Index) -> impl Iterator<Item = &Link<'d>> {
        let links = |link: &u32| &self.links[*link as usize];
        let start = self.by_source.partition_point(|link| links(link).source < source);
        self.by_source[start..].iter().map(links).take_while(move |link| link.source == source)
    }
}

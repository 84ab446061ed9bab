//! The objects of a file and their connections, the same for all versions.

mod connections;
mod keys;
mod names;
mod properties;
mod settings;

pub(super) use connections::Link;
pub(super) use keys::{Index, ROOT};
pub(super) use names::display_name;
pub(super) use properties::{Animated, Properties};
pub(super) use settings::Settings;

use super::tree::{Node, Tree, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Source;
use connections::Connections;
use keys::Key;
use properties::Template;
use std::collections::HashMap;
use std::path::Path;

/// An object of the file.
#[derive(Clone, Copy)]
pub(super) struct Object<'d> {
    pub(super) node: Node<'d>,
    /// Name of the object, in the file's bytes, without its class.
    pub(super) name: &'d [u8],
    /// Kind within the object's class, such as `Mesh`; may be empty.
    pub(super) kind: &'d [u8],
}

/// A file with what connects its objects.
pub(super) struct Document<'d> {
    pub(super) tree: &'d Tree<'d>,
    objects: Vec<Object<'d>>,
    connections: Connections<'d>,
    templates: HashMap<&'d [u8], Vec<Template<'d>>>,
    keys: HashMap<Key<'d>, Index>,
    pub(super) settings: Settings,
    /// The folder of the file.
    pub(super) folder: Option<&'d Path>,
    /// Name of the file without folder and extension.
    pub(super) stem: String,
}

/// The bytes of an object with its entry in the table of keys.
type Entry<'d> = (Object<'d>, [usize; 6]);

impl<'d> Document<'d> {
    pub(super) fn load(
        tree: &'d Tree<'d>,
        source: &Source<'d>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Document<'d>, FormatError> {
        let root = tree.root();
        check(tree)?;
        let mut objects = vec![Object { node: root, name: b"", kind: b"" }];
        let mut keys: HashMap<Key<'d>, Index> = HashMap::new();
        keys.insert(Key::Number(0), ROOT);
        for name in [&b"Model::Scene"[..], b"Scene\0\x01Model"] {
            keys.insert(Key::Name(name), ROOT);
        }
        for node in root.children_named("Objects").flat_map(|list| list.children()) {
            let mut values = node.values();
            let Some(key) = values.next().and_then(Key::of) else { continue };
            budget.take::<Entry>(1, node.file())?;
            let mut texts = values.filter_map(Value::text);
            let name = match key {
                Key::Number(_) => texts.next().unwrap_or_default(),
                Key::Name(name) => name,
            };
            let object =
                Object { node, name: names::without_class(name), kind: texts.next().unwrap_or_default() };
            if keys.contains_key(&key) {
                diagnostics.note("two objects have the same number or name: the first is used", || node.at());
                continue;
            }
            keys.insert(key, objects.len() as Index);
            objects.push(object);
        }
        let connections = Connections::read(root, &keys, objects.len(), budget)?;
        let templates = properties::templates(root, budget)?;
        let settings = Settings::read(root);
        let (folder, stem) = (source.folder, source.stem());
        Ok(Document { tree, objects, connections, templates, keys, settings, folder, stem })
    }

    /// The name of the file.
    pub(super) fn file(&self) -> &'d str {
        self.tree.root().file()
    }

    pub(super) fn object(&self, index: Index) -> &Object<'d> {
        &self.objects[index as usize]
    }

    /// The object that connections call so.
    pub(super) fn named(&self, name: Value<'d>) -> Option<Index> {
        self.keys.get(&Key::of(name)?).copied()
    }

    /// The name of the animation that was shown when the file was written.
    pub(super) fn active_animation(&self) -> Option<String> {
        let root = self.tree.root();
        let mut documents = root.children_named("Documents").flat_map(|list| list.children());
        let stated = documents.find_map(|node| Properties::read(node, None).text("ActiveAnimStackName"));
        let old = || root.child("Takes")?.child_value("Current")?.text();
        stated.or_else(old).map(display_name)
    }

    /// The indices of all objects but the scene.
    pub(super) fn indices(&self) -> impl Iterator<Item = Index> + use<> {
        1..self.objects.len() as Index
    }

    /// Class of an object, such as `Model`.
    pub(super) fn class(&self, index: Index) -> &'d [u8] {
        if index == ROOT { b"" } else { self.object(index).node.name() }
    }

    /// Links of the objects that are connected to an object, in the order of the file.
    pub(super) fn sources(&self, target: Index) -> &[Link<'d>] {
        self.connections.sources(target)
    }

    /// Links to the objects to which an object is connected.
    pub(super) fn targets(&self, source: Index) -> impl Iterator<Item = &Link<'d>> {
        self.connections.targets(source)
    }

    /// The objects of a class that are connected to an object as a whole.
    pub(super) fn sources_of_class(&self, target: Index, class: &'static str) -> impl Iterator<Item = Index> {
        let links = self.sources(target).iter().filter(|link| link.property.is_none());
        links.map(|link| link.source).filter(move |&source| self.class(source) == class.as_bytes())
    }

    /// The properties of an object, or else those of the template for its class.
    pub(super) fn properties(&self, index: Index) -> Properties<'d, '_> {
        let object = self.object(index);
        let templates = self.templates.get(self.class(index)).map_or(&[][..], |list| list);
        Properties::read(object.node, properties::template_for(object.kind, templates))
    }
}

/// The versions that are read.
const VERSIONS: std::ops::Range<u32> = 6000..8000;

/// Refuses files that are encrypted, older or newer.
fn check(tree: &Tree) -> Result<(), FormatError> {
    let refused = |message: String| Err(FormatError::malformed(message, tree.whole()));
    let header = tree.root().child("FBXHeaderExtension");
    let encryption = header.and_then(|header| header.child_value("EncryptionType"));
    if encryption.and_then(Value::integer).is_some_and(|kind| kind != 0) {
        return refused("this FBX file is encrypted: export it without a password".to_owned());
    }
    let version = tree.version;
    if VERSIONS.contains(&version) {
        return Ok(());
    }
    let (major, minor) = (version / 1000, version % 1000 / 100);
    refused(match version < VERSIONS.start {
        true => format!(
            "this is FBX {major}.{minor}, but 6.1 (of 2006) is the oldest that is read: convert it to FBX 2013 or later"
        ),
        false => {
            format!("this is FBX {major}.{minor}, but 7.7 is the newest that is known: export it as FBX 2020")
        }
    })
}

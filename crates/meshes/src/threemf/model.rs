//! Contents of a package's parts, as plain data.

use super::groups::{Display, Group, Picture};
use super::mesh_data::MeshData;
use bilux_math::DMat4;
use bilux_scene::Span;
use std::collections::{HashMap, HashSet};

/// All parts together. Parts have numbers; the first is the one that is printed.
#[derive(Default)]
pub(super) struct Model {
    /// Metres per unit.
    pub(super) unit: f64,
    /// The program that wrote it.
    pub(super) application: String,
    pub(super) items: Vec<Item>,
    pub(super) objects: Vec<Object>,
    pub(super) groups: Vec<Group>,
    pub(super) pictures: Vec<Picture>,
    pub(super) displays: Vec<Display>,
    /// Resources by the numbers of each part.
    pub(super) resources: HashMap<(usize, u32), Resource>,
    /// The members that parts lie in.
    pub(super) parts: Vec<String>,
    /// The names of metadata so far.
    pub(super) metadata: HashSet<String>,
}

/// Resource that has a number in a part, as an index into the lists of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resource {
    Object(usize),
    Group(usize),
    Picture(usize),
    Display(usize),
    /// A resource that is not shown.
    Other,
}

/// A number of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Reference {
    pub(super) part: usize,
    pub(super) id: u32,
}

/// An object to be printed, at a place.
pub(super) struct Item {
    pub(super) object: Reference,
    pub(super) transform: DMat4,
    pub(super) is_printed: bool,
    pub(super) at: Span,
}

/// An object.
pub(super) struct Object {
    pub(super) name: String,
    pub(super) role: Role,
    /// The property of triangles that have none of their own.
    pub(super) property: Option<Property>,
    pub(super) content: Content,
    pub(super) at: Span,
}

/// Content of an object.
pub(super) enum Content {
    Mesh(Box<MeshData>),
    Components(Vec<Component>),
}

/// An object within another.
pub(super) struct Component {
    pub(super) object: Reference,
    pub(super) transform: DMat4,
    pub(super) at: Span,
}

/// An entry of a group of properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) group: usize,
    pub(super) index: u32,
}

/// Purpose of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Printed,
    Support,
    /// A volume that changes how others are printed.
    Modifier,
    Other,
}

impl Model {
    /// Resource that has a number in a part.
    pub(super) fn find(&self, reference: Reference) -> Option<Resource> {
        self.resources.get(&(reference.part, reference.id)).copied()
    }
}

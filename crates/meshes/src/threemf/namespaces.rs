//! The namespaces of 3MF and its extensions.

use super::attributes::Attributes;

/// A namespace, as far as it means something here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Namespace {
    Core,
    Materials,
    Production,
    Slices,
    Lattice,
    Balls,
    TriangleSets,
    /// `xml:`, which needs no declaration.
    Xml,
    /// One that is known by name only: what it describes is not shown.
    Named(&'static str),
    Unknown,
    /// A prefix that is not declared.
    Undeclared,
}

/// The core before the specification was published, as the first programs wrote it.
pub(super) const DRAFT: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01";

/// The namespaces by their addresses.
const KNOWN: &[(&str, Namespace)] = &[
    ("http://schemas.microsoft.com/3dmanufacturing/core/2015/02", Namespace::Core),
    (DRAFT, Namespace::Core),
    ("http://schemas.microsoft.com/3dmanufacturing/material/2015/02", Namespace::Materials),
    ("http://schemas.microsoft.com/3dmanufacturing/production/2015/06", Namespace::Production),
    ("http://schemas.microsoft.com/3dmanufacturing/slice/2015/07", Namespace::Slices),
    ("http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02", Namespace::Lattice),
    ("http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07", Namespace::Balls),
    ("http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07", Namespace::TriangleSets),
    (
        "http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/04",
        Namespace::Named("encrypted content"),
    ),
    (
        "http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/07",
        Namespace::Named("encrypted content"),
    ),
    (
        "http://schemas.3mf.io/3dmanufacturing/productionalternatives/2021/04",
        Namespace::Named("alternative representations"),
    ),
    (
        "http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07",
        Namespace::Named("boolean operations"),
    ),
    ("http://schemas.3mf.io/3dmanufacturing/displacement/2023/10", Namespace::Named("displacement")),
    ("http://schemas.microsoft.com/3dmanufacturing/displacement/2022/07", Namespace::Named("displacement")),
    ("http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", Namespace::Named("volumetric data")),
    ("http://schemas.microsoft.com/3dmanufacturing/volumetric/2022/01", Namespace::Named("volumetric data")),
    ("http://schemas.3mf.io/3dmanufacturing/implicit/2023/12", Namespace::Named("implicit functions")),
    ("http://schemas.microsoft.com/3dmanufacturing/implicit/2023/12", Namespace::Named("implicit functions")),
];

impl Namespace {
    fn at(address: &str) -> Namespace {
        KNOWN.iter().find(|(known, _)| *known == address).map_or(Namespace::Unknown, |(_, space)| *space)
    }

    /// True if files may require it: what it describes is shown, or changes nothing in the picture.
    pub(super) fn is_supported(self) -> bool {
        !matches!(self, Namespace::Named(_) | Namespace::Unknown | Namespace::Undeclared)
    }
}

/// The prefixes that are declared, each at the depth of an element.
#[derive(Debug, Default)]
pub(super) struct Scopes {
    declared: Vec<(usize, String, Namespace)>,
}

/// More declarations than this are not kept.
const MAX_DECLARED: usize = 256;

impl Scopes {
    /// Takes the declarations of an element at a depth.
    pub(super) fn open(&mut self, depth: usize, attributes: Attributes) {
        for (key, address) in attributes.flatten().take(MAX_DECLARED) {
            let prefix = if key == "xmlns" { Some("") } else { key.strip_prefix("xmlns:") };
            if let Some(prefix) = prefix.filter(|_| self.declared.len() < MAX_DECLARED) {
                self.declared.push((depth, prefix.to_owned(), Namespace::at(address)));
            }
        }
    }

    /// Forgets the declarations of elements at this depth and below.
    #[inline]
    pub(super) fn close(&mut self, depth: usize) {
        while self.declared.last().is_some_and(|(declared, ..)| *declared >= depth) {
            self.declared.pop();
        }
    }

    /// The namespace of an element with a prefix, which may be empty.
    pub(super) fn of_element(&self, prefix: &str) -> Namespace {
        match self.declared.iter().rev().find(|(_, known, _)| known == prefix) {
            Some((.., namespace)) => *namespace,
            None if prefix.is_empty() => Namespace::Unknown,
            None if prefix == "xml" => Namespace::Xml,
            None => Namespace::Undeclared,
        }
    }

    /// The namespace of an attribute with a prefix.
    pub(super) fn of_prefix(&self, prefix: &str) -> Namespace {
        self.of_element(prefix)
    }
}

//! A layer: the prims, properties and metadata of one file.

use crate::layers::list_op::ListOp;
use crate::layers::value::{Text, Unpack, Value};
use bilux_scene::Span;
use std::collections::HashMap;
use std::path::PathBuf;

/// Deeper nesting is refused, since each level uses some of the stack.
pub(crate) const MAX_DEPTH: usize = 128;

/// Metadata by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Fields(pub(crate) Vec<(Text, Value)>);

impl Fields {
    pub(crate) fn find(&self, key: &str) -> Option<&Value> {
        self.0.iter().find(|(name, _)| &**name == key).map(|(_, value)| value)
    }

    pub(crate) fn text(&self, key: &str) -> Option<&Text> {
        self.find(key)?.text()
    }

    pub(crate) fn number(&self, key: &str) -> Option<f64> {
        self.find(key)?.number()
    }
}

/// Specifier with which a prim is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Specifier {
    Def,
    #[default]
    Over,
    Class,
}

/// Spec of a prim: what a layer says about it.
#[derive(Clone, Debug, Default)]
pub(crate) struct PrimSpec {
    pub(crate) name: Text,
    pub(crate) specifier: Specifier,
    /// Empty if this layer does not say.
    pub(crate) type_name: Text,
    pub(crate) fields: Fields,
    pub(crate) properties: Vec<Property>,
    /// Indices into [`Layer::prims`].
    pub(crate) children: Vec<u32>,
    pub(crate) variant_sets: Vec<VariantSet>,
    /// Line and column, from 1; 0 in crate files.
    pub(crate) at: (u32, u32),
}

/// Alternatives for a prim.
#[derive(Clone, Debug)]
pub(crate) struct VariantSet {
    pub(crate) name: Text,
    /// Name of each variant, and what it says, as an index into [`Layer::prims`].
    pub(crate) variants: Vec<(Text, u32)>,
}

/// Spec of an attribute or a relationship: what a layer says about it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Property {
    pub(crate) name: Text,
    pub(crate) value: Option<Value>,
    /// [`Value::Samples`], or a packed one.
    pub(crate) samples: Option<Value>,
    /// The targets of a relationship, or the connections of an attribute.
    pub(crate) targets: Option<ListOp<Text>>,
    pub(crate) fields: Fields,
}

/// A file.
#[derive(Default)]
pub(crate) struct Layer<'a> {
    /// For messages.
    pub(crate) name: Text,
    /// Folder where relative names begin; `None` if the bytes came from no file.
    pub(crate) folder: Option<PathBuf>,
    /// The first is the layer itself, whose fields are its metadata.
    pub(crate) prims: Vec<PrimSpec>,
    /// By parent and name.
    pub(crate) by_name: HashMap<(u32, Text), u32>,
    /// Source of packed values.
    pub(crate) packed: Option<Box<dyn Unpack + 'a>>,
}

impl Layer<'_> {
    pub(crate) fn root(&self) -> &PrimSpec {
        &self.prims[0]
    }

    /// Adds a prim; if its parent has one of this name, that one.
    pub(crate) fn child(&mut self, parent: u32, name: Text) -> u32 {
        let next = self.prims.len() as u32;
        let found = *self.by_name.entry((parent, name.clone())).or_insert(next);
        if found == next {
            self.prims.push(PrimSpec { name, ..PrimSpec::default() });
            self.prims[parent as usize].children.push(next);
        }
        found
    }

    /// Adds what a variant says, or finds it.
    pub(crate) fn variant(&mut self, parent: u32, set: &Text, name: &Text) -> u32 {
        let next = self.prims.len() as u32;
        let sets = &mut self.prims[parent as usize].variant_sets;
        let index = sets.iter().position(|known| known.name == *set).unwrap_or(sets.len());
        if index == sets.len() {
            sets.push(VariantSet { name: set.clone(), variants: Vec::new() });
        }
        let variants = &mut sets[index].variants;
        if let Some((_, found)) = variants.iter().find(|(known, _)| known == name) {
            return *found;
        }
        variants.push((name.clone(), next));
        self.prims.push(PrimSpec { name: name.clone(), ..PrimSpec::default() });
        next
    }

    /// The prim with an absolute path.
    pub(crate) fn named(&self, path: &str) -> Option<u32> {
        let mut names = path.strip_prefix('/')?.split('/').filter(|name| !name.is_empty());
        names.try_fold(0, |prim, name| self.by_name.get(&(prim, name.into())).copied())
    }

    /// Property of the prim with a path, as this layer states it.
    pub(crate) fn property(&self, path: &str, name: &str) -> Option<&Property> {
        let prim = &self.prims[self.named(path)? as usize];
        prim.properties.iter().find(|property| &*property.name == name)
    }

    /// Place of a prim in the file.
    pub(crate) fn at(&self, prim: u32) -> Span {
        let (line, column) = self.prims[prim as usize].at;
        Span { file: self.name.clone(), line, column }
    }

    /// A finite number of the layer's metadata.
    pub(crate) fn root_number(&self, key: &str) -> Option<f64> {
        self.root().fields.number(key).filter(|x| x.is_finite())
    }

    /// The time codes in a second.
    pub(crate) fn time_codes_per_second(&self) -> f64 {
        let fields = &self.root().fields;
        let stated = fields.number("timeCodesPerSecond").or_else(|| fields.number("framesPerSecond"));
        stated.filter(|rate| rate.is_finite() && *rate > 0.0).unwrap_or(24.0)
    }
}

/// Approximate memory of a spec, for the budget.
pub(crate) const PRIM_BYTES: u64 = (size_of::<PrimSpec>() + 2 * size_of::<((u32, Text), u32)>()) as u64;
/// Approximate memory of a property, for the budget.
pub(crate) const PROPERTY_BYTES: u64 = 2 * size_of::<Property>() as u64;

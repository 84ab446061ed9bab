//! From specs to a layer.

use super::bytes::broken;
use super::sections::{Crate, END, Specs, open};
use crate::layers::layer::{Layer, PRIM_BYTES, PROPERTY_BYTES, PrimSpec, Property, Specifier};
use crate::layers::value::{Text, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// The numbers of the types of specs that are used.
const ATTRIBUTE: u32 = 1;
const PRIM: u32 = 6;
const PSEUDO_ROOT: u32 = 7;
const RELATIONSHIP: u32 = 8;
const VARIANT: u32 = 10;

/// Fields that repeat the order of what is there anyway.
const ORDERS: [&str; 5] =
    ["primChildren", "properties", "variantSetChildren", "variantChildren", "variantSetNames"];

/// Reads a crate file.
pub(crate) fn read<'b>(
    bytes: Cow<'b, [u8]>,
    name: &Arc<str>,
    folder: Option<PathBuf>,
    budget: &mut Budget,
) -> Result<Layer<'b>, FormatError> {
    let (file, specs) = open(bytes, name, budget)?;
    let mut builder = Builder {
        layer: Layer { name: name.clone(), folder, prims: vec![PrimSpec::default()], ..Layer::default() },
        file: &file,
        prims: vec![NONE; file.paths.0.len()],
        budget,
    };
    builder.budget.take_bytes(4 * file.paths.0.len() as u64, name)?;
    // Prims before what is in them.
    for [path, set, kind] in &specs.specs {
        if matches!(*kind, PRIM | PSEUDO_ROOT | VARIANT) {
            let prim = builder.prim(*path)?;
            builder.prim_fields(prim, *set, &specs)?;
        }
    }
    for [path, set, kind] in &specs.specs {
        if matches!(*kind, ATTRIBUTE | RELATIONSHIP) {
            builder.property(*path, *set, &specs)?;
        }
    }
    let mut layer = builder.layer;
    layer.packed = Some(Box::new(file));
    Ok(layer)
}

/// Charged for every field, since many specs can share a long list of them.
const FIELD_BYTES: u64 = 16;

/// A path without a prim so far.
const NONE: u32 = u32::MAX;

struct Builder<'a, 'b> {
    layer: Layer<'b>,
    file: &'a Crate<'b>,
    /// The prim of each path.
    prims: Vec<u32>,
    budget: &'a mut Budget,
}

impl Builder<'_, '_> {
    /// The prim of a path, with all above it.
    fn prim(&mut self, index: u32) -> Result<u32, FormatError> {
        let mut chain = Vec::new();
        let mut at = index;
        let mut prim = loop {
            let path = self.file.paths.find(at);
            let path = path.ok_or_else(|| broken(&self.file.name, "a spec has a path that is not there"))?;
            match self.prims[at as usize] {
                NONE if path.parent == at => break 0,
                NONE => chain.push((at, path)),
                known => break known,
            }
            at = path.parent;
        };
        for (at, path) in chain.into_iter().rev() {
            self.budget.take_bytes(PRIM_BYTES, &self.file.name)?;
            let name = self.file.token(path.name);
            prim = match chosen(&name) {
                Some((_, "")) => prim,
                Some((set, variant)) => self.layer.variant(prim, &Text::from(set), &Text::from(variant)),
                None => self.layer.child(prim, name),
            };
            self.prims[at as usize] = prim;
        }
        Ok(prim)
    }

    /// Visits the fields of a set.
    fn fields(
        &mut self,
        set: u32,
        specs: &Specs,
        mut take: impl FnMut(&mut Self, Text, u64) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let list = specs.sets.get(set as usize..).unwrap_or_default();
        for index in list.iter().take_while(|index| **index != END) {
            let Some((name, value)) = specs.fields.get(*index as usize) else {
                return Err(broken(&self.file.name, "a spec has a field that is not there"));
            };
            let name = self.file.token(*name);
            self.budget.take_bytes(FIELD_BYTES, &self.file.name)?;
            take(self, name, *value)?;
        }
        Ok(())
    }

    fn value(&mut self, value: u64) -> Result<Value, FormatError> {
        if Crate::is_small(value) { self.file.value(value, self.budget, 0) } else { Ok(Value::Packed(value)) }
    }

    fn prim_fields(&mut self, prim: u32, set: u32, specs: &Specs) -> Result<(), FormatError> {
        self.fields(set, specs, |builder, name, value| {
            if ORDERS.contains(&&*name) {
                return Ok(());
            }
            let value = match &*name {
                // Needed whole at once.
                "subLayers" | "subLayerOffsets" => builder.file.value(value, builder.budget, 0)?,
                _ => builder.value(value)?,
            };
            let spec = &mut builder.layer.prims[prim as usize];
            match (&*name, &value) {
                ("specifier", Value::Number(x)) => {
                    spec.specifier = match *x as u32 {
                        0 => Specifier::Def,
                        2 => Specifier::Class,
                        _ => Specifier::Over,
                    };
                }
                ("typeName", Value::Text(text)) => spec.type_name = text.clone(),
                _ => {
                    // Text has other names for these.
                    let name = match &*name {
                        "inheritPaths" => Text::from("inherits"),
                        "variantSelection" => Text::from("variants"),
                        _ => name,
                    };
                    builder.budget.take::<(Text, Value)>(1, &builder.file.name)?;
                    spec.fields.0.push((name, value));
                }
            }
            Ok(())
        })
    }

    fn property(&mut self, index: u32, set: u32, specs: &Specs) -> Result<(), FormatError> {
        let path = self.file.paths.find(index);
        let path = path.ok_or_else(|| broken(&self.file.name, "a spec has a path that is not there"))?;
        // A property of a property has no prim.
        let is_of_prim = self.file.paths.find(path.parent).is_some_and(|parent| !parent.is_property);
        if !path.is_property || !is_of_prim {
            return Ok(());
        }
        let prim = self.prim(path.parent)?;
        self.budget.take_bytes(PROPERTY_BYTES, &self.file.name)?;
        let mut property = Property { name: self.file.token(path.name), ..Property::default() };
        self.fields(set, specs, |builder, name, value| {
            let value = builder.value(value)?;
            match (&*name, value) {
                ("default", value) => property.value = Some(value),
                ("timeSamples", value) => property.samples = Some(value),
                ("targetPaths" | "connectionPaths", Value::Paths(list)) => property.targets = Some(list),
                (
                    "typeName" | "variability" | "custom" | "connectionChildren" | "targetChildren"
                    | "documentation" | "customData",
                    _,
                ) => {}
                (_, value) => {
                    builder.budget.take::<(Text, Value)>(1, &builder.file.name)?;
                    property.fields.0.push((name, value));
                }
            }
            Ok(())
        })?;
        self.layer.prims[prim as usize].properties.push(property);
        Ok(())
    }
}

/// The set and the variant of `{set=variant}`.
fn chosen(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix('{')?.strip_suffix('}')?.split_once('=')
}

//! Prims and their properties.

use super::lexer::Lexer;
use super::metadata::{Change, metadata, paths};
use super::values::{samples, typed};
use crate::layers::layer::{
    Fields, Layer, MAX_DEPTH, PRIM_BYTES, PROPERTY_BYTES, PrimSpec, Property, Specifier,
};
use crate::layers::list_op::ListOp;
use crate::layers::value::Text;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::path::PathBuf;
use std::sync::Arc;

/// The first bytes of every layer in text; files from before it had this name have the other.
pub(crate) const MAGIC: [&[u8]; 2] = [b"#usda ", b"#sdf "];

/// Reads a layer.
pub(crate) fn read(
    bytes: &[u8],
    name: &Arc<str>,
    folder: Option<PathBuf>,
    budget: &mut Budget,
) -> Result<Layer<'static>, FormatError> {
    let mut lexer = Lexer::new(bytes, name);
    let mut layer =
        Layer { name: name.clone(), folder, prims: vec![PrimSpec::default()], ..Layer::default() };
    metadata(&mut lexer, &mut layer.prims[0].fields, budget)?;
    let mut parser = Parser { lexer, layer, budget };
    while parser.lexer.peek().is_some() {
        parser.statement(0, 0)?;
    }
    Ok(parser.layer)
}

struct Parser<'a, 'b> {
    lexer: Lexer<'a>,
    layer: Layer<'static>,
    budget: &'b mut Budget,
}

impl Parser<'_, '_> {
    /// A prim, a property, a set of variants or an order, in a prim.
    fn statement(&mut self, prim: u32, depth: usize) -> Result<(), FormatError> {
        let specifier = match self.lexer.peek_word() {
            "def" => Specifier::Def,
            "over" => Specifier::Over,
            "class" => Specifier::Class,
            "variantSet" => return self.variant_set(prim, depth),
            "reorder" => return self.order(),
            "" => return Err(self.lexer.expected("a prim or a property")),
            _ => return self.property(prim),
        };
        self.lexer.word();
        self.prim(specifier, prim, depth)
    }

    fn prim(&mut self, specifier: Specifier, parent: u32, depth: usize) -> Result<(), FormatError> {
        if depth >= MAX_DEPTH {
            return Err(self.lexer.error(format!("prims are nested more than {MAX_DEPTH} levels deep")));
        }
        let at = self.lexer.place();
        let type_name: Text = self.lexer.word().into();
        let name = self.lexer.string()?;
        self.budget.take_bytes(PRIM_BYTES + name.len() as u64, self.lexer.name)?;
        let prim = self.layer.child(parent, name.into());
        let spec = &mut self.layer.prims[prim as usize];
        (spec.specifier, spec.at) = (specifier, at);
        if !type_name.is_empty() {
            spec.type_name = type_name;
        }
        self.body(prim, depth)
    }

    /// Metadata and a block of statements.
    fn body(&mut self, prim: u32, depth: usize) -> Result<(), FormatError> {
        metadata(&mut self.lexer, &mut self.layer.prims[prim as usize].fields, self.budget)?;
        self.lexer.take(b'{')?;
        while !self.lexer.takes(b'}') {
            self.statement(prim, depth + 1)?;
        }
        Ok(())
    }

    fn variant_set(&mut self, prim: u32, depth: usize) -> Result<(), FormatError> {
        if depth >= MAX_DEPTH {
            return Err(self.lexer.error(format!("variants are nested more than {MAX_DEPTH} levels deep")));
        }
        self.lexer.word();
        let set: Text = self.lexer.string()?.into();
        self.lexer.take(b'=')?;
        self.lexer.take(b'{')?;
        while !self.lexer.takes(b'}') {
            let at = self.lexer.place();
            let name: Text = self.lexer.string()?.into();
            self.budget.take_bytes(PRIM_BYTES + name.len() as u64, self.lexer.name)?;
            let variant = self.layer.variant(prim, &set, &name);
            self.layer.prims[variant as usize].at = at;
            self.body(variant, depth + 1)?;
        }
        Ok(())
    }

    /// The order of names changes nothing in a picture.
    fn order(&mut self) -> Result<(), FormatError> {
        self.lexer.word();
        if self.lexer.takes_word("rel") {
            self.lexer.word();
        }
        self.lexer.word();
        self.lexer.take(b'=')?;
        self.lexer.skip_group()
    }

    fn property(&mut self, prim: u32) -> Result<(), FormatError> {
        let change = Change::take(&mut self.lexer);
        while ["custom", "uniform", "varying", "config"].iter().any(|word| self.lexer.takes_word(word)) {}
        let mut kind = self.lexer.word().to_owned();
        if kind == "rel" {
            return self.relationship(prim, change);
        }
        if self.lexer.takes(b'[') {
            self.lexer.take(b']')?;
            kind.push_str("[]");
        }
        let word = self.lexer.word();
        if word.is_empty() {
            return Err(self.lexer.expected("the name of a property"));
        }
        let (name, part) = match word.rsplit_once('.') {
            Some((name, part @ ("timeSamples" | "connect" | "spline"))) => (name, part),
            _ => (word, ""),
        };
        let index = self.named(prim, name)?;
        if self.lexer.takes(b'=') {
            match part {
                "timeSamples" => {
                    let samples = samples(&mut self.lexer, &kind, self.budget)?;
                    self.at(prim, index).samples = Some(samples);
                }
                "connect" => {
                    let list = change.of(paths(&mut self.lexer, self.budget)?);
                    self.at(prim, index).targets.get_or_insert_with(ListOp::default).merge(list);
                }
                "spline" => self.lexer.skip_group()?,
                _ => {
                    let value = typed(&mut self.lexer, &kind, self.budget)?;
                    self.at(prim, index).value = Some(value);
                }
            }
        }
        self.property_metadata(prim, index)
    }

    fn relationship(&mut self, prim: u32, change: Change) -> Result<(), FormatError> {
        let name = self.lexer.word();
        if name.is_empty() {
            return Err(self.lexer.expected("the name of a relationship"));
        }
        let index = self.named(prim, name)?;
        if self.lexer.takes(b'=') {
            let list = change.of(paths(&mut self.lexer, self.budget)?);
            self.at(prim, index).targets.get_or_insert_with(ListOp::default).merge(list);
        }
        self.property_metadata(prim, index)
    }

    fn property_metadata(&mut self, prim: u32, index: usize) -> Result<(), FormatError> {
        if self.lexer.peek() != Some(b'(') {
            return Ok(());
        }
        let mut fields = Fields::default();
        metadata(&mut self.lexer, &mut fields, self.budget)?;
        fields.0.retain(|(key, _)| !matches!(&**key, "doc" | "customData" | "displayName"));
        self.at(prim, index).fields.0.extend(fields.0);
        Ok(())
    }

    fn at(&mut self, prim: u32, index: usize) -> &mut Property {
        &mut self.layer.prims[prim as usize].properties[index]
    }

    /// The property of this name, which several statements can describe: their order keeps them close together.
    fn named(&mut self, prim: u32, name: &str) -> Result<usize, FormatError> {
        const NEAR: usize = 64;
        let list = &mut self.layer.prims[prim as usize].properties;
        let near = list.len().saturating_sub(NEAR);
        if let Some(found) = list[near..].iter().position(|property| &*property.name == name) {
            return Ok(near + found);
        }
        self.budget.take_bytes(PROPERTY_BYTES + name.len() as u64, self.lexer.name)?;
        list.push(Property { name: name.into(), ..Property::default() });
        Ok(list.len() - 1)
    }
}

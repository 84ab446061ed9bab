//! Metadata in parentheses: of a layer, a prim, a variant or a property.

use super::lexer::Lexer;
use super::values::{dictionary, offset, reference, untyped};
use crate::layers::layer::Fields;
use crate::layers::list_op::ListOp;
use crate::layers::value::{Reference, Text, TimeOffset, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// Change that a statement makes to a weaker list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Replace,
    Prepend,
    Append,
    Delete,
    Reorder,
}

impl Change {
    /// Takes the word before a list, if there is one.
    pub(super) fn take(lexer: &mut Lexer) -> Change {
        let words = [
            ("prepend", Change::Prepend),
            ("append", Change::Append),
            ("add", Change::Append),
            ("delete", Change::Delete),
            ("reorder", Change::Reorder),
        ];
        let found = words.into_iter().find(|(word, _)| lexer.takes_word(word));
        found.map_or(Change::Replace, |(_, change)| change)
    }

    pub(super) fn of<T>(self, list: Vec<T>) -> ListOp<T> {
        let none =
            ListOp { explicit: None, prepended: Vec::new(), appended: Vec::new(), deleted: Vec::new() };
        match self {
            Change::Replace => ListOp { explicit: Some(list), ..none },
            Change::Prepend => ListOp { prepended: list, ..none },
            Change::Append => ListOp { appended: list, ..none },
            Change::Delete => ListOp { deleted: list, ..none },
            Change::Reorder => none,
        }
    }
}

/// Reads what is in parentheses, if they come next.
pub(super) fn metadata(
    lexer: &mut Lexer,
    fields: &mut Fields,
    budget: &mut Budget,
) -> Result<(), FormatError> {
    if !lexer.takes(b'(') {
        return Ok(());
    }
    while !lexer.takes(b')') {
        // A remark.
        if let Some(b'"' | b'\'') = lexer.peek() {
            lexer.string()?;
            continue;
        }
        let change = Change::take(lexer);
        let key = lexer.word();
        if key.is_empty() {
            return Err(lexer.expected("the name of a piece of metadata"));
        }
        lexer.take(b'=')?;
        budget.take::<(Text, Value)>(1, lexer.name)?;
        let value = entry(lexer, key, change, budget)?;
        add(fields, key, value, lexer, budget)?;
        lexer.takes(b',');
    }
    Ok(())
}

fn entry(lexer: &mut Lexer, key: &str, change: Change, budget: &mut Budget) -> Result<Value, FormatError> {
    Ok(match key {
        "references" | "payload" => Value::References(change.of(references(lexer, budget)?)),
        "inherits" | "specializes" => Value::Paths(change.of(paths(lexer, budget)?)),
        "apiSchemas" | "variantSets" => Value::Names(change.of(names(lexer, budget)?)),
        "inactiveIds" => Value::Integers(change.of(integers(lexer, budget)?)),
        "variants" => match dictionary(lexer, budget, 0)? {
            Value::Dictionary(entries) => {
                let chosen =
                    entries.into_iter().filter_map(|(set, value)| Some((set, value.text()?.clone())));
                Value::Selections(chosen.collect())
            }
            other => other,
        },
        "subLayers" => sublayers(lexer, budget)?,
        _ => untyped(lexer, budget, 0)?,
    })
}

/// Adds an entry; several statements about one list are one change.
fn add(
    fields: &mut Fields,
    key: &str,
    value: Value,
    lexer: &mut Lexer,
    budget: &mut Budget,
) -> Result<(), FormatError> {
    let known = fields.0.iter_mut().find(|(name, _)| &**name == key).map(|(_, value)| value);
    match (known, value) {
        (Some(Value::References(list)), Value::References(more)) => list.merge(more),
        (Some(Value::Paths(list)), Value::Paths(more)) => list.merge(more),
        (Some(Value::Names(list)), Value::Names(more)) => list.merge(more),
        (Some(Value::Integers(list)), Value::Integers(more)) => list.merge(more),
        (Some(known), value) => *known = value,
        (None, Value::References(ListOp { explicit: Some(list), .. })) if key == "subLayers" => {
            budget.take::<TimeOffset>(list.len(), lexer.name)?;
            let offsets = list.iter().map(|layer| layer.offset).collect();
            let names: Vec<Text> = list.into_iter().map(|layer| layer.asset.into()).collect();
            fields.0.push(("subLayers".into(), Value::Texts(names.into())));
            fields.0.push(("subLayerOffsets".into(), Value::Offsets(offsets)));
        }
        (None, value) => fields.0.push((key.into(), value)),
    }
    Ok(())
}

/// One thing, a list of them in brackets, or none.
fn several<T>(
    lexer: &mut Lexer,
    budget: &mut Budget,
    mut one: impl FnMut(&mut Lexer, &mut Budget) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    if lexer.takes_word("None") {
        return Ok(Vec::new());
    }
    if !lexer.takes(b'[') {
        return Ok(vec![one(lexer, budget)?]);
    }
    let mut list = Vec::new();
    while !lexer.takes(b']') {
        budget.take::<T>(1, lexer.name)?;
        list.push(one(lexer, budget)?);
        lexer.takes(b',');
    }
    Ok(list)
}

fn references(lexer: &mut Lexer, budget: &mut Budget) -> Result<Vec<Reference>, FormatError> {
    several(lexer, budget, |lexer, budget| match lexer.peek() {
        Some(b'@' | b'<') => reference(lexer, budget),
        _ => Err(lexer.expected("a file between @ and @, or a path between < and >")),
    })
}

pub(super) fn paths(lexer: &mut Lexer, budget: &mut Budget) -> Result<Vec<Text>, FormatError> {
    several(lexer, budget, |lexer, _| Ok(lexer.path()?.into()))
}

fn names(lexer: &mut Lexer, budget: &mut Budget) -> Result<Vec<Text>, FormatError> {
    several(lexer, budget, |lexer, _| Ok(lexer.string()?.into()))
}

fn integers(lexer: &mut Lexer, budget: &mut Budget) -> Result<Vec<i64>, FormatError> {
    several(lexer, budget, |lexer, budget| {
        let number = untyped(lexer, budget, 0)?.number();
        number.map(|x| x as i64).ok_or_else(|| lexer.expected("a number"))
    })
}

fn sublayers(lexer: &mut Lexer, budget: &mut Budget) -> Result<Value, FormatError> {
    let list = several(lexer, budget, |lexer, budget| {
        let asset = lexer.asset()?.into_owned();
        let offset = if lexer.peek() == Some(b'(') { offset(lexer, budget)? } else { TimeOffset::default() };
        Ok(Reference { asset, path: String::new(), offset })
    })?;
    Ok(Value::References(ListOp::explicit(list)))
}

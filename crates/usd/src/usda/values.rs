//! Values: of a stated type, or of one that they show themselves.

use super::lexer::Lexer;
use super::types::{Class, type_named};
use crate::layers::layer::MAX_DEPTH;
use crate::layers::list_op::ListOp;
use crate::layers::value::{Array, Numbers, Reference, Text, TimeOffset, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::sync::Arc;

/// Numbers whose memory is charged at a time.
const BLOCK: usize = 4096;

/// A value of a type, such as `float3[]`.
pub(super) fn typed(lexer: &mut Lexer, name: &str, budget: &mut Budget) -> Result<Value, FormatError> {
    if lexer.takes_word("None") || lexer.takes_word("AnimationBlock") {
        return Ok(Value::Blocked);
    }
    let base = name.strip_suffix("[]");
    let Some((class, width)) = type_named(base.unwrap_or(name)) else {
        return untyped(lexer, budget, 0);
    };
    match (class, base.is_some()) {
        (Class::Dictionary, _) => dictionary(lexer, budget, 0),
        (Class::Texts | Class::Assets, false) => text(lexer),
        (Class::Texts | Class::Assets, true) => texts(lexer, budget),
        (_, true) => array(lexer, class, width, budget),
        (_, false) if width == 1 => Ok(Value::Number(lexer.number()?)),
        _ => {
            let mut list = Vec::with_capacity(width);
            numbers(lexer, |x| {
                list.push(x);
                list.len() <= 16
            })?;
            if list.len() != width {
                return Err(lexer.error(format!("a {name} before here has {} numbers", list.len())));
            }
            if class == Class::Turns {
                list.rotate_left(1);
            }
            Ok(Value::Tuple(list))
        }
    }
}

fn text(lexer: &mut Lexer) -> Result<Value, FormatError> {
    Ok(match lexer.peek() {
        Some(b'@') => Value::Asset(lexer.asset()?.into()),
        _ => Value::Text(lexer.string()?.into()),
    })
}

fn texts(lexer: &mut Lexer, budget: &mut Budget) -> Result<Value, FormatError> {
    let mut list: Vec<Text> = Vec::new();
    lexer.take(b'[')?;
    while !lexer.takes(b']') {
        let (Value::Text(text) | Value::Asset(text)) = text(lexer)? else { continue };
        budget.take_bytes((2 * size_of::<Text>() + text.len()) as u64, lexer.name)?;
        list.push(text);
        lexer.takes(b',');
    }
    Ok(Value::Texts(list.into()))
}

/// Numbers within brackets of any depth, up to the one that closes the first, or until `push` returns false.
fn numbers(lexer: &mut Lexer, mut push: impl FnMut(f64) -> bool) -> Result<(), FormatError> {
    let mut depth = 0u32;
    loop {
        match lexer.peek() {
            Some(b'(' | b'[') => {
                depth += 1;
                lexer.takes(b'(');
                lexer.takes(b'[');
            }
            Some(b')' | b']') if depth > 0 => {
                depth -= 1;
                if !lexer.takes(b')') {
                    lexer.takes(b']');
                }
            }
            Some(b',') => _ = lexer.takes(b','),
            _ => {
                let number = lexer.number()?;
                if !push(number) {
                    return Err(lexer.error("there are too many numbers in this tuple"));
                }
            }
        }
        if depth == 0 {
            return Ok(());
        }
    }
}

fn array(lexer: &mut Lexer, class: Class, width: usize, budget: &mut Budget) -> Result<Value, FormatError> {
    if lexer.peek() != Some(b'[') {
        return Err(lexer.expected("a list in brackets"));
    }
    let mut list = match class {
        Class::Integers => Numbers::Integers(Vec::new()),
        Class::Doubles => Numbers::Doubles(Vec::new()),
        _ => Numbers::Floats(Vec::new()),
    };
    let name = lexer.name.clone();
    let mut refused = None;
    let read = numbers(lexer, |x| {
        if list.len() % BLOCK == 0 {
            // Lists grow by doubling.
            if let Err(error) = budget.take_bytes((16 * BLOCK) as u64, &name) {
                refused = Some(error);
                return false;
            }
        }
        match &mut list {
            Numbers::Floats(list) => list.push(x as f32),
            Numbers::Doubles(list) => list.push(x),
            Numbers::Integers(list) => list.push(x as i32),
        }
        true
    });
    refused.map_or(read, Err)?;
    if list.len() % width != 0 {
        return Err(lexer.error(format!(
            "the list before here has {} numbers, which is not a multiple of {width}",
            list.len()
        )));
    }
    if let (Class::Turns, Numbers::Floats(list)) = (class, &mut list) {
        list.as_chunks_mut::<4>().0.iter_mut().for_each(|turn| turn.rotate_left(1));
    }
    Ok(Value::Array(Arc::new(Array { numbers: list, width })))
}

/// A value of metadata, whose kind its first letter tells.
pub(super) fn untyped(lexer: &mut Lexer, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
    if depth > MAX_DEPTH {
        return Err(lexer.error("values are nested too deeply"));
    }
    match lexer.peek() {
        Some(b'"' | b'\'') => Ok(Value::Text(lexer.string()?.into())),
        Some(b'@' | b'<') => {
            let reference = reference(lexer, budget)?;
            Ok(match reference {
                Reference { asset, path, .. } if asset.is_empty() => {
                    Value::Paths(ListOp::explicit(vec![path.into()]))
                }
                reference => Value::References(ListOp::explicit(vec![reference])),
            })
        }
        Some(b'{') => dictionary(lexer, budget, depth),
        Some(b'[') => list(lexer, budget, depth),
        Some(b'(') => {
            let mut list = Vec::new();
            let mut left = budget.left() / 16;
            numbers(lexer, |x| {
                list.push(x);
                left = left.saturating_sub(1);
                left > 0
            })?;
            Ok(Value::Tuple(list))
        }
        Some(b'-' | b'+' | b'.' | b'0'..=b'9') => Ok(Value::Number(lexer.number()?)),
        _ => match lexer.word() {
            "" => Err(lexer.expected("a value")),
            "None" => Ok(Value::Blocked),
            "true" | "True" => Ok(Value::Number(1.0)),
            "false" | "False" => Ok(Value::Number(0.0)),
            word => Ok(Value::Text(word.into())),
        },
    }
}

/// A list of strings, of paths, of references or of numbers.
fn list(lexer: &mut Lexer, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
    lexer.take(b'[')?;
    let (mut texts, mut paths, mut references) = (Vec::new(), Vec::new(), Vec::new());
    let mut others = Vec::new();
    while !lexer.takes(b']') {
        budget.take_bytes(2 * size_of::<Reference>() as u64, lexer.name)?;
        match untyped(lexer, budget, depth + 1)? {
            Value::Text(text) | Value::Asset(text) => texts.push(text),
            Value::Number(x) => others.push(x),
            Value::Tuple(list) => others.extend(list),
            Value::Paths(list) => paths.extend(list.explicit.unwrap_or_default()),
            Value::References(list) => references.extend(list.explicit.unwrap_or_default()),
            _ => {}
        }
        lexer.takes(b',');
    }
    Ok(if !references.is_empty() {
        // Paths among them are references within the layer.
        references.extend(
            paths.iter().map(|path: &Text| Reference { path: path.to_string(), ..Reference::default() }),
        );
        Value::References(ListOp::explicit(references))
    } else if !paths.is_empty() {
        Value::Paths(ListOp::explicit(paths))
    } else if !texts.is_empty() {
        Value::Texts(texts.into())
    } else {
        Value::Array(Arc::new(Array { numbers: Numbers::Doubles(others), width: 1 }))
    })
}

/// A file, a path, or both, with an offset of time.
pub(super) fn reference(lexer: &mut Lexer, budget: &mut Budget) -> Result<Reference, FormatError> {
    let mut reference = Reference::default();
    if lexer.peek() == Some(b'@') {
        reference.asset = lexer.asset()?.into_owned();
    }
    if lexer.peek() == Some(b'<') {
        reference.path = lexer.path()?.into_owned();
    }
    if lexer.peek() == Some(b'(') {
        reference.offset = offset(lexer, budget)?;
    }
    Ok(reference)
}

/// `(offset = 1; scale = 2)`, with remarks.
pub(super) fn offset(lexer: &mut Lexer, budget: &mut Budget) -> Result<TimeOffset, FormatError> {
    let mut offset = TimeOffset::default();
    lexer.take(b'(')?;
    while !lexer.takes(b')') {
        match lexer.word() {
            "" => return Err(lexer.expected("')'")),
            "offset" => {
                lexer.take(b'=')?;
                offset.offset = lexer.number()?;
            }
            "scale" => {
                lexer.take(b'=')?;
                offset.scale = lexer.number()?;
            }
            _ => {
                lexer.take(b'=')?;
                untyped(lexer, budget, 0)?;
            }
        }
        lexer.takes(b',');
    }
    Ok(offset.sound())
}

/// `{ type name = value … }`
pub(super) fn dictionary(lexer: &mut Lexer, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
    if depth > MAX_DEPTH {
        return Err(lexer.error("dictionaries are nested too deeply"));
    }
    let mut entries = Vec::new();
    lexer.take(b'{')?;
    while !lexer.takes(b'}') {
        let mut kind = lexer.word().to_owned();
        if kind.is_empty() {
            return Err(lexer.expected("a type"));
        }
        if lexer.takes(b'[') {
            lexer.take(b']')?;
            kind.push_str("[]");
        }
        let key: Text = match lexer.peek() {
            Some(b'"' | b'\'') => lexer.string()?.into(),
            _ => lexer.word().into(),
        };
        lexer.take(b'=')?;
        let value = match &*kind {
            "dictionary" => dictionary(lexer, budget, depth + 1)?,
            _ => typed(lexer, &kind, budget)?,
        };
        budget.take::<(Text, Value)>(1, lexer.name)?;
        entries.push((key, value));
        lexer.takes(b',');
    }
    Ok(Value::Dictionary(entries))
}

/// `{ time: value, … }`
pub(super) fn samples(lexer: &mut Lexer, kind: &str, budget: &mut Budget) -> Result<Value, FormatError> {
    let mut all: Vec<(f64, Value)> = Vec::new();
    lexer.take(b'{')?;
    while !lexer.takes(b'}') {
        let time = lexer.number()?;
        lexer.take(b':')?;
        let value = typed(lexer, kind, budget)?;
        budget.take::<(f64, Value)>(1, lexer.name)?;
        all.push((time, value));
        lexer.takes(b',');
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(Value::Samples(all.into()))
}

//! Animation before version 7: takes, which list channels below the names of objects.

use super::clip::Clip;
use super::curve::Curve;
use super::key::{Interpolation, Key, Rule, Tangent};
use super::layers::stated;
use crate::fbx::document::{Animated, Document, Index, Properties, display_name};
use crate::fbx::tree::{Node, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DVec3;
use std::collections::HashMap;

/// All takes of the file.
pub(super) fn nodes<'d>(document: &Document<'d>) -> Vec<Node<'d>> {
    document.tree.root().children_named("Takes").flat_map(|takes| takes.children_named("Take")).collect()
}

/// The name and the times of a take.
pub(super) fn clip(take: Node) -> Clip {
    let name = take.value(0).and_then(Value::text).map(display_name).unwrap_or_default();
    let times = take.child("LocalTime").or(take.child("ReferenceTime"));
    let time = |index: usize| times.and_then(|times| times.value(index)?.integer()).unwrap_or(0);
    Clip { name, begin: time(0), end: time(1) }
}

/// Sets the values of a take at a time in units of the file.
pub(super) fn play<'d>(
    document: &Document<'d>,
    take: Node<'d>,
    time: f64,
    animated: &mut HashMap<Index, Animated<'d>>,
    budget: &mut Budget,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    // Objects may have many properties, and each many channels.
    let mut targets: HashMap<Index, Properties> = HashMap::new();
    for node in take.children() {
        let Some(object) = node.value(0).and_then(|name| document.named(name)) else { continue };
        for channel in node.children_named("Channel") {
            let Some(name) = channel.value(0).and_then(Value::text) else { continue };
            let parts: Vec<(&[u8], Node)> = match name {
                b"Transform" => {
                    let named =
                        [("T", &b"Lcl Translation"[..]), ("R", b"Lcl Rotation"), ("S", b"Lcl Scaling")];
                    named
                        .into_iter()
                        .filter_map(|(letter, property)| Some((property, part(channel, letter)?)))
                        .collect()
                }
                name => vec![(name, channel)],
            };
            for (property, channel) in parts {
                budget.take_bytes(size_of::<Properties>() as u64, document.file())?;
                let target = targets.entry(object).or_insert_with(|| document.properties(object));
                let spent = budget.spent();
                let value = match value(target, property, channel, time, document.settings.ticks, budget) {
                    Ok(value) => value,
                    Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                    Err(error) => {
                        let what = format!("part of an animation is left out: {}", error.without_place());
                        diagnostics.note(&what, || channel.at());
                        continue;
                    }
                };
                budget.release(budget.spent() - spent);
                budget.take::<(Index, &[u8], DVec3, [usize; 4])>(1, document.file())?;
                animated.entry(object).or_default().insert(property, value);
            }
        }
    }
    Ok(())
}

/// The part of a channel with a name.
fn part<'d>(channel: Node<'d>, name: &str) -> Option<Node<'d>> {
    channel
        .children_named("Channel")
        .find(|part| part.value(0).and_then(Value::text) == Some(name.as_bytes()))
}

/// The values of a channel: of its keys, or of those of its parts for the axes.
fn value(
    properties: &Properties,
    property: &[u8],
    channel: Node,
    time: f64,
    ticks: f64,
    budget: &mut Budget,
) -> Result<DVec3, FormatError> {
    let mut values = stated(properties, property);
    let axes = ["X", "Y", "Z"].map(|axis| part(channel, axis));
    let parts = if axes.iter().all(Option::is_none) { [Some(channel), None, None] } else { axes };
    for (axis, part) in parts.into_iter().enumerate() {
        let Some(part) = part else { continue };
        let default = part.child_value("Default").and_then(Value::number);
        let curve = part.child("Key").map(|keys| curve(part, keys, ticks, budget)).transpose()?;
        values[axis] = curve.and_then(|curve| curve.at(time)).or(default).unwrap_or(values[axis]);
    }
    Ok(values)
}

/// Reads keys: time, value and a letter for what comes next, with its own numbers.
fn curve(channel: Node, keys: Node, ticks: f64, budget: &mut Budget) -> Result<Curve, FormatError> {
    let version = channel.child_value("KeyVer").and_then(Value::integer).unwrap_or(4005);
    let mut values = keys.values();
    let mut list = Vec::new();
    while let (Some(time), Some(value)) =
        (values.next().and_then(Value::number), values.next().and_then(Value::number))
    {
        budget.take::<Key>(1, keys.file())?;
        let fault = || keys.error("a key of an animation is not understood");
        let interpolation = match values.next().and_then(letter).ok_or_else(fault)? {
            b'L' => Interpolation::Linear,
            b'C' => {
                let is_next = version >= 4004 && values.next().and_then(letter) == Some(b'n');
                Interpolation::Constant { is_next }
            }
            b'U' => cubic(&mut values, version).ok_or_else(fault)?,
            _ => return Err(fault()),
        };
        list.push(Key { time, value, interpolation });
    }
    Ok(Curve::new(channel, list, ticks))
}

/// A letter: a word in text, and a number in binary.
fn letter(value: Value) -> Option<u8> {
    match value {
        Value::Word(word) => word.first().copied(),
        Value::Integer(code) => u8::try_from(code).ok(),
        _ => None,
    }
}

/// The slopes and weights of a cubic key. The kinds other than stated slopes are not documented, and taken as automatic.
fn cubic<'d>(values: &mut impl Iterator<Item = Value<'d>>, version: i64) -> Option<Interpolation> {
    let mut slopes = None;
    let kind = values.next().and_then(letter)?;
    // As many numbers, and then as many lists of weights.
    let (numbers, lists) = match (kind, version) {
        (b's' | b'b', 4003) => (2, 0),
        (b's' | b'b', _) => (2, 1),
        (b'a', ..=4004) => (0, 0),
        (b'a', _) => (0, 1),
        (b'p' | b'q', ..=4004) => (2, 1),
        (b'p' | b'q', _) => (2, 2),
        (b't', _) => (3, 0),
        (b'd', _) => (1, 1),
        _ => return None,
    };
    let mut list = [0.0; 3];
    for number in &mut list[..numbers] {
        *number = values.next()?.number()?;
    }
    if matches!(kind, b's' | b'b') {
        slopes = Some([list[0], list[1]]);
    }
    let mut weights = [1.0 / 3.0; 2];
    for _ in 0..lists {
        let kind = values.next().and_then(letter)?;
        let mut number = || values.next()?.number();
        match kind {
            b'n' | b'c' | b'd' => {}
            b'a' => weights = [number()?, number()?],
            b'r' => weights[0] = number()?,
            b'l' => weights[1] = number()?,
            _ => return None,
        }
    }
    let tangent = if slopes.is_some() { Tangent::Stated } else { Tangent::Automatic(Rule::USUAL) };
    Some(Interpolation::Cubic { slopes: slopes.unwrap_or_default(), weights, tangent })
}

//! YAML and JSON as one tree.

use crate::FormatError;
use crate::bytes::text::whole_file;
use crate::input::reading::Source;
use bilux_scene::Span;
use saphyr_parser::{Event, Parser, ScalarStyle};
use serde_json::{Map, Number, Value};

/// Deeper trees are refused, since each level uses some of the stack.
const DEEPEST: usize = 64;

/// The tree of a file.
pub(super) fn document(source: &Source) -> Result<Value, FormatError> {
    let wrong = |message: String| FormatError::malformed(message, whole_file(source.name));
    let text = std::str::from_utf8(source.bytes).map_err(|_| wrong("the file is not in UTF-8".to_owned()))?;
    if text.trim_start().starts_with('{') {
        return serde_json::from_str(text).map_err(|error| {
            let at =
                Span { line: error.line() as u32, column: error.column() as u32, ..whole_file(source.name) };
            FormatError::malformed(format!("this is no JSON: {error}"), at)
        });
    }
    // OpenCV begins with a version that is no YAML: %YAML:1.0
    let text = match text.strip_prefix("%YAML:") {
        Some(rest) => rest.split_once('\n').map_or("", |(_, rest)| rest),
        None => text,
    };
    tree(text, source)
}

/// A list or a map that is not complete.
struct Open {
    node: Value,
    /// The key whose value comes next, in a map.
    key: Option<String>,
}

/// The tree of a YAML text. Anchors are refused: what repeats itself can grow without bounds.
fn tree(text: &str, source: &Source) -> Result<Value, FormatError> {
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, place) = event.map_err(|error| {
            let marker = error.marker();
            let at = Span {
                line: marker.line() as u32,
                column: marker.col() as u32 + 1,
                ..whole_file(source.name)
            };
            FormatError::malformed(format!("this is no YAML: {}", error.info()), at)
        })?;
        let wrong = |message: &str| {
            let at = Span { line: place.start.line() as u32, column: 1, ..whole_file(source.name) };
            FormatError::malformed(message, at)
        };
        let whole = match event {
            Event::SequenceStart(..) => {
                open.push(Open { node: Value::Array(Vec::new()), key: None });
                None
            }
            Event::MappingStart(..) => {
                open.push(Open { node: Value::Object(Map::new()), key: None });
                None
            }
            Event::SequenceEnd | Event::MappingEnd => open.pop().map(|open| open.node),
            Event::Scalar(text, style, ..) => Some(scalar(&text, style)),
            Event::Alias(_) => return Err(wrong("aliases (*name) are not supported here: write the value")),
            _ => None,
        };
        if open.len() > DEEPEST {
            return Err(wrong("this is nested too deeply"));
        }
        let Some(whole) = whole else { continue };
        let Some(parent) = open.last_mut() else { return Ok(whole) };
        match &mut parent.node {
            Value::Array(items) => items.push(whole),
            Value::Object(map) => match parent.key.take() {
                Some(key) => drop(map.insert(key, whole)),
                None => parent.key = Some(name_of(&whole)),
            },
            _ => {}
        }
    }
    Ok(Value::Null)
}

/// A key, which may be written as a number.
fn name_of(key: &Value) -> String {
    key.as_str().map_or_else(|| key.to_string(), str::to_owned)
}

fn scalar(text: &str, style: ScalarStyle) -> Value {
    if style != ScalarStyle::Plain {
        return Value::String(text.to_owned());
    }
    if let Ok(whole) = text.parse::<i64>() {
        return Value::Number(whole.into());
    }
    match text.parse::<f64>().ok().and_then(Number::from_f64) {
        Some(number) => Value::Number(number),
        None => match text {
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            "" | "~" | "null" => Value::Null,
            _ => Value::String(text.to_owned()),
        },
    }
}

/// All numbers of a list, or of a list of lists; `None` if there is anything else in it.
pub(super) fn numbers(value: &Value) -> Option<Vec<f64>> {
    let mut all = Vec::new();
    for item in value.as_array()? {
        match item.as_f64() {
            Some(number) => all.push(number),
            None => all.extend(item.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<_>>>()?),
        }
    }
    Some(all)
}

/// A key without what programs write differently.
pub(super) fn plain(key: &str) -> String {
    key.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The value of the first of these names, with the number of a camera behind it.
pub(super) fn find<'m>(map: &'m Map<String, Value>, names: &[&str], number: &str) -> Option<&'m Value> {
    names.iter().find_map(|name| {
        let wanted = format!("{name}{number}");
        map.iter().find(|(key, _)| plain(key) == wanted).map(|(_, value)| value)
    })
}

/// The numbers of a matrix: OpenCV's, with rows, columns and data, or a list.
pub(super) fn matrix(value: &Value, what: &str) -> Result<Vec<f64>, String> {
    let data = value.get("data").unwrap_or(value);
    let found = numbers(data).ok_or_else(|| format!("{what} is no list of numbers"))?;
    let side = |key: &str| value.get(key).and_then(Value::as_u64);
    if let (Some(rows), Some(columns)) = (side("rows"), side("cols"))
        && rows.checked_mul(columns) != Some(found.len() as u64)
    {
        return Err(format!("{what} has {rows} rows and {columns} columns, but {} numbers", found.len()));
    }
    Ok(found)
}

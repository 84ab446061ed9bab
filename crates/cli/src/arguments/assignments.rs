//! Values that options assign to keys (`--set`, `--change`), as scene files would hold them.

use anyhow::Context;
use bilux::scene::{Change, Part, Span, Value, Which};

/// Parses `KEY=VALUE`; the value is what a scene file would hold: true, 3, 0.5, `1,2,3` or text.
pub fn assignment_of(assignment: &str) -> anyhow::Result<(String, Value)> {
    let (key, value) = assignment.split_once('=').with_context(|| {
        format!(
            "--set {assignment}: write KEY=VALUE, such as --set {assignment}=1; `bilux list \
                                  settings` lists the keys"
        )
    })?;
    Ok((key.trim().to_owned(), value_of(value)))
}

/// A value as a scene file would hold it: true, 3, 0.5, `1,2,3` or text.
pub fn value_of(value: &str) -> Value {
    let parts: Vec<&str> = value.trim_matches(['[', ']']).split(',').map(str::trim).collect();
    match parts.as_slice() {
        [one] => scalar(one),
        many => {
            let values: Vec<Value> = many.iter().map(|part| scalar(part)).collect();
            if values.iter().any(|v| matches!(v, Value::Text(_))) {
                Value::Text(value.to_owned())
            } else {
                Value::List(values)
            }
        }
    }
}

/// Parses `PART:NAME:KEY=VALUE`. Names may have colons and equals signs in them; keys have neither.
pub fn change_of(text: &str) -> anyhow::Result<Change> {
    let is_key = |key: &str| !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    let parts = text.split_once(':').and_then(|(part, rest)| {
        let ends = rest.match_indices('=').map(|(end, _)| (&rest[..end], &rest[end + 1..]));
        let mut found = ends.filter_map(|(named, value)| Some((named.rsplit_once(':')?, value)));
        let ((name, key), value) = found.find(|((_, key), _)| is_key(key))?;
        Some((Part::named(part)?, name, key, value))
    });
    let (part, name, key, value) = parts.with_context(|| {
        format!(
            "--change {text}: write material, light or camera, then its name or its number, then KEY=VALUE: \
             --change material:Paint:base_color=0.8,0,0"
        )
    })?;
    let which = match name.parse() {
        Ok(number) => Which::Number(number),
        Err(_) => Which::Name(name.to_owned()),
    };
    let at = from_flag(&format!("--change {}:{name}:{key}", part.name()));
    Ok(Change { part, which, key: key.to_owned(), value: value_of(value), at })
}

fn scalar(text: &str) -> Value {
    match text {
        "true" => return Value::Bool(true),
        "false" => return Value::Bool(false),
        _ => {}
    }
    if let Ok(i) = text.parse() {
        return Value::Integer(i);
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Value::Number(x),
        _ => Value::Text(text.to_owned()),
    }
}

/// Origin of a value that an option gives, as messages name it.
pub fn from_flag(flag: &str) -> Span {
    Span { file: flag.into(), line: 0, column: 0 }
}

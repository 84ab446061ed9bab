//! Values without tables, and tables without values.

use super::document::{Item, Table, TomlValue};
use bilux_import::FormatError;
use bilux_scene::{SceneError, Value};

/// A value that contains no table.
pub(super) fn plain_value(key: &str, item: &Item) -> Result<Value, FormatError> {
    Ok(match &item.node {
        TomlValue::Bool(b) => Value::Bool(*b),
        TomlValue::Integer(i) => Value::Integer(*i),
        TomlValue::Number(x) => Value::Number(*x),
        TomlValue::Text(text) => Value::Text(text.clone()),
        TomlValue::List(items) => {
            Value::List(items.iter().map(|item| plain_value(key, item)).collect::<Result<_, _>>()?)
        }
        TomlValue::Table(_) => return Err(item.wrong(key, "a value, or a list of values")),
    })
}

/// The error for a table without a required key.
pub(super) fn missing(what: &str, table: &Table) -> FormatError {
    SceneError::Missing { what: what.to_owned(), at: table.at.clone() }.into()
}

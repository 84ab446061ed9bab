//! TOML with the location of every key and value.

use bilux_import::FormatError;
use bilux_import::bytes::text::{Places, whole_file};
use bilux_scene::{SceneError, Span};
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// A TOML value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TomlValue {
    Bool(bool),
    Integer(i64),
    Number(f64),
    Text(String),
    List(Vec<Item>),
    Table(Table),
}

/// A value with its location.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Item {
    pub(super) node: TomlValue,
    pub(super) at: Span,
}

/// Keys in file order, each with its own location.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    pub(super) entries: Vec<(String, Span, Item)>,
    pub(super) at: Span,
}

/// The maximum number of bytes in memory per byte of the file: a list of one-digit numbers.
pub(super) const BYTES_PER_BYTE: u64 = 160;

/// Parses a file.
pub(super) fn parse(bytes: &[u8], name: &Arc<str>) -> Result<Table, FormatError> {
    let places = Places::new(name, bytes);
    let text = std::str::from_utf8(bytes).map_err(|e| {
        FormatError::malformed("a TOML file must be UTF-8 text, but this is not", places.at(e.valid_up_to()))
    })?;
    let document = DeTable::parse(text).map_err(|e| {
        let at = e.span().map_or_else(|| whole_file(name), |span| places.at(span.start));
        let key = e.span().and_then(|span| text.get(span)).unwrap_or_default().trim();
        FormatError::malformed(format!("this is not valid TOML: {}", syntax_fault(e.message(), key)), at)
    })?;
    table(document.get_ref(), Span { line: 1, column: 1, ..whole_file(name) }, &places)
}

/// The parser's message with quotes as in Bilux's other messages; `key` is the text that it is about.
fn syntax_fault(report: &str, key: &str) -> String {
    if report == "duplicate key" {
        return format!("the key '{key}' occurs twice: remove one of them");
    }
    report.replace("`\"`", "a double quote").replace('`', "'")
}

fn table(source: &DeTable, at: Span, places: &Places) -> Result<Table, FormatError> {
    let mut rows: Vec<_> = source.iter().collect();
    rows.sort_by_key(|(key, _)| key.span().start);
    let mut entries = Vec::with_capacity(rows.len());
    for (key, value) in rows {
        let key_at = places.at(key.span().start);
        // The location of a nested table means little; that of its key is used instead.
        let value_at = if value.span().is_empty() { key_at.clone() } else { places.at(value.span().start) };
        entries.push((key.get_ref().to_string(), key_at, item(value.get_ref(), value_at, places)?));
    }
    Ok(Table { entries, at })
}

fn item(value: &DeValue, at: Span, places: &Places) -> Result<Item, FormatError> {
    let refuse = |message: &str| Err(FormatError::malformed(message, at.clone()));
    let node = match value {
        DeValue::Boolean(b) => TomlValue::Bool(*b),
        DeValue::String(text) => TomlValue::Text(text.to_string()),
        DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
            Ok(i) => TomlValue::Integer(i),
            Err(_) => return refuse("this number is too large"),
        },
        DeValue::Float(x) => match x.as_str().parse() {
            Ok(x) => TomlValue::Number(x),
            Err(_) => return refuse("this is not a number"),
        },
        DeValue::Datetime(_) => {
            return refuse("scenes do not use dates: write text in quotes, or a number of seconds");
        }
        DeValue::Array(array) => {
            let items = array.iter().map(|v| item(v.get_ref(), places.at(v.span().start), places));
            TomlValue::List(items.collect::<Result<_, _>>()?)
        }
        DeValue::Table(inner) => TomlValue::Table(table(inner, at.clone(), places)?),
    };
    Ok(Item { node, at })
}

impl Table {
    pub(super) fn find(&self, key: &str) -> Option<&Item> {
        self.entries.iter().find(|(k, ..)| k == key).map(|(.., item)| item)
    }

    /// Refuses unknown keys.
    pub(super) fn check_keys<'k>(
        &self,
        what: &str,
        known: impl Iterator<Item = &'k str> + Clone,
    ) -> Result<(), FormatError> {
        match self.entries.iter().find(|(key, ..)| !known.clone().any(|k| k == key)) {
            Some((key, at, _)) => Err(SceneError::unknown(format!("key of {what}"), key, known, at).into()),
            None => Ok(()),
        }
    }

    /// The text under a key, if it exists.
    pub(super) fn text(&self, key: &str) -> Result<Option<&str>, FormatError> {
        self.find(key).map(|item| item.text(key)).transpose()
    }

    /// The switch under a key; false if it does not exist.
    pub(super) fn switch(&self, key: &str) -> Result<bool, FormatError> {
        match self.find(key) {
            None => Ok(false),
            Some(Item { node: TomlValue::Bool(b), .. }) => Ok(*b),
            Some(item) => Err(item.wrong(key, "true or false")),
        }
    }

    /// The tables under a key: a single one, or a list.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<&Table>, FormatError> {
        let as_table = |item: &Item| match &item.node {
            TomlValue::Table(_) => Ok(()),
            _ => Err(item.wrong(key, &format!("a table: begin it with [[{key}]]"))),
        };
        let items: &[Item] = match self.find(key) {
            None => &[],
            Some(Item { node: TomlValue::List(items), .. }) => items,
            Some(item) => std::slice::from_ref(item),
        };
        let table = |item| match item {
            &Item { node: TomlValue::Table(ref table), .. } => Some(table),
            _ => None,
        };
        items.iter().try_for_each(as_table)?;
        Ok(items.iter().filter_map(table).collect())
    }
}

impl Item {
    /// The error for a value of the wrong type.
    pub(super) fn wrong(&self, key: &str, wanted: &str) -> FormatError {
        SceneError::BadValue {
            what: key.to_owned(),
            wanted: wanted.to_owned(),
            found: self.node.describe(),
            at: self.at.clone(),
        }
        .into()
    }

    pub(super) fn text(&self, key: &str) -> Result<&str, FormatError> {
        match &self.node {
            TomlValue::Text(text) => Ok(text),
            _ => Err(self.wrong(key, "text in quotes")),
        }
    }

    pub(super) fn number(&self, key: &str) -> Result<f64, FormatError> {
        match self.node {
            TomlValue::Integer(i) => Ok(i as f64),
            TomlValue::Number(x) => Ok(x),
            _ => Err(self.wrong(key, "a number")),
        }
    }

    pub(super) fn list(&self, key: &str, wanted: &str) -> Result<&[Item], FormatError> {
        match &self.node {
            TomlValue::List(items) => Ok(items),
            _ => Err(self.wrong(key, wanted)),
        }
    }

    /// A list of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str, wanted: &str) -> Result<[f64; N], FormatError> {
        let items: &[Item; N] = self.list(key, wanted)?.try_into().map_err(|_| self.wrong(key, wanted))?;
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = item.number(key)?;
        }
        Ok(numbers)
    }
}

impl TomlValue {
    fn describe(&self) -> String {
        match self {
            TomlValue::Bool(b) => b.to_string(),
            TomlValue::Integer(i) => i.to_string(),
            TomlValue::Number(x) => x.to_string(),
            TomlValue::Text(text) => format!("\"{text}\""),
            TomlValue::List(items) => format!("a list of {}", items.len()),
            TomlValue::Table(_) => "a table".to_owned(),
        }
    }
}

//! Overlays: `base` names the scene that a file is based on, `[[change]]` changes its materials, lights and cameras.

use super::document::{Item, Table, TomlValue};
use super::include::Part as FilePart;
use super::plain::{missing, plain_value};
use super::reader::Native;
use super::words::{is_bare, number, quoted};
use crate::FORMATS;
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_import::tables::files::read_file;
use bilux_scene::change::{Change, Part, Which};
use bilux_scene::{Parameters, SceneBuilder, SceneError, Value};
use std::path::Path;

/// The keys of a file with a base.
pub(super) const KEYS: [&str; 3] = ["base", "render", "change"];

/// The maximum number of changes.
const MAX: usize = 10_000;

/// The scene that a file is based on, as if it were read itself.
pub(super) fn base(
    reading: &mut Reading,
    item: &Item,
    parts: &[FilePart],
) -> Result<SceneBuilder, FormatError> {
    let [part] = parts else {
        let message =
            "a file with a 'base' neither includes files nor is included: use include for all of them";
        return Err(SceneError::invalid(message, &item.at).into());
    };
    part.root.check_keys("a scene with a base", KEYS.into_iter())?;
    let name = item.text("base")?;
    let path = reading.locator.locate(part.folder.as_deref(), name, &item.at)?;
    if reading.open.contains(&path) {
        let message = format!("'{name}' is based on itself: name another file");
        return Err(FormatError::malformed(message, item.at.clone()));
    }
    let extension = Path::new(name).extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    let Some(row) = FORMATS.named(&extension).filter(|row| row.reads()) else {
        return Err(FORMATS.unknown(Path::new(name), "read", |row| row.reads()));
    };
    reading.enter(&path, &item.at)?;
    let shown = Path::new(&*item.at.file).with_file_name(name).display().to_string();
    let scene = read_file(FORMATS, Some(row), reading, &path, &shown.into())?;
    reading.leave();
    Ok(scene)
}

impl Native<'_, '_> {
    /// `[[change]]`: makes the changes of a part, in order.
    pub(super) fn change(&mut self, part: &FilePart) -> Result<(), FormatError> {
        let tables = part.root.tables("change")?;
        if let Some(table) = tables.get(MAX) {
            return Err(SceneError::invalid(format!("there are more than {MAX} changes"), &table.at).into());
        }
        for table in tables {
            let (what, which) = target(table)?;
            let keys = table.entries.iter().filter(|(key, ..)| key != what.name());
            let kind = self.kind_of(what, &which);
            for (key, at, item) in keys {
                let known = what.row(&kind).and_then(|row| row.parameters.iter().find(|p| p.name == key));
                let value = match &item.node {
                    TomlValue::Table(_) => self.value(key, known.map(|p| p.kind), item, part)?,
                    _ => Some(plain_value(key, item)?),
                };
                // The default of a missing texture applies.
                let Some(value) = value else { continue };
                let change =
                    Change { part: what, which: which.clone(), key: key.clone(), value, at: at.clone() };
                change.make(&mut self.scene)?;
            }
        }
        Ok(())
    }

    /// The kind of what is changed; empty if there is no such thing.
    fn kind_of(&self, part: Part, which: &Which) -> String {
        let all = part.all(&self.scene);
        let found = match which {
            Which::Number(number) => all.get(*number),
            Which::Name(name) => all.iter().find(|spec| spec.name == *name),
        };
        found.map(|spec| spec.kind.clone()).unwrap_or_default()
    }
}

/// The part of the scene that a table changes.
fn target(table: &Table) -> Result<(Part, Which), FormatError> {
    let named: Vec<(Part, &Item)> =
        Part::ALL.into_iter().filter_map(|part| Some((part, table.find(part.name())?))).collect();
    let [(part, item)] = named[..] else {
        return Err(missing("one of material, light or camera (what is changed)", table));
    };
    let which = match &item.node {
        TomlValue::Integer(number) if *number >= 0 => Which::Number(*number as usize),
        TomlValue::Text(name) => Which::Name(name.clone()),
        _ => return Err(item.wrong(part.name(), "a name, or a number from 0")),
    };
    Ok((part, which))
}

/// An overlay of a scene file in the same folder: its settings, and its changes in the order that they are made in.
/// Values that only files can hold, such as textures, are left out.
pub fn overlay(base: &str, settings: &Parameters, changes: &[Change]) -> String {
    let mut out = format!("base = {}\n", quoted(base));
    if !settings.0.is_empty() {
        out.push_str("\n[render]\n");
        settings.0.iter().for_each(|(key, value, _)| line(key, value, &mut out));
    }
    let mut last = None;
    for change in changes {
        let Change { part, which, key, value, .. } = change;
        if last != Some((part, which)) {
            let shown = match which {
                Which::Number(number) => number.to_string(),
                Which::Name(name) => quoted(name),
            };
            out.push_str(&format!("\n[[change]]\n{} = {shown}\n", part.name()));
            last = Some((part, which));
        }
        line(key, value, &mut out);
    }
    out
}

fn line(key: &str, value: &Value, out: &mut String) {
    if let Some(value) = text(value) {
        let key = if is_bare(key) { key.to_owned() } else { quoted(key) };
        out.push_str(&format!("{key} = {value}\n"));
    }
}

fn text(value: &Value) -> Option<String> {
    Some(match value {
        Value::Bool(yes) => yes.to_string(),
        Value::Integer(i) => i.to_string(),
        Value::Number(x) => number(*x),
        Value::Text(text) => quoted(text),
        Value::List(items) => {
            format!("[{}]", items.iter().map(text).collect::<Option<Vec<_>>>()?.join(", "))
        }
        Value::Texture(_) | Value::Material(_) | Value::Grid(_) | Value::Distribution(_) => return None,
    })
}

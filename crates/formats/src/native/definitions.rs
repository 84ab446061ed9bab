//! The parts that a JSON schema shares: its `$defs`, and the references to them.

use serde_json::{Map, Value, json};

/// The `$defs` of a schema, as they come to be while it is made.
///
/// Editors for TOML ignore what stands beside a `$ref`. So descriptions and defaults are inside of the part, where all
/// places share them, or in a schema around the reference, such as the `oneOf` that it is an alternative of.
#[derive(Default)]
pub(super) struct Definitions(Map<String, Value>);

impl Definitions {
    /// A reference to this part, which the schema has once under this name.
    pub(super) fn part(&mut self, name: &str, part: Value) -> Value {
        debug_assert!(self.0.get(name).is_none_or(|known| *known == part), "two parts are named {name}");
        self.0.insert(name.to_owned(), part);
        reference(name)
    }

    /// A number within these bounds.
    pub(super) fn number(&mut self, min: f64, max: f64) -> Value {
        let number = json!({ "type": "number", "minimum": min, "maximum": max });
        self.part(&format!("number-{}", bounds(min, max)), number)
    }

    /// Three numbers within these bounds.
    pub(super) fn colour(&mut self, min: f64, max: f64) -> Value {
        let three = json!({ "type": "array", "items": self.number(min, max), "minItems": 3, "maxItems": 3 });
        self.part(&format!("colour-{}", bounds(min, max)), three)
    }

    /// Shares properties that several of these tables have alike, each under a name such as `material-opacity`.
    /// Where there are several sorts of such a property, the first one has the name, and others stay in their tables.
    pub(super) fn share(&mut self, of: &str, tables: &mut [Value]) {
        let all: Vec<(String, Value)> = tables
            .iter()
            .filter_map(|table| table["properties"].as_object())
            .flat_map(|properties| properties.clone())
            .collect();
        let maps = tables.iter_mut().filter_map(|table| table["properties"].as_object_mut());
        for (key, value) in maps.flatten().filter(|(_, value)| value.get("$ref").is_none()) {
            let times = all.iter().filter(|(other, v)| other == key && v == value).count();
            let name = format!("{of}-{key}");
            if times > 1 && self.0.get(&name).is_none_or(|known| known == value) {
                *value = self.part(&name, value.take());
            }
        }
    }

    /// The `$defs`, in order of their names.
    pub(super) fn finish(mut self) -> Value {
        self.0.sort_keys();
        Value::Object(self.0)
    }
}

/// A reference to the part of this name, which may contain the reference.
pub(super) fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// Bounds as a part of a name, such as `0-to-1` and `minus-1-to-1e6`.
fn bounds(min: f64, max: f64) -> String {
    let word = |number: f64| {
        let [plain, power] = [format!("{number}"), format!("{number:e}")];
        let shorter = if power.len() < plain.len() { power } else { plain };
        shorter.strip_prefix('-').map_or_else(|| shorter.clone(), |size| format!("minus-{size}"))
    };
    format!("{}-to-{}", word(min), word(max))
}

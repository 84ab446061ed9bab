//! Values of scenes as the page reads them.

use serde_json::{Value, json};

/// A value for the page.
pub(super) fn value_json(value: &bilux::scene::Value) -> Value {
    use bilux::scene::Value as V;
    match value {
        V::Bool(yes) => json!(yes),
        V::Integer(i) => json!(i),
        V::Number(x) => json!(x),
        V::Text(text) => json!(text),
        V::List(list) => list.iter().map(value_json).collect(),
        V::Texture(_) => json!({ "texture": true }),
        V::Grid(grid) => json!({ "grid": grid.name() }),
        V::Distribution(distribution) => json!({ "distribution": distribution.name() }),
        V::Material(index) => json!({ "material": index }),
    }
}

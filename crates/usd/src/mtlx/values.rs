//! Values of inputs, by their types. [MaterialX: types]

use crate::layers::value::Value;

/// The value of a text; `None` if it is not one of this type.
pub(super) fn value(kind: &str, text: &str) -> Option<Value> {
    let numbers = || -> Option<Vec<f64>> {
        let words = text.split([',', ' ', '\t', '\n']).filter(|word| !word.is_empty());
        words.map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect()
    };
    match kind {
        "float" | "integer" => numbers()?.first().map(|x| Value::Number(*x)),
        "boolean" => Some(Value::Number(if text.trim() == "true" { 1.0 } else { 0.0 })),
        "color3" | "vector3" | "color4" | "vector4" | "vector2" | "color2" | "matrix33" | "matrix44" => {
            numbers().filter(|list| list.len() <= 16).map(Value::Tuple)
        }
        "filename" => Some(Value::Asset(text.into())),
        _ => Some(Value::Text(text.into())),
    }
}

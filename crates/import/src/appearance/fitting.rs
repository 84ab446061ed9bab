//! Fits the requested surface to what the renderer's materials support.

use crate::input::diagnostics::Diagnostics;
use bilux_math::Rgb;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_scene::{MATERIALS, Span, Spec, Value};

/// The one material that those of other programs map to.
const KIND: &str = "principled";

/// A material clamped to the ranges of its table row; warns about parameters that the row lacks.
pub fn fitted(draft: Spec, diagnostics: &mut Diagnostics) -> Spec {
    let row = MATERIALS.iter().find(|row| row.entry.name == KIND);
    let known = row.map_or(&[][..], |row| row.entry.parameters);
    let mut fitted = Spec { span: draft.span.clone(), ..Spec::new(&draft.name, KIND) };
    for (key, value, at) in draft.parameters.0 {
        let Some(parameter) = known.iter().find(|parameter| parameter.name == key) else {
            if !needs_no_warning(&key, &value) {
                let what = format!("{} of a material is not supported", key.replace('_', " "));
                diagnostics.note(&what, || at.clone());
            }
            continue;
        };
        if let Some(value) = within(parameter, value, &at, diagnostics) {
            fitted.parameters.set_at(&key, value, at);
        }
    }
    fitted
}

/// A value clamped to its range; `None`, with a warning, if a texture is not supported there.
fn within(parameter: &Parameter, value: Value, at: &Span, diagnostics: &mut Diagnostics) -> Option<Value> {
    let takes_pictures = matches!(
        parameter.kind,
        ParameterKind::ColourTexture { .. } | ParameterKind::NumberTexture { .. } | ParameterKind::Texture
    );
    let (min, max) = match parameter.kind {
        ParameterKind::Number { min, max }
        | ParameterKind::NumberTexture { min, max }
        | ParameterKind::Colour { min, max }
        | ParameterKind::ColourTexture { min, max } => (min, max),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let held = match &value {
        Value::Texture(_) if !takes_pictures => {
            let what = format!("{} from a texture is not supported", parameter.name.replace('_', " "));
            diagnostics.note(&what, || at.clone());
            return None;
        }
        Value::Number(x) => Value::Number(x.clamp(min, max)),
        Value::List(list) => Value::List(list.iter().map(|x| clamped(x, min, max)).collect()),
        _ => value.clone(),
    };
    if held != value {
        let what =
            format!("{} of a material is out of range: it is limited to {min} to {max}", parameter.name);
        diagnostics.note(&what, || at.clone());
    }
    Some(held)
}

fn clamped(value: &Value, min: f64, max: f64) -> Value {
    match value {
        Value::Number(x) => Value::Number(x.clamp(min, max)),
        other => other.clone(),
    }
}

/// True for values that can be dropped without a warning.
fn needs_no_warning(key: &str, value: &Value) -> bool {
    match key {
        "opacity" => *value == Value::from(1.0f32),
        "thin_walled" => *value == Value::Bool(false),
        "transmission_color" | "coat_color" => *value == Value::from(Rgb::WHITE),
        "coat_ior" => true,
        _ => false,
    }
}

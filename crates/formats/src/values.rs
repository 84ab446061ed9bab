//! What the parameters of a spec say, for writers.

use crate::writing::Writing;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{MATERIALS, Spec, Value};

/// A number, if one is given.
pub(crate) fn number(spec: &Spec, key: &str) -> Option<f32> {
    as_number(spec.parameters.find(key)?.0)
}

/// A colour, if one is given; white for a texture.
pub(crate) fn colour(spec: &Spec, key: &str) -> Option<Rgb> {
    match spec.parameters.find(key)?.0 {
        Value::List(list) => {
            let channel = |i: usize| list.get(i).and_then(as_number);
            Some(Rgb::new(channel(0)?, channel(1)?, channel(2)?))
        }
        Value::Texture(_) => Some(Rgb::WHITE),
        one => as_number(one).map(Rgb::grey),
    }
}

/// A point or a direction, if one is given.
pub(crate) fn vector(spec: &Spec, key: &str) -> Option<Vec3> {
    match spec.parameters.find(key)?.0 {
        Value::List(_) => colour(spec, key).map(|c| Vec3::from_array(c.to_array())),
        _ => None,
    }
}

/// The index of a texture, if one is given.
pub(crate) fn texture(spec: &Spec, key: &str) -> Option<usize> {
    match spec.parameters.find(key)?.0 {
        Value::Texture(index) => Some(*index),
        _ => None,
    }
}

/// What a format holds of a kind of materials: that, and its parameters.
pub(crate) type Held = (&'static str, &'static [&'static str]);

/// Tells of what a material says that a format cannot hold: neither of its kind nor of any.
pub(crate) fn tell_left_out(
    spec: &Spec,
    format: &str,
    held: &[Held],
    of_any: &[&str],
    writing: &mut Writing,
) {
    let Some((_, of_kind)) = held.iter().find(|(kind, _)| *kind == spec.kind) else { return };
    let Some(row) = MATERIALS.iter().find(|row| row.entry.name == spec.kind) else { return };
    for key in spec.differing(&row.entry).filter(|key| !of_kind.contains(key) && !of_any.contains(key)) {
        writing.warn(format!("{format} files hold no '{key}' of a {} material: left out", spec.kind));
    }
}

/// Tells of pictures of a material where a format holds none.
pub(crate) fn tell_pictures_left_out(spec: &Spec, format: &str, held: &[&str], writing: &mut Writing) {
    for (key, value, _) in &spec.parameters.0 {
        if matches!(value, Value::Texture(_)) && !held.contains(&key.as_str()) {
            writing.warn(format!("{format} files hold no picture of '{key}': left out"));
        }
    }
}

fn as_number(value: &Value) -> Option<f32> {
    match *value {
        Value::Integer(i) => Some(i as f32),
        Value::Number(x) => Some(x as f32),
        _ => None,
    }
}

//! What the parameters of a spec say, for writers.

use bilux_math::{Rgb, Vec3};
use bilux_scene::{Spec, Value};

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

fn as_number(value: &Value) -> Option<f32> {
    match *value {
        Value::Integer(i) => Some(i as f32),
        Value::Number(x) => Some(x as f32),
        _ => None,
    }
}

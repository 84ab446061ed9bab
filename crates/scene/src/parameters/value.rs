//! Values in scene files.

use crate::grid::Grid;
use crate::parameters::intensity_distribution::IntensityDistribution;
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

/// A value in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// Any other number.
    Number(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<Value>),
    /// An index into [`crate::SceneBuilder::textures`], with which readers replace a file name.
    Texture(usize),
    /// An index into [`crate::SceneBuilder::materials`], with which readers replace a material's name.
    Material(usize),
    /// A grid of numbers in space.
    Grid(Arc<Grid>),
    /// A measured luminous intensity distribution.
    Distribution(Arc<IntensityDistribution>),
}

impl Value {
    /// A colour or a point as a value.
    pub fn triple(v: [f32; 3]) -> Value {
        Value::List(v.map(|c| Value::Number(f64::from(c))).to_vec())
    }

    /// Scales the quantity for lengths that are all `scale` times as large; `unit` is that of its row (`m`, `W`).
    ///
    /// Texts and textures stay, as do zeros and negative numbers, which stand for none.
    pub fn scale_lengths(&mut self, unit: &str, scale: f64) {
        match unit {
            "m" => self.multiply(scale),
            "1/m" => self.multiply(1.0 / scale),
            // The same irradiance at so many times the distance.
            "W" | "W/sr" => self.multiply(scale * scale),
            _ => {}
        }
    }

    fn multiply(&mut self, factor: f64) {
        match self {
            Value::Integer(whole) if *whole > 0 => *self = Value::Number(*whole as f64 * factor),
            Value::Number(number) if *number > 0.0 => *number *= factor,
            Value::List(list) => list.iter_mut().for_each(|one| one.multiply(factor)),
            _ => {}
        }
    }

    pub(super) fn as_number(&self) -> Option<f64> {
        match *self {
            Value::Integer(i) => Some(i as f64),
            Value::Number(x) => Some(x),
            _ => None,
        }
    }
}

impl From<f32> for Value {
    fn from(x: f32) -> Value {
        Value::Number(f64::from(x))
    }
}
impl From<i32> for Value {
    fn from(i: i32) -> Value {
        Value::Integer(i64::from(i))
    }
}
impl From<bool> for Value {
    fn from(b: bool) -> Value {
        Value::Bool(b)
    }
}
impl From<Arc<Grid>> for Value {
    fn from(grid: Arc<Grid>) -> Value {
        Value::Grid(grid)
    }
}
impl From<&str> for Value {
    fn from(s: &str) -> Value {
        Value::Text(s.to_owned())
    }
}
impl From<String> for Value {
    fn from(s: String) -> Value {
        Value::Text(s)
    }
}
impl From<Rgb> for Value {
    fn from(c: Rgb) -> Value {
        Value::triple(c.to_array())
    }
}
impl From<Vec3> for Value {
    fn from(v: Vec3) -> Value {
        Value::triple(v.to_array())
    }
}

impl From<Arc<IntensityDistribution>> for Value {
    fn from(distribution: Arc<IntensityDistribution>) -> Value {
        Value::Distribution(distribution)
    }
}

/// A value as messages show it.
pub(super) fn describe(value: &Value) -> String {
    match value {
        Value::Bool(b) => b.to_string(),
        Value::Integer(i) => i.to_string(),
        // A whole number with a point is told apart from one without.
        Value::Number(x) => format!("{x:?}"),
        Value::Text(t) => format!("\"{t}\""),
        Value::List(list) => format!("[{}]", list.iter().map(describe).collect::<Vec<_>>().join(", ")),
        Value::Texture(_) => "a texture".to_owned(),
        Value::Material(_) => "a material".to_owned(),
        Value::Grid(_) => "a grid".to_owned(),
        Value::Distribution(_) => "an intensity distribution".to_owned(),
    }
}

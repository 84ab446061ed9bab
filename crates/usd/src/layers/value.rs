//! Values of attributes and metadata, from text and from crate files alike.

use crate::layers::list_op::ListOp;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use std::sync::Arc;

/// A name or a word that many specs share.
pub(crate) type Text = Arc<str>;

/// The value of an attribute or of a piece of metadata.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// There is no value, whatever weaker opinions say.
    Blocked,
    /// Of any type of number; 0 or 1 for a truth.
    Number(f64),
    /// A token or a string.
    Text(Text),
    /// The name of a file.
    Asset(Text),
    /// A vector; a quaternion as x, y, z, w; or a matrix, row by row.
    Tuple(Vec<f64>),
    /// Many numbers or tuples.
    Array(Arc<Array>),
    /// Many tokens, strings or names of files.
    Texts(Arc<[Text]>),
    Dictionary(Vec<(Text, Value)>),
    /// A list of tokens that changes a weaker one.
    Names(ListOp<Text>),
    /// A list of numbers that changes a weaker one.
    Integers(ListOp<i64>),
    /// A list of paths that changes a weaker one.
    Paths(ListOp<Text>),
    /// References or payloads.
    References(ListOp<Reference>),
    /// The chosen variants, by their sets.
    Selections(Vec<(Text, Text)>),
    /// Times of sublayers.
    Offsets(Vec<TimeOffset>),
    /// Values by time code.
    Samples(Arc<[(f64, Value)]>),
    /// A value that a crate file still holds.
    Packed(u64),
}

/// Reads values that were left in the bytes of their file.
pub(crate) trait Unpack {
    /// The value of [`Value::Packed`]; samples have packed values themselves. Charges the memory of the result.
    fn unpack(&self, packed: u64, budget: &mut Budget) -> Result<Value, FormatError>;
}

/// Numbers or tuples of numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array {
    pub(crate) numbers: Numbers,
    /// Numbers in a tuple.
    pub(crate) width: usize,
}

/// Numbers as compact as in the file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Numbers {
    Floats(Vec<f32>),
    Doubles(Vec<f64>),
    Integers(Vec<i32>),
}

/// A reference or a payload.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Reference {
    /// The file; empty for the same layers.
    pub(crate) asset: String,
    /// The prim; empty for the default one.
    pub(crate) path: String,
    pub(crate) offset: TimeOffset,
}

/// Maps the time codes of a layer to those of the layer that brings it in: `scale * t + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeOffset {
    pub(crate) offset: f64,
    pub(crate) scale: f64,
}

impl Default for TimeOffset {
    fn default() -> TimeOffset {
        TimeOffset { offset: 0.0, scale: 1.0 }
    }
}

impl TimeOffset {
    /// First `inner`, then this one.
    pub(crate) fn after(self, inner: TimeOffset) -> TimeOffset {
        TimeOffset { offset: self.scale * inner.offset + self.offset, scale: self.scale * inner.scale }
    }

    /// The time code there that becomes this one here.
    pub(crate) fn inverse(self, time: f64) -> f64 {
        if self.scale == 0.0 { time } else { (time - self.offset) / self.scale }
    }

    /// Without numbers that make no sense.
    pub(crate) fn sound(self) -> TimeOffset {
        let is_sound = self.offset.is_finite() && self.scale.is_finite() && self.scale != 0.0;
        if is_sound { self } else { TimeOffset::default() }
    }
}

impl Numbers {
    pub(crate) fn len(&self) -> usize {
        match self {
            Numbers::Floats(list) => list.len(),
            Numbers::Doubles(list) => list.len(),
            Numbers::Integers(list) => list.len(),
        }
    }

    #[inline]
    pub(crate) fn at(&self, i: usize) -> f64 {
        match self {
            Numbers::Floats(list) => f64::from(list[i]),
            Numbers::Doubles(list) => list[i],
            Numbers::Integers(list) => f64::from(list[i]),
        }
    }

    /// The size of its memory.
    pub(crate) fn bytes(&self) -> u64 {
        let each = if matches!(self, Numbers::Doubles(_)) { 8 } else { 4 };
        each * self.len() as u64
    }
}

impl Array {
    /// The number of tuples.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len() / self.width.max(1)
    }

    /// The numbers of a tuple; zeros where it has fewer.
    #[inline]
    pub(crate) fn tuple<const N: usize>(&self, i: usize) -> [f64; N] {
        let first = i * self.width;
        std::array::from_fn(|k| if k < self.width { self.numbers.at(first + k) } else { 0.0 })
    }

    /// Numbers of a tuple with 32 bits; zeros where it has fewer.
    #[inline]
    pub(crate) fn floats<const N: usize>(&self, i: usize) -> [f32; N] {
        match &self.numbers {
            Numbers::Floats(list) if self.width == N => std::array::from_fn(|k| list[i * N + k]),
            _ => self.tuple::<N>(i).map(|x| x as f32),
        }
    }
}

impl Value {
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Value::Number(x) => Some(*x),
            Value::Tuple(list) if list.len() == 1 => list.first().copied(),
            _ => None,
        }
    }

    pub(crate) fn text(&self) -> Option<&Text> {
        match self {
            Value::Text(text) | Value::Asset(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) fn tuple<const N: usize>(&self) -> Option<[f64; N]> {
        match self {
            Value::Tuple(list) => list.as_slice().try_into().ok(),
            _ => None,
        }
    }

    /// One or several numbers, as a list.
    pub(crate) fn array(&self) -> Option<Arc<Array>> {
        match self {
            Value::Array(array) => Some(array.clone()),
            Value::Number(x) => Some(Arc::new(Array { numbers: Numbers::Doubles(vec![*x]), width: 1 })),
            Value::Tuple(list) => {
                Some(Arc::new(Array { width: list.len(), numbers: Numbers::Doubles(list.clone()) }))
            }
            _ => None,
        }
    }

    pub(crate) fn texts(&self) -> Option<Arc<[Text]>> {
        match self {
            Value::Texts(list) => Some(list.clone()),
            // An empty list in a text does not say what it is of.
            Value::Array(array) if array.len() == 0 => Some(Arc::from([])),
            _ => None,
        }
    }
}

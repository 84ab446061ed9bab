//! Values: in eight bytes, or at an offset that these state.

use super::bytes::Bytes;
use super::integers::{integers, long_integers};
use super::sections::Crate;
use super::types::{Kind, Stored};
use crate::layers::list_op::ListOp;
use crate::layers::value::{Array, Numbers, Reference, Text, TimeOffset, Unpack, Value};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use half::f16;
use std::sync::Arc;

const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_COMPRESSED: u64 = 1 << 61;
const PAYLOAD: u64 = (1 << 48) - 1;
/// Shorter arrays are not compressed, whatever the value says.
const LEAST_COMPRESSED: usize = 16;
/// Values may hold values.
const MAX_NESTED: usize = 16;

impl Unpack for Crate<'_> {
    fn unpack(&self, packed: u64, budget: &mut Budget) -> Result<Value, FormatError> {
        self.value(packed, budget, 0)
    }
}

impl Crate<'_> {
    fn at(&self, offset: u64) -> Result<Bytes<'_>, FormatError> {
        Bytes { all: &self.bytes, at: 0, name: &self.name }.moved(offset)
    }

    pub(super) fn token(&self, index: u32) -> Text {
        self.tokens.get(index as usize).cloned().unwrap_or_default()
    }

    fn string(&self, index: u32) -> Text {
        self.strings.get(index as usize).map_or_else(Text::default, |token| self.token(*token))
    }

    fn path(&self, index: u32) -> Text {
        self.paths.text(index, &self.tokens).unwrap_or_default()
    }

    /// True for values that are read with their spec, since they take few bytes or composition needs them.
    pub(super) fn is_small(value: u64) -> bool {
        let samples = Kind::of((value >> 48) as u8) == Kind::Samples;
        value & IS_ARRAY == 0 && !samples
    }

    pub(super) fn value(&self, value: u64, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
        let number = (value >> 48) as u8;
        let (kind, payload) = (Kind::of(number), value & PAYLOAD);
        if depth > MAX_NESTED {
            return Err(self.at(0)?.error("values are nested too deeply"));
        }
        if value & IS_ARRAY != 0 {
            return self.array(kind, payload, value & IS_COMPRESSED != 0, budget);
        }
        if value & IS_INLINED != 0 {
            return Ok(self.inlined(kind, number, payload as u32));
        }
        let mut bytes = self.at(payload)?;
        self.elsewhere(kind, &mut bytes, budget, depth)
    }

    fn inlined(&self, kind: Kind, number: u8, bits: u32) -> Value {
        let small = |i: usize| f64::from(bits.to_le_bytes()[i] as i8);
        if let Some(side) = Kind::side_of_matrix(number) {
            let at = |i: usize| if i % side == i / side { small(i / side) } else { 0.0 };
            return Value::Tuple((0..side * side).map(at).collect());
        }
        match kind {
            Kind::Numbers(Stored::Half, 1) => Value::Number(f16::from_bits(bits as u16).to_f64()),
            Kind::Numbers(Stored::Half, 2) => {
                let half = |bits: u32| f16::from_bits(bits as u16).to_f64();
                Value::Tuple(vec![half(bits), half(bits >> 16)])
            }
            Kind::Numbers(Stored::Float | Stored::Double, 1) => {
                Value::Number(f64::from(f32::from_bits(bits)))
            }
            Kind::Numbers(Stored::U32 | Stored::U64, 1) => Value::Number(f64::from(bits)),
            Kind::Numbers(Stored::Bool | Stored::U8, 1) => Value::Number(f64::from(bits as u8)),
            Kind::Numbers(_, 1) => Value::Number(f64::from(bits as i32)),
            Kind::Numbers(_, width) => Value::Tuple((0..width.min(4)).map(small).collect()),
            Kind::Token => Value::Text(self.token(bits)),
            Kind::String => Value::Text(self.string(bits)),
            Kind::Asset => Value::Asset(self.token(bits)),
            Kind::Word => Value::Number(f64::from(bits)),
            Kind::Dictionary => Value::Dictionary(Vec::new()),
            _ => Value::Blocked,
        }
    }

    fn elsewhere(
        &self,
        kind: Kind,
        bytes: &mut Bytes,
        budget: &mut Budget,
        depth: usize,
    ) -> Result<Value, FormatError> {
        Ok(match kind {
            Kind::Numbers(stored, width) => {
                let list = numbers(bytes, stored, width)?;
                let mut tuple: Vec<f64> = (0..width).map(|i| list.at(i)).collect();
                if width == 1 { Value::Number(tuple.remove(0)) } else { Value::Tuple(tuple) }
            }
            Kind::String => Value::Text(self.string(bytes.u32()?)),
            Kind::Token => Value::Text(self.token(bytes.u32()?)),
            Kind::Asset => Value::Asset(self.token(bytes.u32()?)),
            Kind::Dictionary => self.dictionary(bytes, budget, depth)?,
            Kind::TokenListOp => Value::Names(list_op(bytes, 4, |b| Ok(self.token(b.u32()?)), budget)?),
            Kind::StringListOp => Value::Names(list_op(bytes, 4, |b| Ok(self.string(b.u32()?)), budget)?),
            Kind::IntegerListOp => Value::Integers(list_op(bytes, 8, |b| Ok(b.u64()? as i64), budget)?),
            Kind::PathListOp => Value::Paths(list_op(bytes, 4, |b| Ok(self.path(b.u32()?)), budget)?),
            Kind::ReferenceListOp => {
                let reference = |b: &mut Bytes, budget: &mut Budget| {
                    let reference = self.reference(b, true)?;
                    self.dictionary(b, budget, depth + 1)?;
                    Ok(reference)
                };
                Value::References(list_op_with(bytes, 32, reference, budget)?)
            }
            Kind::PayloadListOp => {
                Value::References(list_op(bytes, 8, |b| self.reference(b, self.version >= 8), budget)?)
            }
            Kind::Payload => {
                let payload = self.reference(bytes, self.version >= 8)?;
                Value::References(ListOp::explicit(vec![payload]))
            }
            Kind::PathVector => {
                Value::Paths(ListOp::explicit(items(bytes, 4, |b| Ok(self.path(b.u32()?)), budget)?))
            }
            Kind::TokenVector => Value::Texts(items(bytes, 4, |b| Ok(self.token(b.u32()?)), budget)?.into()),
            Kind::StringVector => {
                Value::Texts(items(bytes, 4, |b| Ok(self.string(b.u32()?)), budget)?.into())
            }
            Kind::Selections => Value::Selections(items(
                bytes,
                8,
                |b| Ok((self.string(b.u32()?), self.string(b.u32()?))),
                budget,
            )?),
            Kind::Doubles => {
                let list = items(bytes, 8, |b| b.f64(), budget)?;
                Value::Array(Arc::new(Array { numbers: Numbers::Doubles(list), width: 1 }))
            }
            Kind::Offsets => Value::Offsets(items(bytes, 16, |b| offset(b), budget)?),
            Kind::Samples => self.samples(bytes, budget, depth)?,
            Kind::Nested => {
                let nested = nested(bytes)?;
                self.value(nested, budget, depth + 1)?
            }
            Kind::Word | Kind::Blocked | Kind::Other => Value::Blocked,
        })
    }

    fn reference(&self, bytes: &mut Bytes, has_offset: bool) -> Result<Reference, FormatError> {
        let asset = self.string(bytes.u32()?).to_string();
        let path = bytes.u32()?;
        let path = if path == 0 { String::new() } else { self.path(path).to_string() };
        let offset = if has_offset { offset(bytes)? } else { TimeOffset::default() };
        Ok(Reference { asset, path: if path == "/" { String::new() } else { path }, offset })
    }

    fn dictionary(&self, bytes: &mut Bytes, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
        let count = bytes.count(20)?;
        budget.take_bytes((count * size_of::<[(Text, Value); 2]>()) as u64, bytes.name)?;
        let mut entries = Vec::with_capacity(count);
        for _ in 0..count {
            let key = self.string(bytes.u32()?);
            let value = nested(bytes)?;
            // Dictionaries have remarks of programs, which are not worth an error.
            let value = if Crate::is_small(value) {
                self.value(value, budget, depth + 1)?
            } else {
                Value::Packed(value)
            };
            entries.push((key, value));
        }
        Ok(Value::Dictionary(entries))
    }

    fn samples(&self, bytes: &mut Bytes, budget: &mut Budget, depth: usize) -> Result<Value, FormatError> {
        let times = nested(bytes)?;
        let Value::Array(times) = self.value(times, budget, depth + 1)? else {
            return Err(bytes.error("the times of samples are not numbers"));
        };
        let offset = bytes.clone().u64()? as i64;
        bytes.skip(offset)?;
        let count = bytes.count(8)?.min(times.len());
        budget.take_bytes((count * size_of::<(f64, Value)>()) as u64, bytes.name)?;
        let mut all = Vec::with_capacity(count);
        for i in 0..count {
            all.push((times.numbers.at(i), Value::Packed(bytes.u64()?)));
        }
        Ok(Value::Samples(all.into()))
    }

    fn array(
        &self,
        kind: Kind,
        offset: u64,
        compressed: bool,
        budget: &mut Budget,
    ) -> Result<Value, FormatError> {
        let texts = |list: Vec<Text>| Ok(Value::Texts(list.into()));
        let width = if let Kind::Numbers(_, width) = kind { width } else { 1 };
        if offset == 0 {
            return match kind {
                Kind::Numbers(..) => Ok(empty(width)),
                _ => texts(Vec::new()),
            };
        }
        let mut bytes = self.at(offset)?;
        if self.version < 5 {
            // A number of dimensions, always 1.
            bytes.u32()?;
        }
        let count = if self.version < 7 { u64::from(bytes.u32()?) } else { bytes.u64()? };
        match kind {
            Kind::Numbers(stored, width) => {
                let is_short = count < LEAST_COMPRESSED as u64;
                let numbers = if compressed && self.version >= 5 && width == 1 && !is_short {
                    compressed_numbers(&mut bytes, stored, count, budget)?
                } else {
                    let count = bytes.check_count(count, stored.bytes() * width as u64)?;
                    let each =
                        if matches!(stored, Stored::Double | Stored::I64 | Stored::U64) { 8 } else { 4 };
                    budget.take_bytes((count * width) as u64 * each, bytes.name)?;
                    numbers(&mut bytes, stored, count * width)?
                };
                Ok(Value::Array(Arc::new(Array { numbers, width })))
            }
            Kind::String | Kind::Token | Kind::Asset => {
                let count = bytes.check_count(count, 4)?;
                budget.take_bytes((count * size_of::<Text>()) as u64, bytes.name)?;
                let text =
                    |index: u32| if kind == Kind::String { self.string(index) } else { self.token(index) };
                let list: Result<Vec<Text>, FormatError> =
                    (0..count).map(|_| Ok(text(bytes.u32()?))).collect();
                texts(list?)
            }
            _ => Ok(Value::Blocked),
        }
    }
}

fn empty(width: usize) -> Value {
    Value::Array(Arc::new(Array { numbers: Numbers::Floats(Vec::new()), width }))
}

/// A value whose place is stated relative to here; what follows comes after it.
fn nested(bytes: &mut Bytes) -> Result<u64, FormatError> {
    let offset = bytes.clone().u64()? as i64;
    bytes.skip(offset)?;
    bytes.u64()
}

fn offset(bytes: &mut Bytes) -> Result<TimeOffset, FormatError> {
    Ok(TimeOffset { offset: bytes.f64()?, scale: bytes.f64()? }.sound())
}

fn items<'b, T>(
    bytes: &mut Bytes<'b>,
    each: u64,
    mut item: impl FnMut(&mut Bytes<'b>) -> Result<T, FormatError>,
    budget: &mut Budget,
) -> Result<Vec<T>, FormatError> {
    let count = bytes.count(each)?;
    budget.take_bytes((count * size_of::<T>()) as u64, bytes.name)?;
    (0..count).map(|_| item(bytes)).collect()
}

fn list_op<'b, T>(
    bytes: &mut Bytes<'b>,
    each: u64,
    item: impl Fn(&mut Bytes<'b>) -> Result<T, FormatError>,
    budget: &mut Budget,
) -> Result<ListOp<T>, FormatError> {
    list_op_with(bytes, each, |bytes, _| item(bytes), budget)
}

/// Lists that the bits of the first byte announce.
fn list_op_with<'b, T>(
    bytes: &mut Bytes<'b>,
    each: u64,
    item: impl Fn(&mut Bytes<'b>, &mut Budget) -> Result<T, FormatError>,
    budget: &mut Budget,
) -> Result<ListOp<T>, FormatError> {
    let bits = bytes.u8()?;
    let mut list = |bit: u32| -> Result<Vec<T>, FormatError> {
        if bits >> bit & 1 == 0 {
            return Ok(Vec::new());
        }
        let count = bytes.count(each)?;
        budget.take_bytes((count * size_of::<T>()) as u64, bytes.name)?;
        (0..count).map(|_| item(bytes, budget)).collect()
    };
    let explicit = list(1)?;
    let added = list(2)?;
    let prepended = list(5)?;
    let mut appended = list(6)?;
    let deleted = list(3)?;
    appended.extend(added);
    let explicit = (bits & 1 != 0).then_some(explicit);
    Ok(ListOp { explicit, prepended, appended, deleted })
}

/// Numbers as they are.
fn numbers(bytes: &mut Bytes, stored: Stored, count: usize) -> Result<Numbers, FormatError> {
    let raw = bytes.take(count as u64 * stored.bytes())?;
    let integers = |of: fn(u32) -> i32| {
        Numbers::Integers(raw.as_chunks::<4>().0.iter().map(|b| of(u32::from_le_bytes(*b))).collect())
    };
    Ok(match stored {
        Stored::Float => {
            Numbers::Floats(raw.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect())
        }
        Stored::Half => {
            let of = |b: &[u8; 2]| f16::from_le_bytes(*b).to_f32();
            Numbers::Floats(raw.as_chunks::<2>().0.iter().map(of).collect())
        }
        Stored::Double => {
            Numbers::Doubles(raw.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect())
        }
        Stored::I64 => {
            Numbers::Doubles(raw.as_chunks::<8>().0.iter().map(|b| i64::from_le_bytes(*b) as f64).collect())
        }
        Stored::U64 => {
            Numbers::Doubles(raw.as_chunks::<8>().0.iter().map(|b| u64::from_le_bytes(*b) as f64).collect())
        }
        Stored::I32 => integers(|x| x as i32),
        Stored::U32 => integers(|x| i32::try_from(x).unwrap_or(i32::MAX)),
        Stored::Bool | Stored::U8 => Numbers::Integers(raw.iter().map(|b| i32::from(*b)).collect()),
    })
}

/// Integers as differences; floats as integers, or as indices into a table.
fn compressed_numbers(
    bytes: &mut Bytes,
    stored: Stored,
    count: u64,
    budget: &mut Budget,
) -> Result<Numbers, FormatError> {
    if count / 1024 > bytes.all.len() as u64 {
        return Err(bytes.error("it states more numbers than it has bytes for"));
    }
    let count = count as usize;
    if stored.is_integer() {
        return Ok(match stored {
            Stored::I64 | Stored::U64 => {
                let list = long_integers(bytes, count, budget)?;
                Numbers::Doubles(list.into_iter().map(|x| x as f64).collect())
            }
            _ => Numbers::Integers(integers(bytes, count, budget)?),
        });
    }
    let list = match bytes.u8()? {
        b'i' => {
            let list = integers(bytes, count, budget)?;
            Numbers::Integers(list)
        }
        b't' => {
            let size = u64::from(bytes.u32()?);
            let size = bytes.check_count(size, stored.bytes())?;
            let table = numbers(bytes, stored, size)?;
            let indices = integers(bytes, count, budget)?;
            if indices.iter().any(|i| *i as u32 as usize >= size) {
                return Err(bytes.error("a number is not in its table"));
            }
            budget.take_bytes(8 * count as u64, bytes.name)?;
            Numbers::Doubles(indices.into_iter().map(|i| table.at(i as u32 as usize)).collect())
        }
        _ => return Err(bytes.error("numbers are compressed in an unknown way")),
    };
    let as_floats = |list: &Numbers| (0..list.len()).map(|i| list.at(i) as f32).collect();
    Ok(match stored {
        Stored::Double => Numbers::Doubles((0..list.len()).map(|i| list.at(i)).collect()),
        _ => Numbers::Floats(as_floats(&list)),
    })
}

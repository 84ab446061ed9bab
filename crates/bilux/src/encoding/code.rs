//! Conversion of values to bytes and back: numbers with the lowest byte first, and lists after their length.

use super::error::EncodingError;
use super::tables::{ReadTables, WrittenTables};

/// A value that can be encoded.
pub(super) trait Coded: Sized {
    /// Appends its bytes.
    fn write(&self, to: &mut Encoder);
    /// Reads it back.
    ///
    /// # Errors
    /// If the bytes are no such value.
    fn read(from: &mut Decoder) -> Result<Self, EncodingError>;
}

/// Writes values.
#[derive(Default)]
pub(super) struct Encoder {
    pub(super) bytes: Vec<u8>,
    /// Tables of the values that are referred to by number.
    pub(super) tables: WrittenTables,
    /// Leaves out what changes no picture: names, and places in files.
    pub(super) only_what_is_seen: bool,
}

impl Encoder {
    /// A name for people.
    pub(super) fn name(&mut self, name: &String) {
        if !self.only_what_is_seen {
            name.write(self);
        }
    }
}

/// Maximum depth of lists in lists, and of scenes in scenes. Scene files do not go as far.
const MAX_DEPTH: u32 = 200;

/// Reads values.
pub(super) struct Decoder<'a> {
    bytes: &'a [u8],
    at: usize,
    depth: u32,
    pub(super) tables: ReadTables,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Decoder<'a> {
        Decoder { bytes, at: 0, depth: 0, tables: ReadTables::default() }
    }

    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], EncodingError> {
        if count > self.left() {
            return Err(self.wrong(format!("{count} bytes are needed, but only {} are left", self.left())));
        }
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(taken)
    }

    /// A number of items, each of which takes at least `bytes` bytes.
    pub(super) fn count(&mut self, bytes: usize) -> Result<usize, EncodingError> {
        let count = u64::read(self)?;
        let most = self.left() / bytes.max(1);
        match usize::try_from(count).ok().filter(|count| *count <= most) {
            Some(count) => Ok(count),
            None => Err(self.wrong(format!("{count} items, but there is room for at most {most}"))),
        }
    }

    /// An index below `count`.
    pub(super) fn index(&mut self, what: &str, count: usize) -> Result<usize, EncodingError> {
        let index = usize::read(self)?;
        if index < count {
            return Ok(index);
        }
        Err(self.wrong(format!("{what} {index}, but there are only {count}")))
    }

    /// Reads something that may contain more of its kind.
    pub(super) fn nested<T>(
        &mut self,
        read: impl FnOnce(&mut Decoder<'a>) -> Result<T, EncodingError>,
    ) -> Result<T, EncodingError> {
        if self.depth == MAX_DEPTH {
            return Err(self.wrong(format!("more than {MAX_DEPTH} lists within each other")));
        }
        self.depth += 1;
        let value = read(self)?;
        self.depth -= 1;
        Ok(value)
    }

    /// The error that something here is wrong.
    pub(super) fn wrong(&self, what: impl Into<String>) -> EncodingError {
        EncodingError::Damaged { what: what.into(), at: self.at }
    }
}

/// Implements [`Coded`] for numbers.
macro_rules! numbers {
    ($($number:ty),*) => {$(
        impl Coded for $number {
            fn write(&self, to: &mut Encoder) {
                to.bytes.extend_from_slice(&self.to_le_bytes());
            }
            fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
                let bytes = from.take(size_of::<$number>())?;
                Ok(<$number>::from_le_bytes(bytes.try_into().map_err(|_| from.wrong("no number"))?))
            }
        }
    )*};
}
numbers!(u8, u32, u64, i64, f32, f64);

/// Implements [`Coded`] for structs, field by field.
macro_rules! fields {
    ($($type:ty { $($field:ident),* $(,)? })*) => {$(
        impl Coded for $type {
            fn write(&self, to: &mut Encoder) {
                let Self { $($field),* } = self;
                $($field.write(to);)*
            }
            fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
                Ok(Self { $($field: Coded::read(from)?),* })
            }
        }
    )*};
}
pub(super) use fields;

/// Implements [`Coded`] for enums without fields, by number.
macro_rules! words {
    ($($type:ty [ $($word:expr),* $(,)? ])*) => {$(
        impl Coded for $type {
            fn write(&self, to: &mut Encoder) {
                let known = [$($word),*];
                (known.iter().position(|word| word == self).unwrap_or(known.len()) as u8).write(to);
            }
            fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
                let at = usize::from(u8::read(from)?);
                [$($word),*].get(at).copied().ok_or_else(|| from.wrong(concat!("no such ", stringify!($type))))
            }
        }
    )*};
}
pub(super) use words;

words! { bool [false, true] }

impl Coded for usize {
    fn write(&self, to: &mut Encoder) {
        (*self as u64).write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let number = u64::read(from)?;
        usize::try_from(number).map_err(|_| from.wrong("a number too large for this machine"))
    }
}

impl Coded for String {
    fn write(&self, to: &mut Encoder) {
        self.len().write(to);
        to.bytes.extend_from_slice(self.as_bytes());
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let count = from.count(1)?;
        let text =
            std::str::from_utf8(from.take(count)?).map_err(|_| from.wrong("text that is not UTF-8"))?;
        Ok(text.to_owned())
    }
}

impl<T: Coded> Coded for Vec<T> {
    fn write(&self, to: &mut Encoder) {
        self.len().write(to);
        self.iter().for_each(|item| item.write(to));
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        // Grows as items are read, so that it takes no more memory than the bytes justify.
        let count = from.count(1)?;
        let mut items = Vec::new();
        for _ in 0..count {
            items.push(T::read(from)?);
        }
        Ok(items)
    }
}

impl<T: Coded> Coded for Option<T> {
    fn write(&self, to: &mut Encoder) {
        self.is_some().write(to);
        self.iter().for_each(|item| item.write(to));
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok(if bool::read(from)? { Some(T::read(from)?) } else { None })
    }
}

impl<T: Coded + Copy + Default, const N: usize> Coded for [T; N] {
    fn write(&self, to: &mut Encoder) {
        self.iter().for_each(|item| item.write(to));
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        let mut items = [T::default(); N];
        for item in &mut items {
            *item = T::read(from)?;
        }
        Ok(items)
    }
}

impl<A: Coded, B: Coded> Coded for (A, B) {
    fn write(&self, to: &mut Encoder) {
        self.0.write(to);
        self.1.write(to);
    }
    fn read(from: &mut Decoder) -> Result<Self, EncodingError> {
        Ok((A::read(from)?, B::read(from)?))
    }
}

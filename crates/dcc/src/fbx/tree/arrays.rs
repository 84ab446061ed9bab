//! Arrays of numbers in binary files, packed by zlib or not.

use flate2::read::ZlibDecoder;
use std::io::Read;

/// A type of number that the numbers of an array become.
pub(in crate::fbx) trait Number: Copy {
    /// From a number of the file; the conversion to integers saturates.
    fn of(number: f64) -> Self;
    /// From an integer of the file; the conversion to integers saturates.
    fn of_integer(integer: i64) -> Self;
    /// True for the same bits.
    fn is(self, other: Self) -> bool;
}

macro_rules! numbers {
    ($($kind:ty)*) => {$(
        impl Number for $kind {
            #[inline]
            fn of(number: f64) -> $kind {
                number as $kind
            }
            #[inline]
            fn of_integer(integer: i64) -> $kind {
                integer as $kind
            }
            #[inline]
            fn is(self, other: $kind) -> bool {
                self.to_ne_bytes() == other.to_ne_bytes()
            }
        }
    )*};
}
numbers!(f32 f64 i64);

impl Number for i32 {
    #[inline]
    fn of(number: f64) -> i32 {
        number as i32
    }
    #[inline]
    fn of_integer(integer: i64) -> i32 {
        integer.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }
    #[inline]
    fn is(self, other: i32) -> bool {
        self == other
    }
}

/// The type of the elements in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Elements {
    Float,
    Double,
    Long,
    Int,
    Byte,
}

impl Elements {
    /// The type that a letter stands for.
    pub(super) fn named(letter: u8) -> Option<Elements> {
        Some(match letter {
            b'f' => Elements::Float,
            b'd' => Elements::Double,
            b'l' => Elements::Long,
            b'i' => Elements::Int,
            b'b' | b'c' => Elements::Byte,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Elements::Double | Elements::Long => 8,
            Elements::Float | Elements::Int => 4,
            Elements::Byte => 1,
        }
    }
}

/// An array as the file has it.
#[derive(Clone, Copy, Debug)]
pub(in crate::fbx) struct PackedArray<'a> {
    pub(super) elements: Elements,
    /// As many as the file says.
    pub(super) count: u32,
    pub(super) is_packed: bool,
    pub(super) is_big_endian: bool,
    pub(super) bytes: &'a [u8],
}

/// No byte of zlib's stands for more bytes than this: a code of two bits for 258 of them.
const LARGEST_RATIO: u64 = 1032;

/// Bytes that are unpacked at a time; whole tuples of up to four elements, whatever their size.
const CHUNK: usize = 96 * 340;

impl PackedArray<'_> {
    /// Number of elements, unless the bytes cannot hold so many.
    pub(super) fn count(&self) -> Result<usize, String> {
        let most = if self.is_packed {
            LARGEST_RATIO * (1 + self.bytes.len() as u64)
        } else {
            self.bytes.len() as u64
        };
        if u64::from(self.count) * self.elements.size() as u64 > most {
            let (count, bytes) = (self.count, self.bytes.len());
            return Err(format!("{count} numbers are stated, which these {bytes} bytes cannot hold"));
        }
        Ok(self.count as usize)
    }

    /// Passes on its numbers, some thousands at a time: whole tuples, but for the last.
    pub(super) fn each<T: Number>(&self, mut take: impl FnMut(&[T])) -> Result<(), String> {
        let mut left = self.count()? * self.elements.size();
        let mut numbers = Vec::with_capacity(CHUNK / self.elements.size());
        if !self.is_packed {
            for part in self.bytes.chunks(CHUNK) {
                numbers.clear();
                self.append(part, &mut numbers);
                take(&numbers);
            }
            return Ok(());
        }
        let mut stream = ZlibDecoder::new(self.bytes);
        let mut chunk = [0u8; CHUNK];
        while left > 0 {
            let part = &mut chunk[..left.min(CHUNK)];
            let damaged = |_| {
                format!("the packed numbers are damaged, or fewer than the {} that are stated", self.count)
            };
            stream.read_exact(part).map_err(damaged)?;
            left -= part.len();
            numbers.clear();
            self.append(part, &mut numbers);
            take(&numbers);
        }
        Ok(())
    }

    fn append<T: Number>(&self, bytes: &[u8], to: &mut Vec<T>) {
        fn each<T, const N: usize>(bytes: &[u8], is_big: bool, to: &mut Vec<T>, of: impl Fn([u8; N]) -> T) {
            to.extend(bytes.as_chunks::<N>().0.iter().map(|&(mut element)| {
                if is_big {
                    element.reverse();
                }
                of(element)
            }));
        }
        let big = self.is_big_endian;
        match self.elements {
            Elements::Float => each(bytes, big, to, |b| T::of(f64::from(f32::from_le_bytes(b)))),
            Elements::Double => each(bytes, big, to, |b| T::of(f64::from_le_bytes(b))),
            Elements::Long => each(bytes, big, to, |b| T::of_integer(i64::from_le_bytes(b))),
            Elements::Int => each(bytes, big, to, |b| T::of_integer(i64::from(i32::from_le_bytes(b)))),
            Elements::Byte => each(bytes, big, to, |b| T::of_integer(i64::from(i8::from_le_bytes(b)))),
        }
    }
}

//! The values of Part 21, and reading them as numbers, lists and references.

use super::strings;

/// A piece of the file's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(super) start: u32,
    pub(super) length: u32,
}

impl Piece {
    pub(super) fn of(self, bytes: &[u8]) -> &[u8] {
        let start = self.start as usize;
        bytes.get(start..start + self.length as usize).unwrap_or_default()
    }
}

/// A value; those of lists lie next to each other in [`super::Table::values`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value {
    /// `$`, `*`, or binary data, which no geometry has.
    Missing,
    Number(f64),
    /// A text between apostrophes, as it stands in the file.
    Text(Piece),
    /// An enumeration, without its dots.
    Name(Piece),
    /// The number of an instance.
    Reference(u64),
    List {
        first: u32,
        count: u32,
    },
    /// A value with the name of its type in front: the name is left out.
    Typed(u32),
}

/// Values in a row: the parameters of a record, or a list.
#[derive(Clone, Copy)]
pub(crate) struct Values<'a> {
    pub(super) bytes: &'a [u8],
    /// All values of the file.
    pub(super) all: &'a [Value],
    pub(super) first: u32,
    pub(super) count: u32,
}

impl<'a> Values<'a> {
    pub(crate) fn len(self) -> usize {
        self.count as usize
    }

    fn at(self, index: usize) -> Value {
        if index >= self.len() {
            return Value::Missing;
        }
        let mut value = self.all.get(self.first as usize + index).copied().unwrap_or(Value::Missing);
        // Types within types end soon: each is deeper in the file, and depth is bounded there.
        while let Value::Typed(inner) = value {
            value = self.all.get(inner as usize).copied().unwrap_or(Value::Missing);
        }
        value
    }

    /// A number that is finite.
    pub(crate) fn number(self, index: usize) -> Option<f64> {
        match self.at(index) {
            Value::Number(number) if number.is_finite() => Some(number),
            _ => None,
        }
    }

    /// A whole number that is not negative.
    pub(crate) fn count_at(self, index: usize) -> Option<usize> {
        let number = self.number(index)?;
        (number >= 0.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0).then_some(number as usize)
    }

    pub(crate) fn reference(self, index: usize) -> Option<u64> {
        match self.at(index) {
            Value::Reference(id) => Some(id),
            _ => None,
        }
    }

    /// An enumeration, such as `MILLI` for `.MILLI.`.
    pub(crate) fn name(self, index: usize) -> Option<&'a [u8]> {
        match self.at(index) {
            Value::Name(piece) => Some(piece.of(self.bytes)),
            _ => None,
        }
    }

    /// True for `.T.`, false for `.F.`.
    pub(crate) fn flag(self, index: usize) -> Option<bool> {
        match self.name(index)? {
            b"T" => Some(true),
            b"F" => Some(false),
            _ => None,
        }
    }

    /// A text, decoded; empty if there is none.
    pub(crate) fn text(self, index: usize) -> String {
        match self.at(index) {
            Value::Text(piece) => strings::decoded(piece.of(self.bytes)),
            _ => String::new(),
        }
    }

    pub(crate) fn list(self, index: usize) -> Option<Values<'a>> {
        match self.at(index) {
            Value::List { first, count } => Some(Values { first, count, ..self }),
            _ => None,
        }
    }

    /// All references among the values.
    pub(crate) fn references(self) -> impl Iterator<Item = u64> + 'a {
        (0..self.len()).filter_map(move |index| self.reference(index))
    }

    /// All references of the list at an index.
    pub(crate) fn references_at(self, index: usize) -> impl Iterator<Item = u64> + 'a {
        self.list(index).into_iter().flat_map(Values::references)
    }

    /// All numbers, if all values are some.
    pub(crate) fn numbers(self) -> Option<Vec<f64>> {
        (0..self.len()).map(|index| self.number(index)).collect()
    }

    /// All whole numbers, if all values are some.
    pub(crate) fn counts(self) -> Option<Vec<usize>> {
        (0..self.len()).map(|index| self.count_at(index)).collect()
    }

    /// The references of a record at any depth, in their order; at most so many.
    pub(crate) fn all_references(self, most: usize) -> Vec<u64> {
        let (mut found, mut rest) = (Vec::new(), vec![(self, 0)]);
        while let Some((values, index)) = rest.pop() {
            if index >= values.len() || found.len() >= most {
                continue;
            }
            rest.push((values, index + 1));
            match values.at(index) {
                Value::Reference(id) => found.push(id),
                Value::List { first, count } => rest.push((Values { first, count, ..values }, 0)),
                _ => {}
            }
        }
        found
    }
}

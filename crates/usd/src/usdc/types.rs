//! The types of values in crate files, by their numbers.

/// Kind of a value, and how its numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Tuples of numbers of this many bytes each.
    Numbers(Stored, usize),
    String,
    Token,
    Asset,
    Dictionary,
    TokenListOp,
    StringListOp,
    /// Of numbers of 64 bits.
    IntegerListOp,
    PathListOp,
    ReferenceListOp,
    PayloadListOp,
    PathVector,
    TokenVector,
    StringVector,
    Word,
    Selections,
    Samples,
    Payload,
    Doubles,
    Offsets,
    Blocked,
    /// A value of any type, elsewhere.
    Nested,
    Other,
}

/// Form in which a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stored {
    Bool,
    U8,
    I32,
    U32,
    I64,
    U64,
    Half,
    Float,
    Double,
}

impl Stored {
    pub(super) fn bytes(self) -> u64 {
        match self {
            Stored::Bool | Stored::U8 => 1,
            Stored::Half => 2,
            Stored::I32 | Stored::U32 | Stored::Float => 4,
            Stored::I64 | Stored::U64 | Stored::Double => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        matches!(self, Stored::I32 | Stored::U32 | Stored::I64 | Stored::U64)
    }
}

impl Kind {
    /// The type with this number.
    pub(super) fn of(number: u8) -> Kind {
        use Kind::Numbers;
        use Stored::{Bool, Double, Float, Half, I32, I64, U8, U32, U64};
        match number {
            1 => Numbers(Bool, 1),
            2 => Numbers(U8, 1),
            3 => Numbers(I32, 1),
            4 => Numbers(U32, 1),
            5 => Numbers(I64, 1),
            6 => Numbers(U64, 1),
            7 => Numbers(Half, 1),
            8 => Numbers(Float, 1),
            9 | 56 => Numbers(Double, 1),
            10 => Kind::String,
            11 => Kind::Token,
            12 => Kind::Asset,
            13 => Numbers(Double, 4),
            14 => Numbers(Double, 9),
            15 => Numbers(Double, 16),
            16 => Numbers(Double, 4),
            17 => Numbers(Float, 4),
            18 => Numbers(Half, 4),
            // Vectors of two, three and four doubles, floats, halves and integers.
            19..=30 => {
                let stored = [Double, Float, Half, I32][usize::from(number - 19) % 4];
                Numbers(stored, 2 + usize::from(number - 19) / 4)
            }
            31 => Kind::Dictionary,
            32 => Kind::TokenListOp,
            33 => Kind::StringListOp,
            34 => Kind::PathListOp,
            35 => Kind::ReferenceListOp,
            37 => Kind::IntegerListOp,
            40 => Kind::PathVector,
            41 => Kind::TokenVector,
            42..=44 => Kind::Word,
            45 => Kind::Selections,
            46 => Kind::Samples,
            47 => Kind::Payload,
            48 => Kind::Doubles,
            49 => Kind::Offsets,
            50 => Kind::StringVector,
            51 | 60 => Kind::Blocked,
            52 | 53 => Kind::Nested,
            55 => Kind::PayloadListOp,
            _ => Kind::Other,
        }
    }

    /// Matrices keep only their diagonal where a value has no bytes of its own.
    pub(super) fn side_of_matrix(number: u8) -> Option<usize> {
        (13..=15).contains(&number).then(|| usize::from(number) - 11)
    }
}

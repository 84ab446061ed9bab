//! The shape that every table of variants shares, so that help, docs, scene files, `bilux list` and the
//! tests can all read the same rows.

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterKind {
    /// True or false.
    Bool,
    /// A whole number within the bounds, both inclusive.
    Integer {
        /// Least value.
        min: i64,
        /// Greatest value.
        max: i64,
    },
    /// A number within the bounds, both inclusive.
    Number {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A linear Rec. 709 triple, each channel within the bounds.
    Colour {
        /// Least channel.
        min: f64,
        /// Greatest channel.
        max: f64,
    },
    /// As [`ParameterKind::Colour`], or a texture in its place.
    ColourTexture {
        /// Least channel.
        min: f64,
        /// Greatest channel.
        max: f64,
    },
    /// As [`ParameterKind::Number`], or a texture in its place.
    NumberTexture {
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A texture of numbers; none by default.
    Texture,
    /// Colours of a gradient, each channel within the bounds: `[position, colour]`, one behind the other.
    Stops {
        /// Least channel.
        min: f64,
        /// Greatest channel.
        max: f64,
    },
    /// The name of a material.
    Material,
    /// Three coordinates.
    Vector,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Free text, such as a file's path.
    Text,
}

/// One parameter of a registered variant.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its key in scene files, `snake_case`.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Its unit, or "" where it has none.
    pub unit: &'static str,
    /// What values it takes.
    pub kind: ParameterKind,
    /// Its default as it would be written in a scene file, or "" where it has to be given.
    pub default: &'static str,
}

/// One of these words.
pub const fn choice(
    name: &'static str,
    summary: &'static str,
    words: &'static [&'static str],
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Choice(words), default }
}

/// A whole number, both bounds inclusive.
pub const fn integer(
    name: &'static str,
    summary: &'static str,
    min: i64,
    max: i64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Integer { min, max }, default }
}

/// What every row of every table tells about itself.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name that people type.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Where it comes from: a key of `REFERENCES.md`, or "" for our own.
    pub source: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

//! The row type that every table of variants shares, so that help, docs, scene files, `bilux list` and the tests all
//! read the same rows.

/// The values that a parameter can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterKind {
    /// True or false.
    Bool,
    /// An integer within the bounds, both inclusive.
    Integer {
        /// Minimum value.
        min: i64,
        /// Maximum value.
        max: i64,
    },
    /// A number within the bounds, both inclusive.
    Number {
        /// Minimum value.
        min: f64,
        /// Maximum value.
        max: f64,
    },
    /// A linear Rec. 709 triple, each channel within the bounds.
    Colour {
        /// Minimum channel.
        min: f64,
        /// Maximum channel.
        max: f64,
    },
    /// As [`ParameterKind::Colour`], or a texture instead.
    ColourTexture {
        /// Minimum channel.
        min: f64,
        /// Maximum channel.
        max: f64,
    },
    /// As [`ParameterKind::Number`], or a texture instead.
    NumberTexture {
        /// Minimum value.
        min: f64,
        /// Maximum value.
        max: f64,
    },
    /// A texture of numbers; none by default.
    Texture,
    /// A grid of numbers in space; none by default.
    Grid,
    /// A measured luminous intensity distribution; none by default.
    Distribution,
    /// Colours of a gradient, each channel within the bounds: a list of `[position, colour]`.
    Stops {
        /// Minimum channel.
        min: f64,
        /// Maximum channel.
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
    /// Key in scene files, `snake_case`.
    pub name: &'static str,
    /// One line for the user.
    pub summary: &'static str,
    /// Unit of the value, or "" where it has none.
    pub unit: &'static str,
    /// The values that it can take.
    pub kind: ParameterKind,
    /// Default as written in a scene file, or "" where the value is required.
    pub default: &'static str,
}

/// A parameter with a choice of words.
pub const fn choice(
    name: &'static str,
    summary: &'static str,
    words: &'static [&'static str],
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Choice(words), default }
}

/// An integer parameter, both bounds inclusive.
pub const fn integer(
    name: &'static str,
    summary: &'static str,
    min: i64,
    max: i64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Integer { min, max }, default }
}

/// The common part of every row of every table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name used in settings.
    pub name: &'static str,
    /// One line for the user.
    pub summary: &'static str,
    /// Source: a key of `REFERENCES.md`, or "" for our own work.
    pub source: &'static str,
    /// Parameters of the variant.
    pub parameters: &'static [Parameter],
}

//! Keys of curves.

/// Interpolation from a key to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Interpolation {
    /// The value of the key, or of the next.
    Constant {
        is_next: bool,
    },
    Linear,
    /// Slopes per second at both ends, and the parts of the interval that their tangents reach.
    Cubic {
        slopes: [f64; 2],
        weights: [f64; 2],
        tangent: Tangent,
    },
}

/// A key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    /// In units of time of the file.
    pub(super) time: f64,
    pub(super) value: f64,
    pub(super) interpolation: Interpolation,
}

/// Source of a key's slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tangent {
    /// They are stated.
    Stated,
    /// They are chosen, and what is stated instead is how much they lean to one side, in percent.
    Automatic(Rule),
    /// By tension, continuity and bias. [Kochanek 1984]
    Shaped([f64; 3]),
}

/// Rule for automatic slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rule {
    /// Flat next to a key of the same value.
    pub(super) is_clamped: bool,
    /// Never so steep that the curve leaves the range of the two keys that it is between.
    pub(super) stays_between: bool,
    /// The slope of the straight line between the neighbours, wherever the key is between them.
    pub(super) is_straight: bool,
}

impl Rule {
    /// The rule that programs use unless told otherwise.
    pub(super) const USUAL: Rule = Rule { is_clamped: false, stays_between: true, is_straight: true };
}

//! The sides of a surface.

/// The sides of its triangles from which a surface emits light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both sides.
    #[default]
    Both,
    /// The side from which the corners of a triangle are counter-clockwise in its own mesh. A transform that mirrors keeps the
    /// side: what was the outside of a solid still is.
    Front,
}

impl Sides {
    /// Their names in scene files.
    pub(crate) const NAMES: &'static [&'static str] = &["both", "front"];

    /// The name, one of [`Sides::NAMES`].
    pub(crate) fn name(self) -> &'static str {
        Sides::NAMES[self as usize]
    }

    /// The sides with one of [`Sides::NAMES`].
    pub(crate) fn from_name(name: &str) -> Sides {
        if name == "front" { Sides::Front } else { Sides::Both }
    }

    /// The number of sides.
    pub(crate) fn count(self) -> f32 {
        match self {
            Sides::Both => 2.0,
            Sides::Front => 1.0,
        }
    }
}

//! Axes, and which of them points up.

use bilux_math::DVec3;

/// A direction along one of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// +x.
    X,
    /// +y.
    Y,
    /// +z.
    Z,
    /// -x.
    NegX,
    /// -y.
    NegY,
    /// -z.
    NegZ,
}

impl Axis {
    /// All six.
    pub const ALL: [Axis; 6] = [Axis::X, Axis::Y, Axis::Z, Axis::NegX, Axis::NegY, Axis::NegZ];

    /// The axis of a name, with an optional leading `+`.
    pub fn from_name(name: &str) -> Option<Axis> {
        let name = name.trim().to_lowercase();
        let name = name.strip_prefix('+').unwrap_or(&name);
        Axis::ALL.into_iter().find(|axis| axis.name() == name)
    }

    /// Name of the axis.
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
            Axis::NegX => "-x",
            Axis::NegY => "-y",
            Axis::NegZ => "-z",
        }
    }

    /// The opposite direction.
    pub fn opposite(self) -> Axis {
        Axis::ALL[(self as usize + 3) % 6]
    }

    /// 0 for x, 1 for y, 2 for z.
    pub fn index(self) -> usize {
        match self {
            Axis::X | Axis::NegX => 0,
            Axis::Y | Axis::NegY => 1,
            Axis::Z | Axis::NegZ => 2,
        }
    }

    /// 1, or -1.
    pub fn sign(self) -> f64 {
        if matches!(self, Axis::X | Axis::Y | Axis::Z) { 1.0 } else { -1.0 }
    }

    /// The unit vector of the axis.
    pub fn direction(self) -> DVec3 {
        DVec3::AXES[self.index()] * self.sign()
    }
}

/// The up axis as stated by a file or its format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpHint {
    /// An axis that is stated, or follows from the format.
    Is(Axis),
    /// Most files of the format use it; the shape may show that this one does not.
    Usually(Axis),
}

impl Default for UpHint {
    /// The convention of scenes generated here.
    fn default() -> UpHint {
        UpHint::Is(Axis::Y)
    }
}

//! Which way a model is up, and where its front is.

mod shape;

use crate::builder::SceneBuilder;
use bilux_math::{DMat3, DVec3};
use shape::Shape;

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

    /// By its name; a `+` may stand before it.
    pub fn named(name: &str) -> Option<Axis> {
        let name = name.trim().to_lowercase();
        let name = name.strip_prefix('+').unwrap_or(&name);
        Axis::ALL.into_iter().find(|axis| axis.name() == name)
    }

    /// Its name.
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

    /// The other way.
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

    /// Of length one.
    pub fn direction(self) -> DVec3 {
        DVec3::AXES[self.index()] * self.sign()
    }
}

/// What a file or its format says of which way is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpHint {
    /// It is said, or follows from the format.
    Is(Axis),
    /// Most files of the format have it so; the shape may show that this one has not.
    Usually(Axis),
}

impl Default for UpHint {
    /// As scenes have it that are made here.
    fn default() -> UpHint {
        UpHint::Is(Axis::Y)
    }
}

/// How a model stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orientation {
    /// Which of its axes is up.
    pub up: Axis,
    /// Which of them is its front.
    pub front: Axis,
    /// Whence this is known.
    pub because: Because,
}

/// Whence it is known how a model stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Because {
    /// The user says it.
    Asked,
    /// The file's format says it.
    Format,
    /// Most files of its format have it so, and nothing in the shape speaks against it.
    Usual,
    /// The shape speaks for it.
    Shape,
}

impl Because {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Because::Asked => "as asked",
            Because::Format => "as its format says",
            Because::Usual => "as is usual in its format",
            Because::Shape => "judged by its shape",
        }
    }
}

impl Orientation {
    /// How a scene stands, as far as it is not asked for; `None` where front and up are along one axis.
    pub fn of(scene: &SceneBuilder, up: Option<Axis>, front: Option<Axis>) -> Option<Orientation> {
        let (usual, is_open) = match scene.up {
            UpHint::Is(axis) => (axis, false),
            UpHint::Usually(axis) => (axis, true),
        };
        let shape = if is_open && (up.is_none() || front.is_none()) { Shape::of(scene) } else { None };
        let allowed = |axis: &Axis| front.is_none_or(|front| front.index() != axis.index());
        let judged = || {
            let shape = shape.as_ref()?;
            let score = |axis: &Axis| shape.upright(*axis, usual);
            Axis::ALL.into_iter().filter(allowed).max_by(|a, b| score(a).total_cmp(&score(b)))
        };
        let usual = if allowed(&usual) { usual } else { Axis::ALL.into_iter().find(allowed)? };
        let found = up.or_else(judged).unwrap_or(usual);
        let before = front_of(found);
        let looks_back = || shape.as_ref().is_some_and(|shape| shape.looks_back(found, before));
        let turned = front.unwrap_or_else(|| if looks_back() { before.opposite() } else { before });
        let because = match (up.is_some() || front.is_some(), is_open) {
            (true, _) => Because::Asked,
            (false, false) => Because::Format,
            (false, true) if found == usual && turned == before => Because::Usual,
            (false, true) => Because::Shape,
        };
        (turned.index() != found.index()).then_some(Orientation { up: found, front: turned, because })
    }

    /// The rotation that turns up to +y and the front to +z.
    pub fn upright(self) -> DMat3 {
        let (up, front) = (self.up.direction(), self.front.direction());
        DMat3::from_cols(up.cross(front), up, front).transpose()
    }
}

/// Where the front is by custom: +z where y is up, -y where z is, as modelling programs have it.
fn front_of(up: Axis) -> Axis {
    match up {
        Axis::Z | Axis::NegZ => Axis::NegY,
        _ => Axis::Z,
    }
}

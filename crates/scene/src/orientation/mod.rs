//! The up axis of a model, and its front.

mod shape;

use crate::builder::SceneBuilder;
use bilux_math::DMat3;
use shape::Shape;

pub use crate::geometry::axis::{Axis, UpHint};

/// The orientation of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orientation {
    /// The axis that points up.
    pub up: Axis,
    /// The axis that points to the front.
    pub front: Axis,
    /// Source of the orientation.
    pub source: OrientationSource,
}

/// Source of a model's orientation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrientationSource {
    /// The user asked for it.
    Asked,
    /// The file's format specifies it.
    Format,
    /// Most files of its format use it, and nothing in the shape contradicts it.
    Usual,
    /// The shape suggests it.
    Shape,
}

impl OrientationSource {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            OrientationSource::Asked => "as asked",
            OrientationSource::Format => "as its format defines",
            OrientationSource::Usual => "as is usual in its format",
            OrientationSource::Shape => "guessed from its shape",
        }
    }
}

impl Orientation {
    /// With this axis up, and the front that modelling programs give it.
    pub fn usual(up: Axis) -> Orientation {
        Orientation { up, front: front_of(up), source: OrientationSource::Usual }
    }

    /// The orientation of a scene, where the user did not choose it; `None` if front and up are on the same axis.
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
        let source = match (up.is_some() || front.is_some(), is_open) {
            (true, _) => OrientationSource::Asked,
            (false, false) => OrientationSource::Format,
            (false, true) if found == usual && turned == before => OrientationSource::Usual,
            (false, true) => OrientationSource::Shape,
        };
        (turned.index() != found.index()).then_some(Orientation { up: found, front: turned, source })
    }

    /// The rotation that takes up to +y and the front to +z.
    pub fn upright(self) -> DMat3 {
        let (up, front) = (self.up.direction(), self.front.direction());
        DMat3::from_cols(up.cross(front), up, front).transpose()
    }
}

/// The conventional front: +z if y is up, -y if z is, as in modelling programs.
fn front_of(up: Axis) -> Axis {
    match up {
        Axis::Z | Axis::NegZ => Axis::NegY,
        _ => Axis::Z,
    }
}

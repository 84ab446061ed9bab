//! Places of statements, after what the commands around them do to them.

use super::xform::{Xform, joined};
use bilux_math::DMat4;
use std::rc::Rc;

/// Changes to all surfaces of a file, in one of its places.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub(super) matrix: DMat4,
    /// Modifier of all surfaces, in place of their own modifiers.
    pub(super) modifier: Option<Rc<str>>,
    /// Prefix of the names of surfaces.
    pub(super) prefix: Option<Rc<str>>,
    /// Whether surfaces are turned inside out.
    pub(super) inverts: bool,
}

impl Place {
    /// A copy within this place; `None` if its matrix has numbers that are too large. What is outside counts last, and therefore
    /// decides about the modifier.
    pub(super) fn within(&self, xform: &Xform, copy: u64) -> Option<Place> {
        let (matrix, prefix) = xform.copy(copy);
        let prefix = match (&self.prefix, prefix) {
            (Some(outer), Some(inner)) => Some(joined(Some(&**outer), &inner)),
            (outer, inner) => inner.or_else(|| outer.clone()),
        };
        let place = Place {
            matrix: self.matrix * matrix,
            modifier: self.modifier.clone().or_else(|| xform.modifier.clone()),
            prefix,
            inverts: self.inverts != xform.inverts,
        };
        (place.matrix.is_finite() && place.matrix.determinant().is_normal()).then_some(place)
    }

    /// The factor on lengths, which is the same in all directions.
    pub(super) fn scale(&self) -> f64 {
        self.matrix.x_axis.truncate().length()
    }

    /// True if the corners of a polygon run the other way round, so that its front stays the front.
    pub(super) fn reverses(&self) -> bool {
        (self.matrix.determinant() < 0.0) != self.inverts
    }
}

//! Keys that compare what is shared by address, and numbers by their bits.

use bilux_math::Transform;
use bilux_math::motion::Motion;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Equal if it is the same value at the same address, not merely an equal one. It holds the value, so that nothing
/// else can come to lie at its address.
pub(crate) struct Same<T: ?Sized>(pub(crate) Arc<T>);

impl<T: ?Sized> Same<T> {
    fn address(&self) -> *const () {
        Arc::as_ptr(&self.0).cast()
    }
}

impl<T: ?Sized> Clone for Same<T> {
    fn clone(&self) -> Same<T> {
        Same(self.0.clone())
    }
}

impl<T: ?Sized> PartialEq for Same<T> {
    fn eq(&self, other: &Same<T>) -> bool {
        std::ptr::eq(self.address(), other.address())
    }
}

impl<T: ?Sized> Eq for Same<T> {}

impl<T: ?Sized> Hash for Same<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.address().hash(state);
    }
}

/// The transform of an object that does not move; equal if all bits are: -0 may have other consequences than 0.
#[derive(Clone)]
pub(crate) struct Place(Motion);

impl Place {
    /// `None` for an object that moves.
    pub(crate) fn of(motion: &Motion) -> Option<Place> {
        match motion.static_transform() {
            Some(_) => Some(Place(motion.clone())),
            // It may have keyframes nevertheless, all of them the same.
            None => motion.is_still().then(|| Place(Motion::still(motion.at(0.0)))),
        }
    }

    pub(crate) fn transform(&self) -> &Transform {
        self.0.static_transform().unwrap_or(&Transform::IDENTITY)
    }

    fn bits(&self) -> impl Iterator<Item = u32> {
        let transform = self.transform();
        let matrices = [transform.matrix(), transform.inverse_matrix()];
        matrices.into_iter().flat_map(|matrix| matrix.to_cols_array()).map(f32::to_bits)
    }
}

impl PartialEq for Place {
    fn eq(&self, other: &Place) -> bool {
        std::ptr::eq(self.transform(), other.transform()) || self.bits().eq(other.bits())
    }
}

impl Eq for Place {}

impl Hash for Place {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // The inverse follows from the matrix.
        self.transform().matrix().to_cols_array().map(f32::to_bits).hash(state);
    }
}

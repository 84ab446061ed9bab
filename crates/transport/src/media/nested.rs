//! Which of the media that overlap exists: the one of the highest priority. [Schmidt 2002]

use super::coincident::MAX_COINCIDENT;
use bilux_scene::{MAX_NESTED, Nested, Scene, Surface};

/// No object.
pub(super) const NONE: u32 = u32::MAX;

/// Objects that have a priority, as far as a path is inside of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    /// Objects around the path.
    around: [u32; MAX_NESTED],
    /// Objects whose surfaces coincide with the one that the path has reached: they are crossed together with it.
    together: [u32; MAX_COINCIDENT],
}

impl Overlap {
    /// None.
    pub(super) const NOTHING: Overlap =
        Overlap { around: [NONE; MAX_NESTED], together: [NONE; MAX_COINCIDENT] };

    /// Whether an object is around.
    #[inline]
    pub(super) fn contains(&self, object: u32) -> bool {
        self.around.contains(&object)
    }

    /// Sets the objects that are crossed together with the one that the path has reached.
    pub(super) fn cross_together(&mut self, objects: impl Iterator<Item = u32>) {
        self.together.iter_mut().zip(objects).for_each(|(slot, object)| *slot = object);
    }

    /// Forgets them, away from surfaces.
    #[inline]
    pub(super) fn leave(&mut self) {
        self.together = [NONE; MAX_COINCIDENT];
    }

    /// False for the surface of a medium inside a [stronger](Scene::nesting) one, and for one between media of the same index that does
    /// nothing else.
    #[inline]
    pub(super) fn separates(&self, scene: &Scene, surface: &Surface) -> bool {
        if !scene.has_nested() {
            return true;
        }
        let Some(medium) = scene.nested(surface.object) else { return true };
        let material = scene.material(surface);
        if material.is_interface() {
            return false;
        }
        let separates = |media: &Overlap| {
            let strongest = media.without(scene.body(surface.object)).strongest_object(scene);
            strongest == NONE || scene.nesting(surface.object) > scene.nesting(strongest)
        };
        if !separates(self) || (self.together[0] != NONE && !separates(&self.with_all_together())) {
            return false;
        }
        !material.only_refracts() || {
            let outside = self.outside(scene, surface.object).unwrap_or(Nested::AIR);
            !medium.bends_like(&outside)
        }
    }

    /// The strongest medium on the outside of an object's surface that the path has reached.
    #[inline]
    pub(super) fn outside(&self, scene: &Scene, object: u32) -> Option<Nested> {
        // On the far side of a surface that the path would leave through, those that coincide with it are crossed.
        let body = scene.body(object);
        let around = if self.contains(body) { self.with_all_together() } else { *self };
        around.without(body).strongest(scene)
    }

    /// The object of the strongest medium.
    #[inline]
    pub(super) fn strongest_object(&self, scene: &Scene) -> u32 {
        let media = self.around.iter().copied().filter(|&object| object != NONE);
        media.max_by_key(|&object| scene.nesting(object)).unwrap_or(NONE)
    }

    /// The strongest medium.
    pub(super) fn strongest(&self, scene: &Scene) -> Option<Nested> {
        match self.strongest_object(scene) {
            NONE => None,
            object => scene.nested(object),
        }
    }

    /// These media on the other side of the surfaces that are crossed together.
    pub(super) fn with_all_together(&self) -> Overlap {
        self.together
            .iter()
            .filter(|&&object| object != NONE)
            .fold(*self, |media, &object| media.changed(object))
    }

    /// The media on the other side of an object's surface.
    pub(super) fn changed(self, object: u32) -> Overlap {
        if self.around.contains(&object) { self.without(object) } else { self.with(object) }
    }

    pub(super) fn with(mut self, object: u32) -> Overlap {
        self.add(object);
        self
    }

    pub(super) fn add(&mut self, object: u32) {
        if !self.around.contains(&object)
            && let Some(free) = self.around.iter_mut().find(|slot| **slot == NONE)
        {
            *free = object;
        }
    }

    pub(super) fn without(mut self, object: u32) -> Overlap {
        self.around.iter_mut().filter(|slot| **slot == object).for_each(|slot| *slot = NONE);
        self
    }
}

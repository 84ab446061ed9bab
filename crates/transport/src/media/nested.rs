//! Which of the media that overlap exists: the one of the highest priority. [Schmidt 2002]

use super::coincident::MAX_COINCIDENT;
use bilux_scene::{Nested, Scene, Surface};

/// Maximum number of nested media; further ones are ignored.
const MAX_NESTED: usize = 4;

/// No object.
pub(super) const NONE: u32 = u32::MAX;

/// Objects that have a priority, as far as a path is inside of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    /// Those around it.
    around: [u32; MAX_NESTED],
    /// Those whose surfaces coincide with the one that the path has reached: they are crossed together with it.
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

    /// False for the surface of a medium inside one of higher priority. Of equal priorities the object that comes first
    /// in the scene wins, so that the result is the same from both ends of a path.
    #[inline]
    pub(super) fn separates(&self, scene: &Scene, surface: &Surface) -> bool {
        if !scene.has_nested() {
            return true;
        }
        let material = scene.material(surface);
        let Some(own) = material.nested() else { return true };
        if material.is_interface() {
            return false;
        }
        let separates = |media: &Overlap| match media.without(surface.object).strongest(scene) {
            Some((object, other)) => strength(surface.object, &own) > strength(object, &other),
            None => true,
        };
        separates(self) && (self.together[0] == NONE || separates(&self.with_all_together()))
    }

    /// The medium of highest priority.
    pub(super) fn strongest(&self, scene: &Scene) -> Option<(u32, Nested)> {
        let media = self.around.iter().filter(|&&object| object != NONE);
        let media = media.filter_map(|&object| Some((object, scene.material_of(object).nested()?)));
        media.max_by_key(|(object, nested)| strength(*object, nested))
    }

    /// The object of that medium.
    pub(super) fn strongest_object(&self, scene: &Scene) -> u32 {
        self.strongest(scene).map_or(NONE, |(object, _)| object)
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

/// Greater for the medium that wins where two overlap: by priority, and of equal ones for the object that comes first.
pub(super) fn strength(object: u32, nested: &Nested) -> (u32, std::cmp::Reverse<u32>) {
    (nested.priority, std::cmp::Reverse(object))
}

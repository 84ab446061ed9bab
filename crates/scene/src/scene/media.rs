//! Media that fill a scene, and surfaces that light passes.

use super::Scene;
use super::enclosure::Enclosure;
use bilux_math::Vec3;

impl Scene {
    /// The boundary of what scatters inside an object, if nothing leaves that unseen.
    #[inline]
    pub fn enclosure(&self, object: u32) -> Option<&Enclosure> {
        self.parts.enclosures.get(object as usize)?.as_ref()
    }

    /// Whether the inside of an object is a dense medium whose [clearance](Scene::clearance) is known.
    #[inline]
    pub fn is_dense(&self, object: u32) -> bool {
        self.parts.clearance.is_dense(object)
    }

    /// The distance in metres from a point of a dense medium, inside this object, to the nearest triangle of anything that does not move, or
    /// `within` where that is less. `None` where the medium is not dense, or moves.
    #[inline]
    pub fn clearance(&self, object: u32, p: Vec3, within: f32) -> Option<f32> {
        self.is_dense(object).then(|| self.parts.clearance.at(p, within))
    }

    /// True when some object is the boundary of a medium without a surface of its own: of fog, smoke, a cloud.
    pub fn has_interfaces(&self) -> bool {
        self.parts.materials.iter().any(|material| material.is_interface())
    }

    /// True when some medium emits light.
    pub fn has_glowing_media(&self) -> bool {
        self.parts
            .materials
            .iter()
            .any(|material| material.medium().is_some_and(|medium| medium.glow.is_some()))
    }

    /// True when some medium scatters light, and distances in it are not the same in all channels.
    #[inline]
    pub fn has_coloured_distances(&self) -> bool {
        self.parts.has_coloured_distances
    }

    /// True when some medium scatters light, or varies: walks have to ask what they meet in it.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.parts.scatters
    }

    /// True when a grid varies some medium.
    pub fn has_varying_media(&self) -> bool {
        self.parts.has_varying_media
    }

    /// True when no medium changes what light carries: none absorbs, scatters, has a priority or disperses.
    #[inline]
    pub fn has_clear_media(&self) -> bool {
        !self.parts.absorbs && !self.has_nested() && !self.parts.disperses
    }

    /// True when light between two points is that of empty space, unless something blocks it: no medium changes it, and nothing lets it pass.
    pub fn has_plain_shadows(&self) -> bool {
        self.has_clear_media() && !self.has_panes()
    }

    /// True when light passes some surfaces straight: [`is_pane`](crate::materials::Material::is_pane).
    #[inline]
    pub fn has_panes(&self) -> bool {
        self.parts.has_panes
    }
}

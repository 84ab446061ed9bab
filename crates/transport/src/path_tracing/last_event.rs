//! The event of a path from which lights are sampled too, and which panes behind it do not change.

use crate::media::equiangular::Approach;
use crate::media::interaction::Interaction;
use bilux_math::Vec3;
use bilux_scene::Scene;

/// An event from which lights are sampled too, along the ray on which a path goes on.
#[derive(Clone, Copy)]
pub(crate) struct LastEvent {
    pub(crate) p: Vec3,
    /// The density of the direction, over solid angle.
    pub(crate) pdf: f32,
    pub(crate) is_in_medium: bool,
    /// Approach of the ray that came there, where [equiangular points](crate::media::equiangular) may be.
    pub(crate) approach: Option<Approach>,
}

/// True where light passes a pane straight from a vertex that is beyond it along `wo`, so that [connections](crate::walk::through::Through) lead
/// through it too.
pub(crate) fn passes_straight(scene: &Scene, at: &Interaction, wo: Vec3) -> bool {
    let Interaction::Surface(surface, bsdf) = at else { return false };
    scene.has_panes() && scene.material(surface).is_pane() && !bsdf.straight(wo).is_black()
}

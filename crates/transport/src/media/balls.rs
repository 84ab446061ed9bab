//! Which balls points of dense media are merged in.

use super::Media;
use crate::media::ball::Ball;
use crate::media::interaction::{Interaction, MediumPoint};
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::Vec3;
use bilux_scene::Scene;

/// The largest radius of a ball over the mean free path.
const WIDEST: f32 = 0.5;

/// Largest radius where the boundary is not known, over the mean free path: within a radius of it, some light is lost.
const WIDEST_BLIND: f32 = 0.05;

impl Media {
    /// The ball in which a point of these media is merged with photons if no surface is near; `None` where it is not merged with points.
    #[inline]
    pub(crate) fn ball<const N: usize>(
        &self,
        scene: &Scene,
        at: &Interaction,
        techniques: &TechniqueCounts<N>,
    ) -> Option<Ball> {
        let Interaction::Medium(MediumPoint { even: Some(sigma_t), .. }) = at else { return None };
        let densest = sigma_t.max_channel();
        if techniques.points == PerSet::ZERO || densest <= techniques.densest {
            return None;
        }
        let widest = if scene.is_dense(self.inside) { WIDEST } else { WIDEST_BLIND };
        Some(Ball::whole(techniques.radius.min(widest / densest)))
    }

    /// The part of a ball that is in these media, around a point of them.
    pub(crate) fn part_inside(&self, scene: &Scene, p: Vec3, ball: Ball) -> Ball {
        match scene.clearance(self.inside, p, ball.radius) {
            Some(clearance) => ball.near(clearance),
            None => ball,
        }
    }
}

//! Shading normals of a normal map that face away from the viewer. They are bent back, because the surface would be
//! black there otherwise. The normal is mirrored about the plane perpendicular to the view direction, so that a normal
//! exactly perpendicular to the view stays as it is.
//!
//! The viewer is at the camera's end of the path: along `wo` for radiance, along `wi` for importance. So the BSDF is
//! the same whichever end a path starts at. A path from a light does not know the viewer yet when it samples a
//! direction, so it samples some of its directions about the geometric normal, to cover those that a bent normal makes
//! visible.

use super::{Bsdf, BsdfSample, TransportMode};
use bilux_math::{Frame, Vec3};

/// The maximum fraction of directions from a light that are sampled about the geometric normal.
const MAX_FLAT: f32 = 0.25;

impl Bsdf {
    /// Calls `about` with the frame of the normal as seen along `view`.
    #[inline(always)]
    pub(super) fn seen_along<T>(&self, view: Vec3, about: impl FnOnce(&Frame) -> T) -> T {
        let cos = view.dot(self.frame.n);
        if !self.bends || cos * view.dot(self.n_geom) >= 0.0 {
            return about(&self.frame);
        }
        let n = (self.frame.n - view * (2.0 * cos)).normalize();
        about(&Frame::from_normal(n).along(self.frame.s))
    }

    /// [`Bsdf::pdf_solid_angle`] of a BSDF that bends its normal.
    pub(super) fn bent_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| self.pdf_about(frame, wo, wi));
        }
        let (flat, share) = self.flat();
        (1.0 - share) * self.pdf_about(&self.frame, wo, wi) + share * self.pdf_about(&flat, wo, wi)
    }

    /// Samples a non-delta lobe, with `about` sampling about a given frame.
    pub(super) fn sample_bent(
        &self,
        wo: Vec3,
        u_choice: f32,
        mode: TransportMode,
        about: impl Fn(&Frame, f32) -> Option<BsdfSample>,
    ) -> Option<BsdfSample> {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| about(frame, u_choice));
        }
        let (flat, share) = self.flat();
        if u_choice < share {
            about(&flat, u_choice / share)
        } else {
            about(&self.frame, (u_choice - share) / (1.0 - share))
        }
    }

    /// The geometric frame, and the fraction of directions from a light that are sampled about it.
    ///
    /// The fraction grows with the set of views from which the normal is bent.
    fn flat(&self) -> (Frame, f32) {
        let sin = self.frame.n.cross(self.n_geom).length().min(1.0);
        (Frame::from_normal(self.n_geom).along(self.frame.s), MAX_FLAT * sin)
    }
}

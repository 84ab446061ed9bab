//! A normal map's normals, where they face away from whoever looks: they are bent back, or the surface would be black
//! there. A normal is mirrored about the plane across the view, which leaves it as it is where it just faces away.
//!
//! Whoever looks is at the camera's end of the path: along `wo` for radiance, along `wi` for importance. So the surface
//! scatters by one law whichever end a path begins at. A path from a light does not know yet who looks when it draws a
//! direction: a part of its directions are drawn about the triangle's own normal, so that it finds what is seen about
//! bent ones too.

use super::{Bsdf, BsdfSample, TransportMode};
use bilux_math::{Frame, Vec3};

/// Of directions from a light, at most this part is drawn about the triangle's normal.
const MAX_FLAT: f32 = 0.25;

impl Bsdf {
    /// Something about the normal that is seen along `view`.
    #[inline(always)]
    pub(super) fn seen_along<T>(&self, view: Vec3, about: impl FnOnce(&Frame) -> T) -> T {
        let cos = view.dot(self.frame.n);
        if !self.bends || cos * view.dot(self.n_geom) >= 0.0 {
            return about(&self.frame);
        }
        let n = (self.frame.n - view * (2.0 * cos)).normalize();
        about(&Frame::from_normal(n).along(self.frame.s))
    }

    /// [`Bsdf::pdf_solid_angle`] of one that bends.
    pub(super) fn bent_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| self.pdf_about(frame, wo, wi));
        }
        let (flat, share) = self.flat();
        (1.0 - share) * self.pdf_about(&self.frame, wo, wi) + share * self.pdf_about(&flat, wo, wi)
    }

    /// A direction of a lobe with width, drawn by `about` a normal.
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

    /// The frame of the triangle, and how much of what comes from a light is drawn about it: more, the more views there
    /// are from which the normal is bent.
    fn flat(&self) -> (Frame, f32) {
        let sin = self.frame.n.cross(self.n_geom).length().min(1.0);
        (Frame::from_normal(self.n_geom).along(self.frame.s), MAX_FLAT * sin)
    }
}

//! Shading normals that face away from the viewer: interpolated ones at the edges of coarse meshes, and those of normal
//! maps. They are bent back, because the surface would be black there otherwise. The normal is mirrored about the plane
//! perpendicular to the view direction, so that a normal exactly perpendicular to the view stays as it is.
//!
//! The viewer is at the camera's end of the path: along `wo` for radiance, along `wi` for importance. So the BSDF is
//! the same whichever end a path starts at. A path from a light does not know the viewer yet when it samples a
//! direction, so it samples some of its directions about the geometric normal, to cover those that a bent normal makes
//! visible.

use super::lobe_frame::NEARLY_FLAT;
use super::{Bsdf, BsdfSample, Conductor, Facets, Lambert, Lobe, RoughDielectric, TransportMode};
use bilux_math::{Frame, Rgb, Vec3};
use std::borrow::Cow;

/// The maximum fraction of directions from a light that are sampled about the geometric normal.
const MAX_FLAT: f32 = 0.25;

/// Reaches every direction on a side.
const DIFFUSE: Lobe = Lobe::Lambert(Lambert { albedo: Rgb::WHITE });

/// True when a shading normal faces away from a viewer in this direction, so that it is bent.
#[inline]
pub fn faces_away(n_shade: Vec3, n_geom: Vec3, view: Vec3) -> bool {
    n_shade.dot(n_geom) < NEARLY_FLAT && view.dot(n_shade) * view.dot(n_geom) < 0.0
}

impl Bsdf {
    /// Bends the shading normal, and that of a lobe with its own, back for a viewer behind it, instead of scattering black.
    #[inline]
    pub fn bending(mut self) -> Bsdf {
        self.bend();
        self
    }

    /// [`Bsdf::bending`] in place.
    #[inline]
    pub fn bend(&mut self) {
        self.bends = self.frame.n.dot(self.n_geom) < NEARLY_FLAT;
        if let Some(apart) = &mut self.apart {
            apart.bend(self.n_geom);
        }
    }

    /// True when the shading normal is to be bent for this view direction.
    #[inline]
    fn faces_away(&self, view: Vec3) -> bool {
        self.bends && view.dot(self.frame.n) * view.dot(self.n_geom) < 0.0
    }

    /// The frame of the normal as seen along a view direction from which it faces away.
    #[cold]
    fn bent(&self, view: Vec3) -> Frame {
        let n = (self.frame.n - view * (2.0 * view.dot(self.frame.n))).normalize();
        Frame::from_normal(n).along(self.frame.s)
    }

    /// Calls `about` with the frame of the normal as seen along `view`.
    #[inline(always)]
    pub(super) fn seen_along<T>(&self, view: Vec3, about: impl FnOnce(&Frame) -> T) -> T {
        let bent;
        about(if self.faces_away(view) {
            bent = self.bent(view);
            &bent
        } else {
            &self.frame
        })
    }

    /// [`Bsdf::eval_and_pdf`] of a BSDF that bends its normal.
    pub(super) fn bent_eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| self.eval_and_pdf_about(frame, wo, wi, mode));
        }
        if self.faces_away(wi) {
            return (self.eval(wo, wi, mode), self.pdf_solid_angle(wo, wi, mode));
        }
        let (scattered, pdf) = self.eval_and_pdf_about(&self.frame, wo, wi, mode);
        (scattered, if self.total_strength > 0.0 { self.with_flat(pdf, wo, wi) } else { 0.0 })
    }

    /// [`Bsdf::pdf_solid_angle`] of a BSDF that bends its normal.
    pub(super) fn bent_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| self.pdf_about(frame, wo, wi));
        }
        self.with_flat(self.pdf_about(&self.frame, wo, wi), wo, wi)
    }

    /// The density of directions from a light, of which `pdf` is that about the shading normal.
    fn with_flat(&self, pdf: f32, wo: Vec3, wi: Vec3) -> f32 {
        let (flat, share) = self.flat();
        (1.0 - share) * pdf
            + share * self.pdf_of(|lobe, wo, wi| wide(lobe).pdf_solid_angle(wo, wi), &flat, wo, wi)
    }

    /// Samples a non-delta lobe, with `about` sampling one about a given frame.
    #[inline]
    pub(super) fn sample_bent(
        &self,
        lobe: &Lobe,
        wo: Vec3,
        u_choice: f32,
        mode: TransportMode,
        about: impl Fn(&Lobe, &Frame, f32) -> Option<BsdfSample>,
    ) -> Option<BsdfSample> {
        if mode == TransportMode::Radiance {
            return self.seen_along(wo, |frame| about(lobe, frame, u_choice));
        }
        let (flat, share) = self.flat();
        if u_choice < share {
            about(&wide(lobe), &flat, u_choice / share)
        } else {
            about(lobe, &self.frame, (u_choice - share) / (1.0 - share))
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

/// The lobe that is sampled about the geometric normal: a lobe that excludes directions, as Phong's and those without tails
/// do, might exclude some that are visible about a bent normal.
#[inline]
fn wide(lobe: &Lobe) -> Cow<'_, Lobe> {
    match lobe {
        Lobe::Phong(_) => Cow::Borrowed(&DIFFUSE),
        Lobe::Conductor(Conductor { facets: Facets::Beckmann(facets), fresnel }) => {
            Cow::Owned(Lobe::Conductor(Conductor { facets: facets.with_tails().into(), fresnel: *fresnel }))
        }
        Lobe::RoughDielectric(glass @ RoughDielectric { facets: Facets::Beckmann(facets), .. }) => {
            Cow::Owned(Lobe::RoughDielectric(RoughDielectric {
                facets: facets.with_tails().into(),
                ..*glass
            }))
        }
        _ => Cow::Borrowed(lobe),
    }
}

//! A [`Bsdf`] with one fixed direction and many others, as in photon mapping: terms of the fixed one are computed once.

use super::{AlbedoTable, Bsdf, Lobe, OpaqueBaseForWo, TransportMode};
use bilux_math::{Rgb, Vec3};

/// A [`Bsdf`] with its `wo`.
#[derive(Clone, Copy, Debug)]
pub struct BsdfForWo<'a> {
    bsdf: &'a Bsdf,
    wo: Vec3,
    local_wo: Vec3,
    cos_geom: f32,
    /// [`Bsdf::risen`] there.
    risen: f32,
    /// The only lobe, if it is of this kind.
    opaque: Option<OpaqueBaseForWo>,
    mode: TransportMode,
}

impl Bsdf {
    /// Fixes the direction `wo`.
    #[inline]
    pub fn facing(&self, wo: Vec3, mode: TransportMode) -> BsdfForWo<'_> {
        let (local_wo, cos_geom) = (self.frame.to_local(wo), wo.dot(self.n_geom));
        let opaque = match self.lobes {
            [Some(Lobe::OpaqueBase(lobe)), None, ..] if !self.is_special() => Some(lobe.facing(local_wo)),
            _ => None,
        };
        BsdfForWo { bsdf: self, wo, local_wo, cos_geom, risen: self.risen(wo), opaque, mode }
    }
}

impl BsdfForWo<'_> {
    /// [`Bsdf::eval_and_pdf`], and [`Bsdf::pdf_solid_angle`] of the reverse direction, bit for bit; `None` where it is
    /// black.
    #[inline]
    pub fn eval_and_pdfs(&self, wi: Vec3) -> Option<(Rgb, f32, f32)> {
        let BsdfForWo { bsdf, wo, local_wo, cos_geom, risen, ref opaque, mode } = *self;
        if bsdf.is_special() {
            let (scattered, pdf) = bsdf.eval_and_pdf(wo, wi, mode);
            let back = || bsdf.pdf_solid_angle(wi, wo, mode.reversed());
            return (!scattered.is_black()).then(|| (scattered, pdf, back()));
        }
        let local_wi = bsdf.frame.to_local(wi);
        let sides_agree = cos_geom * wi.dot(bsdf.n_geom) * (local_wo.z * local_wi.z) > 0.0;
        if !sides_agree {
            return None;
        }
        let risen_back = bsdf.risen(wi);
        let (mut scattered, mut pdf, mut back) = (Rgb::BLACK, 0.0, 0.0);
        for (i, (weight, lobe)) in bsdf.weighted().enumerate() {
            let (f, p) = match opaque {
                Some(lobe) => lobe.eval_and_pdf(local_wi, lobe.look_up(local_wi.z, AlbedoTable::shared())),
                None => lobe.eval_and_pdf(local_wo, local_wi, mode),
            };
            scattered += f * weight;
            pdf += (bsdf.strengths[i] + bsdf.rises[i] * risen) * p;
            back +=
                (bsdf.strengths[i] + bsdf.rises[i] * risen_back) * lobe.pdf_solid_angle(local_wi, local_wo);
        }
        let scattered = bsdf.carried(scattered, bsdf.frame.n, wo, wi, mode);
        let of_all = |pdf: f32, risen: f32| {
            let total = bsdf.total_strength + bsdf.total_rise * risen;
            if total > 0.0 { pdf / total } else { 0.0 }
        };
        (!scattered.is_black()).then(|| (scattered, of_all(pdf, risen), of_all(back, risen_back)))
    }
}

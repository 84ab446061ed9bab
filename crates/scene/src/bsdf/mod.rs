//! Scattering by surfaces. Each lobe has its own file; a [`Bsdf`] is a sum of lobes on a frame.
//!
//! Directions: `wo` is the known one, `wi` the sampled or evaluated one; both are unit and point away from the
//! surface. `eval` gives f·|cosθi|. In the lobes' own files directions are local, with the normal as z.
//!
//! A shading normal is not the surface's own normal, so light and importance scatter by different laws. Radiance that
//! arrives along `wi` at a surface with the normal n_shade scatters by f·|wi·n_shade|. For a path from a light to carry
//! the same light between the same directions, importance that arrives along `wo` leaves along `wi` by
//! f·|wo·n_shade|·|wi·n_geom| / |wo·n_geom|. [Veach 1997, 5.3]
mod albedo;
mod bent;
mod coated_dielectric;
mod coated_diffuse;
mod coating;
mod conductor;
mod covered;
mod delta;
mod dielectric;
mod facets;
mod for_wo;
mod fresnel;
mod fuzz;
mod lambert;
mod lobe;
mod lobe_frame;
mod microfacet_reflection;
mod mirror;
mod mixed;
mod nodes;
mod opaque_base;
mod parts;
mod phong_lobe;
mod rough_dielectric;
mod rough_diffuse;
mod sample;
mod smooth_lobe;
mod splitting;
mod thin_film;
mod transport_mode;
pub mod wavelength;

pub use albedo::{Albedo, AlbedoTable};
pub use bent::faces_away;
pub use coated_dielectric::CoatedDielectric;
pub use coated_diffuse::CoatedDiffuse;
pub use coating::Coating;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use facets::{Beckmann, Facets, Ggx};
pub use for_wo::BsdfForWo;
pub use fresnel::{Fresnel, fresnel_conductor, fresnel_dielectric, refract, schlick};
pub use fuzz::{Fuzz, FuzzAlbedo};
pub use lambert::Lambert;
pub use lobe::{BSDFS, BsdfEntry, Lobe};
pub use microfacet_reflection::MicrofacetReflection;
pub use mirror::Mirror;
pub use opaque_base::{OpaqueBase, OpaqueBaseAlbedos, OpaqueBaseForWo, OpaqueBaseInputs, is_rough};
pub use phong_lobe::PhongLobe;
pub use rough_dielectric::RoughDielectric;
pub use rough_diffuse::RoughDiffuse;
pub use sample::BsdfSample;
pub use smooth_lobe::{SmoothLobe, SmoothSample};
pub use thin_film::ThinFilm;
pub use transport_mode::TransportMode;

use bilux_math::{Frame, Rgb, Vec2, Vec3};
use lobe_frame::LobeFrame;

/// A shading normal can raise importance by more than this only for a direction within rounding of the surface itself.
const MAX_TURNED: f32 = (1u64 << 60) as f32;

/// A sum of lobes at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    frame: Frame,
    n_geom: Vec3,
    /// The lobes, the present ones first, without gaps.
    lobes: [Option<Lobe>; MAX_LOBES],
    /// A factor on each lobe's light.
    weights: [f32; MAX_LOBES],
    /// The weight for choosing each lobe: weight times strength.
    strengths: [f32; MAX_LOBES],
    total_strength: f32,
    /// The gain of each strength at grazing angles.
    rises: [f32; MAX_LOBES],
    total_rise: f32,
    bends: bool,
    splits: bool,
    /// A lobe with a normal of its own.
    apart: Option<LobeFrame>,
}

/// The maximum number of lobes in a sum.
pub const MAX_LOBES: usize = 5;

impl Bsdf {
    /// A lobe around a shading normal.
    #[inline(always)]
    pub fn of(n_shade: Vec3, n_geom: Vec3, lobe: Lobe) -> Bsdf {
        let strength = lobe.strength();
        Bsdf {
            frame: Frame::from_normal(n_shade),
            n_geom,
            lobes: [Some(lobe), None, None, None, None],
            weights: [1.0; MAX_LOBES],
            strengths: [strength, 0.0, 0.0, 0.0, 0.0],
            total_strength: strength,
            rises: [0.0; MAX_LOBES],
            total_rise: 0.0,
            bends: false,
            splits: false,
            apart: None,
        }
    }

    /// A sum of at most [`MAX_LOBES`] lobes around a shading normal.
    pub fn new<const N: usize>(n_shade: Vec3, n_geom: Vec3, lobes: [Option<Lobe>; N]) -> Bsdf {
        Bsdf::of_lobes(n_shade, n_geom, &lobes)
    }

    /// [`Bsdf::new`] for lobes that are copied once: they are large.
    pub(crate) fn of_lobes(n_shade: Vec3, n_geom: Vec3, lobes: &[Option<Lobe>]) -> Bsdf {
        let mut sum = Bsdf::empty(Frame::from_normal(n_shade), n_geom);
        for (i, lobe) in lobes.iter().flatten().take(MAX_LOBES).enumerate() {
            sum.set(i, lobe, 1.0);
        }
        sum
    }

    /// A BSDF without lobes.
    #[inline]
    fn empty(frame: Frame, n_geom: Vec3) -> Bsdf {
        Bsdf {
            frame,
            n_geom,
            lobes: [None; MAX_LOBES],
            weights: [1.0; MAX_LOBES],
            strengths: [0.0; MAX_LOBES],
            total_strength: 0.0,
            rises: [0.0; MAX_LOBES],
            total_rise: 0.0,
            bends: false,
            splits: false,
            apart: None,
        }
    }

    /// Copies the lobes to another normal; settings that depend on the previous normal have to be applied again.
    #[inline]
    pub fn moved_to(&self, n_shade: Vec3, n_geom: Vec3) -> Bsdf {
        Bsdf { frame: Frame::from_normal(n_shade), n_geom, bends: false, apart: None, ..*self }
    }

    /// Sets a lobe, which is copied once: it is large.
    #[inline]
    fn set(&mut self, i: usize, lobe: &Lobe, weight: f32) {
        let strength = lobe.strength();
        self.lobes[i] = Some(*lobe);
        (self.weights[i], self.strengths[i]) = (weight, weight * strength);
        self.total_strength += self.strengths[i];
        self.rises[i] = weight * lobe.rise(strength);
        self.total_rise += self.rises[i];
    }

    /// The fraction of the rises that counts for light known to come along `wo`: Schlick's power of the cosine.
    #[inline]
    fn risen(&self, wo: Vec3) -> f32 {
        if self.rises == [0.0; MAX_LOBES] {
            return 0.0;
        }
        let m = (1.0 - wo.dot(self.frame.n).abs()).clamp(0.0, 1.0);
        (m * m) * (m * m) * m
    }

    /// The weight for choosing this BSDF among others, for light known to come along `wo`.
    #[inline]
    fn strength_along(&self, wo: Vec3) -> f32 {
        self.total_strength + self.total_rise * self.risen(wo)
    }

    /// True when it is more than a plain sum about one normal.
    #[inline]
    fn is_special(&self) -> bool {
        self.bends || self.apart.is_some()
    }

    /// The lobes, each with its weight.
    #[inline]
    fn weighted(&self) -> impl Iterator<Item = (f32, &Lobe)> {
        self.weights.iter().zip(&self.lobes).map_while(|(w, lobe)| Some((*w, lobe.as_ref()?)))
    }

    /// Turns the local x axis along a tangent, for anisotropic lobes; a zero vector leaves it unchanged.
    #[inline]
    pub fn along(mut self, tangent: Vec3) -> Bsdf {
        self.turn_along(tangent);
        self
    }

    /// [`Bsdf::along`] in place.
    #[inline]
    pub fn turn_along(&mut self, tangent: Vec3) {
        if tangent != Vec3::ZERO {
            self.frame = self.frame.along(tangent);
        }
    }

    /// True when all of its lobes are delta lobes.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.weighted().all(|(_, lobe)| lobe.is_delta())
    }

    /// f·|wi·n_shade| of all non-delta lobes; for importance f·|wo·n_shade|·|wi·n_geom| / |wo·n_geom|.
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        if self.apart.is_some() {
            return self.eval_and_pdf(wo, wi, mode).0;
        }
        self.seen_along(if mode == TransportMode::Radiance { wo } else { wi }, |frame| {
            if !self.sides_agree(frame.n, wo, wi) {
                return Rgb::BLACK;
            }
            let (local_wo, local_wi) = (frame.to_local(wo), frame.to_local(wi));
            let scattered = self.weighted().map(|(w, lobe)| lobe.eval(local_wo, local_wi, mode) * w).sum();
            self.carried(scattered, frame.n, wo, wi, mode)
        })
    }

    /// The density of [`Bsdf::sample`] over the non-delta lobes.
    pub fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        if self.total_strength <= 0.0 {
            return 0.0;
        }
        if self.apart.is_some() {
            return self.eval_and_pdf(wo, wi, mode).1;
        }
        if self.bends { self.bent_pdf(wo, wi, mode) } else { self.pdf_about(&self.frame, wo, wi) }
    }

    #[inline]
    fn pdf_about(&self, frame: &Frame, wo: Vec3, wi: Vec3) -> f32 {
        self.pdf_of(Lobe::pdf_solid_angle, frame, wo, wi)
    }

    /// The density if each lobe is sampled with the density that `of_lobe` gives.
    #[inline(always)]
    fn pdf_of(&self, of_lobe: impl Fn(&Lobe, Vec3, Vec3) -> f32, frame: &Frame, wo: Vec3, wi: Vec3) -> f32 {
        let risen = self.risen(wo);
        let (wo, wi) = (frame.to_local(wo), frame.to_local(wi));
        let mut pdf = 0.0;
        for (i, lobe) in self.lobes.iter().map_while(|lobe| lobe.as_ref()).enumerate() {
            pdf += (self.strengths[i] + self.rises[i] * risen) * of_lobe(lobe, wo, wi);
        }
        pdf / (self.total_strength + self.total_rise * risen)
    }

    /// [`Bsdf::eval`] and [`Bsdf::pdf_solid_angle`], bit for bit; together they cost little more than one of them.
    #[inline]
    pub fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        if self.is_special() {
            return match self.parts() {
                Some(parts) => parts.eval_and_pdf(wo, wi, mode),
                None => self.bent_eval_and_pdf(wo, wi, mode),
            };
        }
        self.eval_and_pdf_about(&self.frame, wo, wi, mode)
    }

    #[inline(always)]
    fn eval_and_pdf_about(&self, frame: &Frame, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        let risen = self.risen(wo);
        let (local_wo, local_wi) = (frame.to_local(wo), frame.to_local(wi));
        let (mut scattered, mut pdf) = (Rgb::BLACK, 0.0);
        // Most lobes of a sum have the same layers above.
        let (mut cover, mut passed) = (&Coating::NONE, [1.0; 2]);
        for (i, (weight, lobe)) in self.weighted().enumerate() {
            if lobe.cover() != cover {
                cover = lobe.cover();
                passed = cover.passed_along_both(local_wo, local_wi);
            }
            let (f, p) = lobe.eval_and_pdf_below(passed, local_wo, local_wi, mode);
            scattered += f * weight;
            pdf += (self.strengths[i] + self.rises[i] * risen) * p;
        }
        let scattered = if self.sides_agree(frame.n, wo, wi) {
            self.carried(scattered, frame.n, wo, wi, mode)
        } else {
            Rgb::BLACK
        };
        let total = self.total_strength + self.total_rise * risen;
        (scattered, if total > 0.0 { pdf / total } else { 0.0 })
    }

    /// Samples a direction: `u_choice` picks the lobe (and reflection or refraction in it), `u` the direction.
    #[inline]
    pub fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        if let Some(parts) = self.parts() {
            return parts.sample(wo, u_choice, u, mode);
        }
        let sample = self.sample_direction(wo, u_choice, u, mode)?;
        if sample.is_delta {
            return Some(sample);
        }
        let (scattered, pdf_solid_angle) = self.eval_and_pdf(wo, sample.wi, mode);
        let weight = scattered / pdf_solid_angle;
        (pdf_solid_angle > 0.0).then_some(BsdfSample { weight, pdf_solid_angle, ..sample })
    }

    /// [`Bsdf::sample`] about one normal; only for a delta lobe with weight and density.
    #[inline]
    fn sample_direction(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (index, u_choice, share) = self.choose(wo, u_choice)?;
        let chosen = self.lobes[index].as_ref()?;
        if chosen.is_delta() {
            let mut sample = self.sample_delta(chosen, wo, u_choice, mode)?;
            sample.weight *= self.weights[index] / share;
            sample.pdf_solid_angle *= share;
            return (sample.pdf_solid_angle > 0.0).then_some(sample);
        }
        let about = |lobe: &Lobe, frame: &Frame, u_choice: f32| {
            let sample = lobe.sample_direction(frame.to_local(wo), u_choice, u, mode)?;
            Some(BsdfSample { wi: frame.to_world(sample.wi).normalize(), ..sample })
        };
        let mut sample = if self.bends {
            self.sample_bent(chosen, wo, u_choice, mode, about)
        } else {
            about(chosen, &self.frame, u_choice)
        }?;
        if self.bends && !self.keeps_side(wo, &sample) {
            // The sampled normal differs from the visible one, so classify the event by the triangle alone.
            (sample.transmits, sample.eta) = (!sample.transmits, 1.0);
        }
        self.keeps_side(wo, &sample).then_some(sample)
    }

    /// Light scattered about a normal `n`, as radiance or as importance.
    ///
    /// Importance along the surface itself is black instead of infinite.
    #[inline]
    fn carried(&self, scattered: Rgb, n: Vec3, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        if mode == TransportMode::Radiance {
            return scattered;
        }
        let turned = wo.dot(n).abs() * wi.dot(self.n_geom).abs();
        let ratio = turned / (wo.dot(self.n_geom).abs() * wi.dot(n).abs());
        if ratio < MAX_TURNED { scattered * ratio } else { Rgb::BLACK }
    }

    /// True when a reflected direction stays on its side of the triangle, and a transmitted one does not.
    #[inline]
    fn keeps_side(&self, wo: Vec3, sample: &BsdfSample) -> bool {
        (wo.dot(self.n_geom) * sample.wi.dot(self.n_geom) < 0.0) == sample.transmits
    }

    /// Picks a lobe in proportion to its strength; returns it, the rest of the random number, and its probability.
    #[inline]
    fn choose(&self, wo: Vec3, u: f32) -> Option<(usize, f32, f32)> {
        let risen = self.risen(wo);
        let total = self.total_strength + self.total_rise * risen;
        let mut rest = u * total;
        let mut last = None;
        for i in 0..MAX_LOBES {
            let strength = self.strengths[i] + self.rises[i] * risen;
            if strength <= 0.0 {
                continue;
            }
            if rest < strength {
                let left = (rest / strength).clamp(0.0, 1.0 - f32::EPSILON);
                return Some((i, left, strength / total));
            }
            rest -= strength;
            last = Some((i, 1.0 - f32::EPSILON, strength / total));
        }
        last
    }

    /// Both directions must be on the same sides of the triangle and of the interpolated surface `n`, or light leaks through.
    #[inline]
    fn sides_agree(&self, n: Vec3, wo: Vec3, wi: Vec3) -> bool {
        let geometric = wo.dot(self.n_geom) * wi.dot(self.n_geom);
        let shading = wo.dot(n) * wi.dot(n);
        geometric * shading > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    #[test]
    fn both_at_once_are_the_same_bits() {
        let number = |i: u64, k: u64| unit_f32(hash_words([i, k]) as u32) * 2.0 - 1.0;
        let direction = |i, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2)).normalize();
        let cases: Vec<Lobe> = BSDFS.iter().flat_map(|row| (row.cases)()).map(|(_, lobe)| lobe).collect();
        for i in 0..2000 {
            let (wo, wi, n) = (direction(i, 0), direction(i, 3), direction(i, 6));
            for (a, b) in cases.iter().zip(cases.iter().cycle().skip(i as usize % cases.len())) {
                let bsdf = Bsdf::new(n, direction(i, 9), [Some(*a), Some(*b), None]);
                let bsdf = if i % 2 == 0 { bsdf } else { bsdf.bending() };
                let mode = TransportMode::Importance;
                let apart = (bsdf.eval(wo, wi, mode), bsdf.pdf_solid_angle(wo, wi, mode));
                assert_eq!(bsdf.eval_and_pdf(wo, wi, mode), apart);
                let back = bsdf.pdf_solid_angle(wi, wo, mode.reversed());
                let expected = (!apart.0.is_black()).then_some((apart.0, apart.1, back));
                assert_eq!(bsdf.facing(wo, mode).eval_and_pdfs(wi), expected);
                let apart = (a.eval(wo, wi, mode), a.pdf_solid_angle(wo, wi));
                assert_eq!(a.eval_and_pdf(wo, wi, mode), apart);
            }
        }
    }
}

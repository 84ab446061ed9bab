//! A mirror or a smooth boundary between two media, sampled without branches: loops over many compile to vector
//! instructions.

use super::fresnel::{fresnel_dielectric, refract_or_not};
use super::{BsdfSample, TransportMode};
use bilux_math::{Rgb, Vec3};

/// A delta lobe without a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothLobe {
    /// Factor on all light, 0..=1.
    pub tint: Rgb,
    /// Refractive index of the inside over that of the outside; a mirror ignores it.
    pub eta: f32,
    /// Whether it reflects all light.
    pub is_mirror: bool,
    /// Whether it is a pane: both of its faces at once, with light transmitted straight through. [pbrt 2023, 9.5.1]
    pub thin: bool,
}

/// A direction that was sampled for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothSample {
    /// The direction, local and of unit length.
    pub wi: Vec3,
    /// The probability of its event.
    pub probability: f32,
    /// Whether it is the refracted one.
    pub transmits: bool,
    /// The index of the side of `wi` over that of the side of `wo`; 1 for reflection, and through a pane.
    pub eta: f32,
}

impl SmoothLobe {
    /// The number of numbers that it consists of.
    pub const NUMBERS: usize = 6;

    /// All of it, for keeping many in columns.
    #[inline(always)]
    pub fn to_numbers(self) -> [f32; SmoothLobe::NUMBERS] {
        let number = |flag: bool| if flag { 1.0 } else { 0.0 };
        let Rgb { r, g, b } = self.tint;
        [r, g, b, self.eta, number(self.is_mirror), number(self.thin)]
    }

    /// The inverse of [`SmoothLobe::to_numbers`].
    #[inline(always)]
    pub fn from_numbers([r, g, b, eta, is_mirror, thin]: [f32; SmoothLobe::NUMBERS]) -> SmoothLobe {
        SmoothLobe { tint: Rgb::new(r, g, b), eta, is_mirror: is_mirror != 0.0, thin: thin != 0.0 }
    }

    /// Reflects or refracts light known to come along `wo`, by a random number in 0..1.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u_choice: f32) -> SmoothSample {
        let inverse = 1.0 / self.eta;
        let eta = if wo.z > 0.0 { self.eta } else { inverse };
        let of_face = fresnel_dielectric(wo.z.abs(), if self.thin { self.eta } else { eta });
        // Light that bounces between the two faces adds up. [pbrt 2023, eq. 9.12]
        let of_pane = if of_face < 1.0 { 2.0 * of_face / (1.0 + of_face) } else { of_face };
        let of_glass = if self.thin { of_pane } else { of_face };
        let reflected = if self.is_mirror { 1.0 } else { of_glass };
        let (refracted, _) = refract_or_not(wo, Vec3::new(0.0, 0.0, 1f32.copysign(wo.z)), eta);
        let reflects = u_choice < reflected;
        let transmits = !reflects;
        let pick = |through: f32, back: f32| if transmits { through } else { back };
        let through = |straight: f32, bent: f32| if self.thin { straight } else { bent };
        SmoothSample {
            wi: Vec3::new(
                pick(through(-wo.x, refracted.x), -wo.x),
                pick(through(-wo.y, refracted.y), -wo.y),
                pick(through(-wo.z, refracted.z), wo.z),
            ),
            probability: pick(1.0 - reflected, reflected),
            transmits,
            eta: pick(through(1.0, eta), 1.0),
        }
    }

    /// f·|cosθ| over the probability, by which Fresnel's factor cancels. Radiance in a denser medium is more.
    #[inline(always)]
    pub fn weight(&self, sample: &SmoothSample, mode: TransportMode) -> Rgb {
        if mode == TransportMode::Radiance { self.tint / (sample.eta * sample.eta) } else { self.tint }
    }

    /// [`SmoothLobe::sample`] as a [`BsdfSample`].
    #[inline]
    pub(super) fn bsdf_sample(&self, wo: Vec3, u_choice: f32, mode: TransportMode) -> BsdfSample {
        let sample = self.sample(wo, u_choice);
        BsdfSample {
            wi: sample.wi,
            weight: self.weight(&sample, mode),
            pdf_solid_angle: sample.probability,
            is_delta: true,
            transmits: sample.transmits,
            eta: sample.eta,
        }
    }
}

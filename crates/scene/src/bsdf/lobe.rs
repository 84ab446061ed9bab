//! A lobe, one of [`BSDFS`].

use super::{
    BsdfSample, CoatedDielectric, CoatedDiffuse, Conductor, Dielectric, Fuzz, Lambert, MicrofacetReflection,
    Mirror, OpaqueBase, PhongLobe, RoughDielectric, TransportMode,
};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// One scattering lobe, in a local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Lambertian: equal in all directions.
    Lambert(Lambert),
    /// A perfect mirror.
    Mirror(Mirror),
    /// Smooth glass: Fresnel and Snell.
    Dielectric(Dielectric),
    /// A cosine power around the mirrored direction, normalised.
    Phong(PhongLobe),
    /// Metal, smooth or rough.
    Conductor(Conductor),
    /// Rough glass.
    RoughDielectric(RoughDielectric),
    /// Microfacets of glass, metal or both, with multiple scattering between them.
    MicrofacetReflection(MicrofacetReflection),
    /// Metal, or a dielectric above a diffuse base, or both.
    OpaqueBase(OpaqueBase),
    /// Diffuse reflection below a boundary.
    CoatedDiffuse(CoatedDiffuse),
    /// Glass below a coating.
    CoatedDielectric(CoatedDielectric),
    /// Fine upright fibres.
    Fuzz(Fuzz),
}

macro_rules! each_lobe {
    ($lobe:expr, $l:ident => $body:expr) => {
        match $lobe {
            Lobe::Lambert($l) => $body,
            Lobe::Mirror($l) => $body,
            Lobe::Dielectric($l) => $body,
            Lobe::Phong($l) => $body,
            Lobe::Conductor($l) => $body,
            Lobe::RoughDielectric($l) => $body,
            Lobe::MicrofacetReflection($l) => $body,
            Lobe::OpaqueBase($l) => $body,
            Lobe::CoatedDiffuse($l) => $body,
            Lobe::CoatedDielectric($l) => $body,
            Lobe::Fuzz($l) => $body,
        }
    };
}

impl Lobe {
    /// f·|cosθi|; black for delta lobes. For importance, f is evaluated with the two directions exchanged.
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        each_lobe!(self, l => l.eval(wo, wi, mode))
    }

    /// Density of [`Lobe::sample`]; zero for delta lobes.
    pub fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        each_lobe!(self, l => l.pdf_solid_angle(wo, wi))
    }

    /// [`Lobe::eval`] and [`Lobe::pdf_solid_angle`], bit for bit; together they cost little more than one of them.
    #[inline]
    pub fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        each_lobe!(self, l => l.eval_and_pdf(wo, wi, mode))
    }

    /// Samples a direction; `None` where nothing is scattered.
    #[inline]
    pub fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        each_lobe!(self, l => l.sample(wo, u_choice, u, mode))
    }

    /// The direction of [`Lobe::sample`] for a lobe that is not a delta lobe. What it scatters there is not evaluated
    /// where that would take long: sums of lobes evaluate all of them anyway.
    #[inline]
    pub(super) fn sample_direction(
        &self,
        wo: Vec3,
        u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        match self {
            Lobe::OpaqueBase(lobe) => BsdfSample::direction(wo, lobe.direction(wo, u_choice, u)),
            Lobe::MicrofacetReflection(lobe) => BsdfSample::direction(wo, lobe.direction(wo, u_choice, u)),
            Lobe::Fuzz(lobe) => BsdfSample::direction(wo, lobe.direction(wo, u)),
            Lobe::CoatedDiffuse(lobe) => {
                let (wi, transmits) = lobe.direction(wo, u_choice, u);
                let above = if transmits { wi * Vec3::new(1.0, 1.0, -1.0) } else { wi };
                BsdfSample::direction(wo, above).map(|sample| BsdfSample { wi, transmits, ..sample })
            }
            Lobe::RoughDielectric(glass) => glass.direction(wo, u_choice, u),
            Lobe::CoatedDielectric(lobe) => lobe.glass().direction(wo, u_choice, u),
            _ => self.sample(wo, u_choice, u, mode),
        }
    }

    /// The direction in which a delta lobe transmits light known to come along `wo`, however little it is.
    #[inline]
    pub(super) fn transmitted(&self, wo: Vec3) -> Option<Vec3> {
        match self {
            Lobe::Dielectric(lobe) => lobe.transmitted(wo),
            Lobe::CoatedDielectric(lobe) => lobe.transmitted(wo),
            _ => None,
        }
    }

    /// The index and dispersion of a lobe that transmits light into an interior; `None` for a thin wall.
    #[inline]
    pub(super) fn index(&self) -> Option<(f32, f32)> {
        let (eta, dispersion, thin) = match self {
            Lobe::Dielectric(glass) => (glass.eta, glass.dispersion, glass.thin),
            Lobe::RoughDielectric(glass) => (glass.eta, glass.dispersion, glass.thin),
            Lobe::CoatedDielectric(lobe) => (lobe.glass().eta, lobe.glass().dispersion, lobe.glass().thin),
            _ => return None,
        };
        (!thin).then_some((eta, dispersion))
    }

    /// Replaces the index of a dielectric.
    pub(super) fn of_index(self, eta: f32) -> Lobe {
        match self {
            Lobe::Dielectric(glass) => Lobe::Dielectric(glass.of_index(eta)),
            Lobe::RoughDielectric(glass) => glass.of_index(eta),
            Lobe::CoatedDielectric(clear) => Lobe::CoatedDielectric(clear.of_index(eta)),
            other => other,
        }
    }

    /// True for a delta lobe.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Lobe::Mirror(_) | Lobe::Dielectric(_) => true,
            Lobe::Conductor(lobe) => lobe.facets.is_smooth(),
            Lobe::MicrofacetReflection(lobe) => lobe.is_delta(),
            Lobe::CoatedDielectric(lobe) => lobe.is_delta(),
            Lobe::Lambert(_)
            | Lobe::Phong(_)
            | Lobe::RoughDielectric(_)
            | Lobe::OpaqueBase(_)
            | Lobe::CoatedDiffuse(_)
            | Lobe::Fuzz(_) => false,
        }
    }

    /// Approximately how much light the lobe scatters, which is the weight for choosing it.
    #[inline]
    pub fn strength(&self) -> f32 {
        each_lobe!(self, l => l.strength())
    }

    /// Increase of the scattered light at grazing angles over [`Lobe::strength`], which is given; negative for less light.
    #[inline]
    pub(super) fn rise(&self, strength: f32) -> f32 {
        match self {
            Lobe::MicrofacetReflection(lobe) => lobe.rise(strength),
            Lobe::CoatedDiffuse(lobe) => lobe.rise(strength),
            Lobe::Fuzz(lobe) => lobe.rise(strength),
            _ => 0.0,
        }
    }
}

/// A row of [`BSDFS`].
#[derive(Clone, Copy, Debug)]
pub struct BsdfEntry {
    /// Name, summary, source.
    pub entry: Entry,
    /// True when eval(a, b) · |cos b| = eval(b, a) · |cos a| is guaranteed.
    pub reciprocal: bool,
    /// True when a white lobe loses no light.
    pub lossless: bool,
    /// Cases for the contract tests: a name and a lobe.
    pub cases: fn() -> Vec<(&'static str, Lobe)>,
}

/// All lobes.
pub static BSDFS: &[BsdfEntry] = &[
    super::lambert::ENTRY,
    super::mirror::ENTRY,
    super::conductor::ENTRY,
    super::dielectric::ENTRY,
    super::rough_dielectric::ENTRY,
    super::phong_lobe::ENTRY,
    super::microfacet_reflection::ENTRY,
    super::opaque_base::ENTRY,
    super::coated_diffuse::ENTRY,
    super::coated_dielectric::ENTRY,
    super::fuzz::ENTRY,
];

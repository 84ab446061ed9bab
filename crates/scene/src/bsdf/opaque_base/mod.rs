//! The opaque base of OpenPBR, which is what most glTF files ask for: microfacets of metal, or of a dielectric above a
//! diffuse base, or a mixture of both, without anything on top. [OpenPBR 1.1; Kulla 2017]
//!
//! It scatters like the sum of [`MicrofacetReflection`](super::MicrofacetReflection) and
//! [`CoatedDiffuse`](super::CoatedDiffuse), isotropic and rough. Directions come from two densities: microfacets that
//! `wo` sees, and the cosine for all that is diffuse: the base, and light that bounces between the microfacets of metal.
//!
//! No expression here has a branch, so that loops over many points can be vectorised: one lobe and many give the same
//! bits.

mod numbers;

use super::albedo::{Albedo, AlbedoTable};
use super::facets::MIN_ALPHA;
use super::fresnel::{COS_82, dent, fresnel_on_denser, schlick_from};
use super::{BsdfEntry, BsdfSample, Lobe, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::transcendental::sin_cos_of_turns;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use std::f32::consts::FRAC_1_PI;

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "opaque base",
        summary: "rough metal, a rough dielectric above a diffuse base, or a mixture",
        source: "OpenPBR 1.1",
        parameters: &[],
    },
    reciprocal: true,
    lossless: true,
    cases: || {
        let plastic = OpaqueBaseInputs {
            base_color: Rgb::new(0.9, 0.5, 0.2),
            metalness: 0.0,
            specular_weight: 1.0,
            specular_color: Rgb::WHITE,
            roughness: 0.3,
            ior: 1.5,
        };
        let metal = OpaqueBaseInputs { metalness: 1.0, ..plastic };
        let white = OpaqueBaseInputs { base_color: Rgb::WHITE, ..plastic };
        let of = |inputs: OpaqueBaseInputs| Lobe::OpaqueBase(OpaqueBase::new(&inputs));
        vec![
            ("plastic", of(plastic)),
            ("satin plastic", of(OpaqueBaseInputs { roughness: 0.25, ..plastic })),
            ("chalk", of(OpaqueBaseInputs { roughness: 1.0, specular_weight: 0.0, ..plastic })),
            ("tinted", of(OpaqueBaseInputs { specular_color: Rgb::new(0.2, 1.0, 0.5), ior: 1.8, ..plastic })),
            ("gold", of(OpaqueBaseInputs { specular_color: Rgb::new(0.9, 1.0, 0.8), ..metal })),
            ("rough gold", of(OpaqueBaseInputs { roughness: 0.9, ..metal })),
            ("half gold", of(OpaqueBaseInputs { metalness: 0.5, ..plastic })),
            ("black", of(OpaqueBaseInputs { base_color: Rgb::BLACK, specular_weight: 0.0, ..plastic })),
            // The alphas of microfacet reflection's white cases. By the table of albedos, others lose or win a thousandth.
            ("white metal", of(OpaqueBaseInputs { metalness: 1.0, roughness: 0.08f32.sqrt(), ..white })),
            (
                "white metal, rough",
                of(OpaqueBaseInputs { metalness: 1.0, roughness: 0.4f32.sqrt(), ..white }),
            ),
            ("white plastic", of(OpaqueBaseInputs { roughness: 0.4, ..white })),
        ]
    },
};

/// Inputs of the lobe at a point, from textures and numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpaqueBaseInputs {
    /// Colour of the diffuse base, and of metal at normal incidence, 0..=1.
    pub base_color: Rgb,
    /// The fraction of the surface that is metal, 0..=1.
    pub metalness: f32,
    /// The factor on specular reflection at normal incidence, 0..=1.
    pub specular_weight: f32,
    /// The colour of specular reflection; of metal, near grazing angles. 0..=1.
    pub specular_color: Rgb,
    /// The square root of GGX's alpha, 0..=1, of a surface that is not polished (see [`is_rough`]).
    pub roughness: f32,
    /// The refractive index of the dielectric, at least 1.
    pub ior: f32,
}

/// False for the roughness of a polished surface, whose reflection is a delta lobe: an [`OpaqueBase`] has none.
#[inline]
pub fn is_rough(roughness: f32) -> bool {
    roughness * roughness >= MIN_ALPHA
}

impl OpaqueBaseInputs {
    /// The amplitude that the boundary reflects at normal incidence. [OpenPBR 1.1, eq. 27]
    #[inline(always)]
    fn amplitude(&self) -> f32 {
        self.specular_weight.sqrt() * (self.ior - 1.0) / (self.ior + 1.0)
    }

    /// The albedo of the microfacets.
    #[inline(always)]
    fn albedo(&self) -> Albedo {
        let amplitude = self.amplitude();
        Albedo::of_alpha(self.roughness * self.roughness, (1.0 + amplitude) / (1.0 - amplitude))
    }

    /// Albedos from the table, for a point whose normal makes the cosine `cos_o` with `wo`. This look-up is apart from everything
    /// else because not every machine looks up many at a time.
    #[inline(always)]
    pub fn look_up(&self, cos_o: f32, table: &AlbedoTable) -> OpaqueBaseAlbedos {
        let albedo = self.albedo();
        let [_, at_normal] = albedo.pair_at(table, 1.0);
        OpaqueBaseAlbedos {
            mean: albedo.pair_mean(table),
            at_normal,
            along_wo: albedo.pair_at(table, cos_o.abs()),
        }
    }
}

/// Reflected fractions of light: of opaque microfacets, then of the dielectric's.
#[derive(Clone, Copy, Debug)]
pub struct OpaqueBaseAlbedos {
    /// Over the hemisphere.
    pub mean: [f32; 2],
    /// Of the dielectric's, at normal incidence.
    pub at_normal: f32,
    /// Along `wo`.
    pub along_wo: [f32; 2],
}

/// The lobe, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpaqueBase {
    inputs: OpaqueBaseInputs,
    /// [`OpaqueBaseAlbedos::mean`].
    mean: [f32; 2],
    /// [`OpaqueBaseAlbedos::at_normal`].
    at_normal: f32,
    strength: f32,
}

impl OpaqueBase {
    /// The lobe at a point with these inputs, which [are rough](is_rough).
    pub fn new(inputs: &OpaqueBaseInputs) -> OpaqueBase {
        let albedos = inputs.look_up(1.0, AlbedoTable::shared());
        let OpaqueBaseAlbedos { mean, at_normal, .. } = albedos;
        let strength = OpaqueBaseForWo::new(inputs, Vec3::Z, &albedos).strength();
        OpaqueBase { inputs: *inputs, mean, at_normal, strength }
    }

    pub(super) fn facing(&self, wo: Vec3) -> OpaqueBaseForWo {
        let OpaqueBase { inputs, mean, at_normal, .. } = *self;
        let along_wo = inputs.albedo().pair_at(AlbedoTable::shared(), wo.z.abs());
        OpaqueBaseForWo::new(&inputs, wo, &OpaqueBaseAlbedos { mean, at_normal, along_wo })
    }

    /// True for white metal, which reflects all light.
    pub fn is_white(&self) -> bool {
        let OpaqueBaseInputs { base_color, metalness, specular_weight, specular_color, .. } = self.inputs;
        metalness == 1.0 && specular_weight == 1.0 && base_color == Rgb::WHITE && specular_color == Rgb::WHITE
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.facing(wo).pdf_solid_angle(wi)
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> (Rgb, f32) {
        let facing = self.facing(wo);
        facing.eval_and_pdf(wi, facing.look_up(wi.z, AlbedoTable::shared()))
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, _: TransportMode) -> Option<BsdfSample> {
        let facing = self.facing(wo);
        let wi = facing.sample(u_choice, u);
        let (f, pdf_solid_angle) = facing.eval_and_pdf(wi, facing.look_up(wi.z, AlbedoTable::shared()));
        BsdfSample::reflected(wi, f, pdf_solid_angle)
    }

    /// The direction of [`OpaqueBase::sample`].
    #[inline]
    pub(super) fn direction(&self, wo: Vec3, u_choice: f32, u: Vec2) -> Vec3 {
        self.facing(wo).sample(u_choice, u)
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.strength
    }
}

/// An [`OpaqueBase`] with its `wo`.
#[derive(Clone, Copy, Debug)]
pub struct OpaqueBaseForWo {
    wo: Vec3,
    alpha: f32,
    /// The index of the dielectric.
    eta: f32,
    /// A factor on the dielectric's reflection.
    glass: Rgb,
    /// Reflectance of the metal at normal incidence, and what is subtracted near grazing.
    straight: Rgb,
    dip: Rgb,
    metalness: f32,
    albedo: Albedo,
    /// The colour of multiple scattering along `wo`, divided by the fraction that a single bounce along `wi` loses.
    again: Rgb,
    /// The diffuse reflectance times the fraction of light along `wo` that gets in, over the mean transmittance.
    base: Rgb,
    /// [`shadow`] of `wo`.
    shadow: f32,
    /// The part of the cap of visible microfacets that is sampled.
    bound: f32,
    /// The probability of sampling a microfacet.
    gloss_share: f32,
    /// See [`OpaqueBaseForWo::strength`].
    strength: f32,
}

impl OpaqueBaseForWo {
    /// The lobe with these inputs, which [are rough](is_rough), for light known to come along `wo`, in the local frame.
    #[inline(always)]
    pub fn new(inputs: &OpaqueBaseInputs, wo: Vec3, albedos: &OpaqueBaseAlbedos) -> OpaqueBaseForWo {
        let OpaqueBaseInputs { base_color, metalness, specular_weight, specular_color, roughness, .. } =
            *inputs;
        let OpaqueBaseAlbedos { mean: [opaque_mean, mean], at_normal, along_wo: [opaque, boundary] } =
            *albedos;
        let (alpha, opacity, amplitude) = (roughness * roughness, 1.0 - metalness, inputs.amplitude());
        // Without a boundary there is no reflection at it.
        let glass = specular_color * if amplitude > 0.0 { opacity } else { 0.0 };
        let straight = base_color * specular_weight;
        let dip = schlick_from(straight, COS_82) * (Rgb::WHITE - specular_color) * (1.0 / dent(COS_82));
        // ∫ (1-µ)⁵ 2µ dµ and ∫ µ (1-µ)⁶ 2µ dµ
        let metal_mean = straight.lerp(Rgb::WHITE, 1.0 / 21.0) + dip * (-1.0 / 126.0);
        let comes_out = metal_mean.map(|f| f * f * opaque_mean / (1.0 - f * (1.0 - opaque_mean)) * metalness);
        let base = base_color * (opacity / (1.0 - mean).max(f32::MIN_POSITIVE));
        let gloss_strength = (straight * metalness + glass * (amplitude * amplitude)).luminance();
        let base_strength = base.luminance() * (1.0 - at_normal);

        let above = Vec3::new(wo.x, wo.y, wo.z.abs());
        let a2 = alpha * alpha;
        // The part of the cap of visible microfacets that can reflect `wo` upwards. [Eto 2023, eq. 5]
        let across = 1.0 + (1.0 - above.z * above.z).max(0.0).sqrt();
        let s2 = across * across;
        let left = 1.0 - opaque;
        // Schlick's power: microfacets reflect more light towards grazing, smoother ones gain more, and the base
        // scatters nearly none.
        let m = (1.0 - above.z).max(0.0);
        let risen = (m * m) * (m * m) * m;
        let rise = ((glass + Rgb::grey(metalness)).luminance() - gloss_strength).max(0.0) * (1.0 - alpha);
        let gloss = gloss_strength + rise * risen;
        let again_share = (comes_out.luminance() / gloss_strength.max(f32::MIN_POSITIVE)).min(1.0);
        let single = gloss * (1.0 - again_share * left);
        let all = gloss + base_strength * (1.0 - 0.9 * risen);
        OpaqueBaseForWo {
            wo,
            alpha,
            eta: (1.0 + amplitude) / (1.0 - amplitude),
            glass,
            straight,
            dip,
            metalness,
            albedo: inputs.albedo(),
            again: comes_out * (left / (1.0 - opaque_mean).max(1e-6)),
            base: base * (1.0 - boundary),
            shadow: shadow(a2, above),
            bound: (1.0 - a2) * s2 / (s2 + a2 * above.z * above.z),
            gloss_share: if all > 0.0 { (single / all).clamp(0.0, 1.0) } else { 0.0 },
            strength: gloss_strength + base_strength,
        }
    }

    /// About how much light the lobe scatters at normal incidence; see [`Lobe::strength`].
    #[inline(always)]
    pub fn strength(&self) -> f32 {
        self.strength
    }

    /// Albedos from the table, for a direction whose cosine with the normal is `cos_i`.
    #[inline(always)]
    pub fn look_up(&self, cos_i: f32, table: &AlbedoTable) -> [f32; 2] {
        self.albedo.pair_at(table, cos_i.abs())
    }

    /// f·|cosθi|, and the density of [`OpaqueBaseForWo::sample`] over solid angle; both are zero where the directions are
    /// on different sides. The albedos are those that [`OpaqueBaseForWo::look_up`] gives for `wi`.
    #[inline(always)]
    pub fn eval_and_pdf(&self, wi: Vec3, [opaque, boundary]: [f32; 2]) -> (Rgb, f32) {
        let is_lit = self.wo.z * wi.z > 0.0;
        let (wo, wi) = (Vec3::new(self.wo.x, self.wo.y, self.wo.z.abs()), Vec3::new(wi.x, wi.y, wi.z.abs()));
        let a2 = self.alpha * self.alpha;
        let (m, distribution) = self.microfacets(wo, wi);
        // [Heitz 2014, eq. 99]
        let visible = 0.5 * wi.z / (self.shadow * wi.z + shadow(a2, wi) * wo.z);
        let single = self.fresnel(wo.dot(m)) * (distribution * visible);
        let cosine = FRAC_1_PI * wi.z;
        let scattered =
            single + self.again * ((1.0 - opaque) * cosine) + self.base * ((1.0 - boundary) * cosine);
        let pdf = self.density(wo, distribution, cosine);
        let of = |x: f32| if is_lit { x } else { 0.0 };
        (Rgb::new(of(scattered.r), of(scattered.g), of(scattered.b)), of(pdf))
    }

    /// The density alone.
    #[inline]
    pub(super) fn pdf_solid_angle(&self, wi: Vec3) -> f32 {
        let is_lit = self.wo.z * wi.z > 0.0;
        let (wo, wi) = (Vec3::new(self.wo.x, self.wo.y, self.wo.z.abs()), Vec3::new(wi.x, wi.y, wi.z.abs()));
        let (_, distribution) = self.microfacets(wo, wi);
        if is_lit { self.density(wo, distribution, FRAC_1_PI * wi.z) } else { 0.0 }
    }

    /// The normal of the microfacets that reflect between two directions above the surface, and their density. [Walter
    /// 2007, eq. 33]
    #[inline(always)]
    fn microfacets(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let a2 = self.alpha * self.alpha;
        let half = wo + wi;
        let m = half * (1.0 / half.length_squared().sqrt());
        let q = (m.x * m.x + m.y * m.y) / a2 + m.z * m.z;
        (m, FRAC_1_PI / (a2 * q * q))
    }

    /// The mean of two densities: of reflections at microfacets [Eto 2023, eq. 8], and one in proportion to the cosine.
    #[inline(always)]
    fn density(&self, wo: Vec3, distribution: f32, cosine: f32) -> f32 {
        let microfacet = distribution * 0.5 / (self.bound * wo.z + self.shadow);
        self.gloss_share * microfacet + (1.0 - self.gloss_share) * cosine
    }

    /// A direction: `u_choice` picks one of the two densities, `u` the direction. It may be below the surface, where
    /// the density is zero.
    #[inline(always)]
    pub fn sample(&self, u_choice: f32, u: Vec2) -> Vec3 {
        let alpha = self.alpha;
        let wo = Vec3::new(self.wo.x, self.wo.y, self.wo.z.abs());
        // A microfacet that `wo` sees, as a point of a spherical cap. [Dupuy 2023]
        let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z);
        let above = stretched * (1.0 / stretched.length_squared().sqrt());
        let lowest = self.bound * above.z;
        let z = (1.0 - u.y) * (1.0 + lowest) - lowest;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos_of_turns(u.x);
        let half = Vec3::new(r * cos, r * sin, z) + above;
        let m = Vec3::new(alpha * half.x, alpha * half.y, half.z.max(f32::MIN_POSITIVE));
        let m = m * (1.0 / m.length_squared().sqrt());
        let reflected = m * (2.0 * wo.dot(m)) - wo;
        let diffuse = warp::sample_cosine_hemisphere(u);
        let is_gloss = u_choice < self.gloss_share;
        let of = |gloss: f32, diffuse: f32| if is_gloss { gloss } else { diffuse };
        let z = of(reflected.z, diffuse.z);
        Vec3::new(of(reflected.x, diffuse.x), of(reflected.y, diffuse.y), z * 1f32.copysign(self.wo.z))
    }

    /// The reflectance of a microfacet.
    #[inline(always)]
    fn fresnel(&self, cos: f32) -> Rgb {
        let cos = cos.clamp(0.0, 1.0);
        let metal = (schlick_from(self.straight, cos) + self.dip * -dent(cos)).map(|c| c.clamp(0.0, 1.0));
        metal * self.metalness + self.glass * fresnel_on_denser(cos, self.eta)
    }
}

/// The length of a stretched direction. [Heitz 2014, eq. 72]
#[inline(always)]
fn shadow(a2: f32, v: Vec3) -> f32 {
    (a2 * (v.x * v.x + v.y * v.y) + v.z * v.z).sqrt()
}

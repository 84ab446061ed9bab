//! The clear part of a surface: smooth or rough glass, solid or thin-walled, below a coating.

use super::{
    BsdfEntry, BsdfSample, Coating, Dielectric, Ggx, Lobe, RoughDielectric, ThinFilm, TransportMode,
};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3};

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "coated dielectric",
        summary: "dielectric transmission, smooth or rough, below a coat",
        source: "Walter 2007",
        parameters: &[],
    },
    reciprocal: false,
    lossless: false,
    cases: || {
        let coat = Coating::coat(1.0, super::Albedo::new(&Ggx::new(0.1), 1.6));
        let glass = |ggx, thin, cover| {
            Lobe::CoatedDielectric(CoatedDielectric::new(
                (1.5, 0.0),
                ggx,
                thin,
                Rgb::grey(0.9),
                Rgb::new(0.5, 0.8, 0.9),
                cover,
            ))
        };
        let oily = |ggx, thin| {
            let film = ThinFilm { weight: 0.9, thickness: 380.0, eta: 1.8 };
            let clear = CoatedDielectric::new((1.4, 0.0), ggx, thin, Rgb::WHITE, Rgb::WHITE, Coating::NONE);
            Lobe::CoatedDielectric(clear.below(film))
        };
        vec![
            ("oily glass", oily(Ggx::SMOOTH, false)),
            ("oily pane", oily(Ggx::SMOOTH, true)),
            ("oily frosted glass", oily(Ggx::new(0.2), false)),
            ("oily frosted pane", oily(Ggx::new(0.3), true)),
            ("bottle", glass(Ggx::SMOOTH, false, Coating::NONE)),
            ("coated glass", glass(Ggx::new(0.2), false, coat)),
            ("coated pane", glass(Ggx::new(0.3), true, coat)),
        ]
    },
};

/// Glass with separate tints for reflected and transmitted light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedDielectric {
    /// The bare glass, smooth or rough, without its coating.
    glass: RoughDielectric,
    reflected: Rgb,
    passed: Rgb,
    cover: Coating,
}

impl CoatedDielectric {
    /// Glass of a relative index (inside over outside) and a dispersion; `thin` for a thin pane; `reflected` and
    /// `passed` are factors on reflected and transmitted light, 0..=1.
    pub fn new(
        index: (f32, f32),
        ggx: Ggx,
        thin: bool,
        reflected: Rgb,
        passed: Rgb,
        cover: Coating,
    ) -> CoatedDielectric {
        let (eta, dispersion) = index;
        let glass =
            RoughDielectric { eta, dispersion, tint: Rgb::WHITE, thin, facets: ggx.into(), film: None };
        CoatedDielectric { glass, reflected, passed, cover }
    }

    /// Puts a thin film on the glass.
    pub fn below(self, film: ThinFilm) -> CoatedDielectric {
        CoatedDielectric { glass: RoughDielectric { film: Some(film), ..self.glass }, ..self }
    }

    /// The glass that refracts, without its coating.
    #[inline]
    pub(super) fn glass(&self) -> &RoughDielectric {
        &self.glass
    }

    /// Replaces the index.
    pub(super) fn of_index(self, eta: f32) -> CoatedDielectric {
        CoatedDielectric { glass: RoughDielectric { eta, ..self.glass }, ..self }
    }

    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        !RoughDielectric::is_rough(self.glass.eta, self.glass.thin, &self.glass.facets)
    }

    #[inline]
    fn smooth(&self) -> Dielectric {
        let RoughDielectric { eta, dispersion, tint, thin, film, .. } = self.glass;
        Dielectric { eta, dispersion, tint, thin, film }
    }

    /// The direction in which smooth glass transmits light.
    #[inline]
    pub(super) fn transmitted(&self, wo: Vec3) -> Option<Vec3> {
        if self.is_delta() { self.smooth().transmitted(wo) } else { None }
    }

    /// The layers above.
    #[inline]
    pub(super) fn cover(&self) -> &Coating {
        &self.cover
    }

    /// The factor on light between two directions, by what the coating lets pass along them. The inside of solid glass has no
    /// coating.
    #[inline]
    fn left(&self, passed: [f32; 2], wo: Vec3, wi: Vec3) -> Rgb {
        let tint = if wo.z * wi.z > 0.0 { self.reflected } else { self.passed };
        if self.cover.is_none() {
            return tint;
        }
        let covered = |v: Vec3| v.z > 0.0 || self.glass.thin;
        let [passed_wo, passed_wi] =
            [(wo, passed[0]), (wi, passed[1])].map(|(v, passed)| if covered(v) { passed } else { 1.0 });
        tint * passed_wo.min(passed_wi)
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        self.eval_and_pdf(wo, wi, mode).0
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_delta() { 0.0 } else { self.glass.pdf_solid_angle(wo, wi) }
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        self.eval_and_pdf_below(self.cover.passed_along_both(wo, wi), wo, wi, mode)
    }

    /// [`CoatedDielectric::eval_and_pdf`] by what the coating lets pass along both directions.
    pub(super) fn eval_and_pdf_below(
        &self,
        passed: [f32; 2],
        wo: Vec3,
        wi: Vec3,
        mode: TransportMode,
    ) -> (Rgb, f32) {
        if self.is_delta() {
            return (Rgb::BLACK, 0.0);
        }
        let (f, pdf) = self.glass.eval_and_pdf(wo, wi, mode);
        (f * self.left(passed, wo, wi), pdf)
    }

    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let sample = if self.is_delta() {
            self.smooth().sample(wo, u_choice, u, mode)
        } else {
            self.glass.sample(wo, u_choice, u, mode)
        }?;
        let passed = self.cover.passed_along_both(wo, sample.wi);
        Some(BsdfSample { weight: sample.weight * self.left(passed, wo, sample.wi), ..sample })
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.reflected.luminance().max(self.passed.luminance())
    }
}

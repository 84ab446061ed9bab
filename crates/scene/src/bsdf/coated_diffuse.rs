//! Diffuse reflection below a boundary and a coating: all of the light that they let through is scattered, and comes
//! out again. [Kulla 2017] A rough base scatters like [`RoughDiffuse`]: its light is scaled like a Lambertian one's, so
//! that no more comes out than went in.

use super::nodes::{NODES, light_at_nodes};
use super::{Albedo, BsdfEntry, BsdfSample, Coating, FuzzAlbedo, Ggx, Lobe, RoughDiffuse, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use std::f32::consts::FRAC_1_PI;

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "coated diffuse",
        summary: "diffuse reflection below a dielectric coating",
        source: "Kulla 2017",
        parameters: &[],
    },
    reciprocal: true,
    lossless: false,
    cases: || {
        let paint = |alpha: f32, cover| {
            let below = Albedo::new(&Ggx::new(alpha), 1.5);
            Lobe::CoatedDiffuse(CoatedDiffuse::new(Rgb::new(0.9, 0.5, 0.2), below, cover))
        };
        let leaf = |cover| {
            let (green, light) = (Rgb::new(0.2, 0.5, 0.1), Rgb::new(0.4, 0.5, 0.1));
            Lobe::CoatedDiffuse(CoatedDiffuse::sheet(green, light, Albedo::new(&Ggx::new(0.3), 1.4), cover))
        };
        vec![
            ("leaf", leaf(Coating::NONE)),
            ("leaf with a bloom", leaf(Coating::NONE.below(0.7, FuzzAlbedo::new(0.4)))),
            (
                "clay",
                Lobe::CoatedDiffuse(CoatedDiffuse::new(CLAY, Albedo::NONE, Coating::NONE).rough(1.0, CLAY)),
            ),
            ("rough clay, glazed", {
                let glaze = Albedo::new(&Ggx::new(0.0), 1.5);
                Lobe::CoatedDiffuse(CoatedDiffuse::new(CLAY, glaze, Coating::NONE).rough(0.5, CLAY))
            }),
            ("polished paint", paint(0.0, Coating::NONE)),
            ("rough paint", paint(0.4, Coating::NONE)),
            ("coated paint", paint(0.2, Coating::coat(0.8, Albedo::new(&Ggx::new(0.05), 1.6)))),
        ]
    },
};

const CLAY: Rgb = Rgb { r: 0.9, g: 0.6, b: 0.4 };

/// Diffuse reflection below a boundary, the same on both sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedDiffuse {
    /// The reflected fraction of the light that reaches the base, divided by the mean transmittance.
    scale: Rgb,
    /// `scale` for light that leaves on the other side.
    through: Rgb,
    /// The reflectance of the boundary.
    boundary: Albedo,
    cover: Coating,
    rough_diffuse: Option<RoughDiffuse>,
}

impl CoatedDiffuse {
    /// Reflects `albedo`, 0..=1, of the light that passes the boundary and the coating.
    pub fn new(albedo: Rgb, boundary: Albedo, cover: Coating) -> CoatedDiffuse {
        CoatedDiffuse::sheet(albedo, Rgb::BLACK, boundary, cover)
    }

    /// A sheet of paper or a leaf: reflects one fraction of the light that enters it, and transmits another.
    ///
    /// The two are at most 1 together.
    pub fn sheet(reflected: Rgb, passed: Rgb, boundary: Albedo, cover: Coating) -> CoatedDiffuse {
        CoatedDiffuse::sheet_of([reflected, passed], boundary, cover, None)
    }

    /// [`CoatedDiffuse::sheet`], perhaps with a [rough base](CoatedDiffuse::rough) of this roughness, above 0, and colour.
    pub(crate) fn sheet_of(
        [reflected, passed]: [Rgb; 2],
        boundary: Albedo,
        cover: Coating,
        rough: Option<(f32, Rgb)>,
    ) -> CoatedDiffuse {
        let sheet = CoatedDiffuse { scale: reflected, through: passed, boundary, cover, rough_diffuse: None };
        let (is_covered, mut light) = (!cover.is_none(), [0.0; NODES]);
        if is_covered || rough.is_some() {
            light = sheet.light_at_nodes();
        }
        // ∫ g(µ) 2µ dµ with µ = t²
        let mean = if is_covered { light.iter().sum() } else { 1.0 - boundary.mean() };
        let scale = 1.0 / mean.max(f32::MIN_POSITIVE);
        let rough_diffuse = rough.map(|(roughness, colour)| RoughDiffuse::new(roughness, colour, &light));
        CoatedDiffuse { scale: reflected * scale, through: passed * scale, rough_diffuse, ..sheet }
    }

    /// The light that reaches the base at each node of a quadrature over t, the root of the cosine, with its weight.
    fn light_at_nodes(&self) -> [f32; NODES] {
        let (boundary, passed) = (self.boundary.at_nodes(), self.cover.passed_at_nodes());
        light_at_nodes(&std::array::from_fn(|i| (1.0 - boundary[i]) * passed[i]))
    }

    /// Gives the lobe a rough base, roughness 0..=1; `colour` is the reflectance of the base without any weights.
    pub fn rough(self, roughness: f32, colour: Rgb) -> CoatedDiffuse {
        let rough_diffuse = RoughDiffuse::new(roughness, colour, &self.light_at_nodes());
        CoatedDiffuse { rough_diffuse: (roughness > 0.0).then_some(rough_diffuse), ..self }
    }

    /// The probability of sampling a direction on the other side.
    #[inline]
    fn share_through(&self) -> f32 {
        if self.through.is_black() {
            return 0.0;
        }
        self.through.luminance() / (self.through.luminance() + self.scale.luminance())
    }

    /// The layers above.
    #[inline]
    pub(super) fn cover(&self) -> &Coating {
        &self.cover
    }

    /// The fraction of light that reaches the base when all normals make this cosine with the direction.
    #[inline]
    fn passed(&self, cos: f32) -> f32 {
        (1.0 - self.boundary.at(cos)) * self.cover.passed(cos)
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> Rgb {
        self.eval_below(self.cover.passed_along_both(wo, wi), wo, wi)
    }

    /// [`CoatedDiffuse::eval`] by what the cover lets pass along both directions.
    #[inline]
    fn eval_below(&self, passed: [f32; 2], wo: Vec3, wi: Vec3) -> Rgb {
        let scale = if wo.z * wi.z > 0.0 {
            self.rough_diffuse
                .map_or(self.scale, |rough_diffuse| self.scale * rough_diffuse.over_lambert(wo, wi))
        } else if wo.z * wi.z < 0.0 {
            self.through
        } else {
            return Rgb::BLACK;
        };
        let cos = wi.z.abs();
        let boundary = self.boundary.at_roots([wo, wi].map(|v| v.z.abs().clamp(0.0, 1.0).sqrt()));
        let (passed_wo, passed_wi) = ((1.0 - boundary[0]) * passed[0], (1.0 - boundary[1]) * passed[1]);
        scale * (passed_wo * passed_wi * FRAC_1_PI * cos)
    }

    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        let through = self.share_through();
        let cosine = warp::cosine_hemisphere_pdf_solid_angle(wi.z.abs());
        if wo.z * wi.z <= 0.0 {
            return through * cosine;
        }
        let even = self.rough_diffuse.map_or(0.0, |rough_diffuse| rough_diffuse.uniform_probability(wo));
        (1.0 - through) * (cosine + (0.5 * FRAC_1_PI - cosine) * even)
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        (self.eval(wo, wi, mode), self.pdf_solid_angle(wo, wi))
    }

    /// [`CoatedDiffuse::eval_and_pdf`] by what the cover lets pass along both directions.
    #[inline]
    pub(super) fn eval_and_pdf_below(&self, passed: [f32; 2], wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        (self.eval_below(passed, wo, wi), self.pdf_solid_angle(wo, wi))
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (wi, transmits) = self.direction(wo, u_choice, u);
        let (f, pdf_solid_angle) = self.eval_and_pdf(wo, wi, mode);
        let sample = BsdfSample::reflected(wi, f, pdf_solid_angle)?;
        Some(BsdfSample { transmits, ..sample })
    }

    /// The direction of [`CoatedDiffuse::sample`], and whether it is on the other side.
    pub(super) fn direction(&self, wo: Vec3, u_choice: f32, u: Vec2) -> (Vec3, bool) {
        let through = self.share_through();
        let transmits = u_choice < through;
        let even = self.rough_diffuse.map_or(0.0, |rough_diffuse| rough_diffuse.uniform_probability(wo))
            * (1.0 - through);
        let is_even = !transmits && u_choice - through < even;
        let mut wi = if is_even { warp::sample_cone(u, 0.0) } else { warp::sample_cosine_hemisphere(u) };
        wi.z *= 1f32.copysign(if transmits { -wo.z } else { wo.z });
        (wi, transmits)
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        (self.scale + self.through).luminance() * self.passed(1.0)
    }

    /// Almost no light reaches the base at grazing angles. Keep a tenth, so that no direction is sampled too rarely.
    #[inline]
    pub(super) fn rise(&self, strength: f32) -> f32 {
        -0.9 * strength
    }
}

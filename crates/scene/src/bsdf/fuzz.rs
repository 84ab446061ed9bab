//! Fuzz: fine upright fibres on top of a surface, like velvet's pile or the bloom of a peach. They are visible at
//! grazing angles, and hide what is below them there. [Estevez 2017; Neubelt 2013]

use super::albedo::place;
use super::nodes::{GAUSS, NODES, lerp_nodes};
use super::{BsdfEntry, BsdfSample, Lobe, TransportMode};
use bilux_math::registry::Entry;
use bilux_math::transcendental::{powf, sin_cos};
use bilux_math::{Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};
use std::sync::LazyLock;

/// Row of [`super::BSDFS`].
pub(super) const ENTRY: BsdfEntry = BsdfEntry {
    entry: Entry {
        name: "fuzz",
        summary: "sheen: fine fibres that show at grazing angles",
        source: "Estevez 2017",
        parameters: &[],
    },
    reciprocal: true,
    lossless: false,
    cases: || {
        let velvet = |roughness| Lobe::Fuzz(Fuzz::new(Rgb::new(0.9, 0.6, 0.7), FuzzAlbedo::new(roughness)));
        vec![("silk", velvet(0.2)), ("velvet", velvet(0.5)), ("fur", velvet(1.0))]
    },
};

/// Upright fibres on the surface, the same on both of its sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuzz {
    /// The colour of the fibres, times the fraction of the surface that has them.
    colour: Rgb,
    albedo: FuzzAlbedo,
    /// A factor on light from below.
    from_below: f32,
}

impl Fuzz {
    /// Fuzz from the fibres' colour, 0..=1, and their albedo.
    pub fn new(colour: Rgb, albedo: FuzzAlbedo) -> Fuzz {
        Fuzz { colour, albedo, from_below: 1.0 }
    }

    /// Sets the factor, 0..=1, on light from below the surface.
    pub fn from_below(self, factor: f32) -> Fuzz {
        Fuzz { from_below: factor, ..self }
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3, _mode: TransportMode) -> Rgb {
        if wo.z * wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let side = if wo.z < 0.0 { self.from_below } else { 1.0 };
        let scattered = scattered(self.albedo.inverse_alpha, wo, wi) * self.albedo.scale;
        self.colour * (scattered * side * wi.z.abs())
    }

    /// Uniform, which samples enough directions near the horizon, where fibres are visible.
    #[inline]
    pub(super) fn pdf_solid_angle(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wo.z * wi.z > 0.0 { 0.5 * FRAC_1_PI } else { 0.0 }
    }

    #[inline]
    pub(super) fn eval_and_pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> (Rgb, f32) {
        (self.eval(wo, wi, mode), self.pdf_solid_angle(wo, wi))
    }

    #[inline]
    pub(super) fn sample(
        &self,
        wo: Vec3,
        _u_choice: f32,
        u: Vec2,
        mode: TransportMode,
    ) -> Option<BsdfSample> {
        let wi = self.direction(wo, u);
        BsdfSample::reflected(wi, self.eval(wo, wi, mode), self.pdf_solid_angle(wo, wi))
    }

    /// The direction of [`Fuzz::sample`].
    #[inline]
    pub(super) fn direction(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let z = (1.0 - u.x).max(f32::MIN_POSITIVE);
        let ((sin, cos), radius) = (sin_cos(2.0 * PI * u.y), (1.0 - z * z).max(0.0).sqrt());
        Vec3::new(radius * cos, radius * sin, z.copysign(wo.z))
    }

    #[inline]
    pub(super) fn strength(&self) -> f32 {
        self.colour.luminance() * self.albedo.at(0.5)
    }

    #[inline]
    pub(super) fn rise(&self, strength: f32) -> f32 {
        (self.colour.luminance() * self.albedo.at(0.0) - strength).max(0.0)
    }
}

/// The light that white fibres scatter from `wo` to `wi`, per cosine: their normal distribution [Estevez 2017, eq. 2]
/// and their visibility term [Neubelt 2013].
#[inline]
fn scattered(inverse_alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let (o, i) = (wo.z.abs(), wi.z.abs());
    let Some(m) = (wo + wi).try_normalize() else { return 0.0 };
    let sin = (1.0 - m.z * m.z).max(0.0).sqrt();
    let distribution = (2.0 + inverse_alpha) * powf(sin, inverse_alpha) * (0.5 * FRAC_1_PI);
    distribution / (4.0 * (o + i - o * i)).max(f32::MIN_POSITIVE)
}

/// Square roots of alpha, in uniform steps from 0 to 1.
const ROUGHNESSES: usize = 16;
/// Square roots of cosines, in uniform steps from 0 to 1.
const COSINES: usize = 20;
/// Below this alpha, all fibres would become visible at once at grazing angles.
const MIN_ALPHA: f32 = 0.05;

/// The albedo of the fibres at each cosine, in the steps above.
static TABLE: LazyLock<[[f32; COSINES]; ROUGHNESSES]> = LazyLock::new(|| {
    std::array::from_fn(|row| {
        let inverse = inverse_alpha(row as f32 / (ROUGHNESSES - 1) as f32);
        std::array::from_fn(|column| {
            let root = (column as f32 / (COSINES - 1) as f32).max(0.03);
            all_scattered(inverse, root * root) as f32
        })
    })
});

/// Albedo of the fibres at the nodes of [quadratures](super::nodes).
static AT_NODES: LazyLock<[[f32; NODES]; ROUGHNESSES]> =
    LazyLock::new(|| TABLE.each_ref().map(|row| GAUSS.map(|(root, _)| between_cosines(row, root))));

/// The albedo in a row of the table, by the root of the cosine.
#[inline(always)]
fn between_cosines(row: &[f32; COSINES], root: f32) -> f32 {
    let (column, share) = place(root * (COSINES - 1) as f32, COSINES);
    row[column] + (row[column + 1] - row[column]) * share
}

fn inverse_alpha(roughness: f32) -> f32 {
    1.0 / (roughness * roughness).max(MIN_ALPHA)
}

/// Midpoint rule on a grid over half of the hemisphere, with squared steps to place many samples near the horizon.
fn all_scattered(inverse_alpha: f32, cos: f32) -> f64 {
    const STEPS: [u32; 2] = [32, 32];
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for (i, k) in (0..STEPS[0]).flat_map(|i| (0..STEPS[1]).map(move |k| (i, k))) {
        let t = (i as f32 + 0.5) / STEPS[0] as f32;
        let (z, share) = (t * t, 2.0 * t / STEPS[0] as f32);
        let (sin, cos) = sin_cos(PI * (k as f32 + 0.5) / STEPS[1] as f32);
        let radius = (1.0 - z * z).sqrt();
        let wi = Vec3::new(radius * cos, radius * sin, z);
        sum += f64::from(scattered(inverse_alpha, wo, wi) * z * share);
    }
    sum * 2.0 * f64::from(PI) / f64::from(STEPS[1])
}

/// The distribution of the fibres, and the fraction of light along a direction that white fibres scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuzzAlbedo {
    inverse_alpha: f32,
    /// Position among the table's roughnesses.
    roughness: f32,
    /// Keeps the scattered light at most as large as the incident light.
    scale: f32,
}

impl FuzzAlbedo {
    /// The albedo for a roughness, 0..=1: low for upright fibres, which are visible only at grazing angles.
    pub fn new(roughness: f32) -> FuzzAlbedo {
        let place = roughness.clamp(0.0, 1.0) * (ROUGHNESSES - 1) as f32;
        let unscaled = FuzzAlbedo { inverse_alpha: inverse_alpha(roughness), roughness: place, scale: 1.0 };
        FuzzAlbedo { scale: 1.0 / unscaled.at(0.0).max(1.0), ..unscaled }
    }

    /// The scattered fraction along a direction whose cosine with the normal is `cos`, 0..=1.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        self.at_root(cos.clamp(0.0, 1.0).sqrt())
    }

    /// [`FuzzAlbedo::at`] by the square root of the cosine, 0..=1.
    #[inline(always)]
    fn at_root(&self, root: f32) -> f32 {
        let [found] = self.at_roots([root]);
        found
    }

    /// [`FuzzAlbedo::at_root`] along several directions.
    #[inline(always)]
    pub(super) fn at_roots<const N: usize>(&self, roots: [f32; N]) -> [f32; N] {
        let ((row, share), table) = (self.row(), &*TABLE);
        let mut found = roots;
        for found in &mut found {
            let (a, b) = (between_cosines(&table[row], *found), between_cosines(&table[row + 1], *found));
            *found = (a + (b - a) * share) * self.scale;
        }
        found
    }

    /// [`FuzzAlbedo::at`] at all nodes of [quadratures](super::nodes).
    #[inline]
    pub(super) fn at_nodes(&self) -> [f32; NODES] {
        let ((row, share), table) = (self.row(), &*AT_NODES);
        lerp_nodes(&table[row], &table[row + 1], share).map(|albedo| albedo * self.scale)
    }

    /// The row of the table, and the place between it and the next.
    #[inline(always)]
    fn row(&self) -> (usize, f32) {
        place(self.roughness, ROUGHNESSES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with far more directions, between the table's entries.
    #[test]
    fn fibres_scatter_what_the_table_says() {
        for roughness in [0.1f32, 0.33, 0.52, 0.77, 1.0] {
            let albedo = FuzzAlbedo::new(roughness);
            for cos in [0.02f32, 0.13, 0.4, 0.7, 1.0] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                const N: u32 = 400;
                let sum: f64 = (0..N * N)
                    .map(|i| {
                        let u = Vec2::new((i % N) as f32 + 0.5, (i / N) as f32 + 0.5) / N as f32;
                        let sample =
                            Fuzz::new(Rgb::WHITE, albedo).sample(wo, 0.5, u, TransportMode::Radiance);
                        sample.map_or(0.0, |s| f64::from(s.weight.g))
                    })
                    .sum();
                let (found, said) = (sum / f64::from(N * N), f64::from(albedo.at(cos)));
                assert!((found - said).abs() < 0.012, "{roughness}, {cos}: {found}, {said}");
                assert!(said <= 1.0, "{roughness}, {cos}: {said}");
            }
        }
    }
}

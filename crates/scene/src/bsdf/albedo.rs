//! The fraction of the light along a direction that the microfacets of a rough boundary reflect in a single bounce. The
//! rest enters the layer below, or hits other microfacets that reflect it again. [Kulla 2017]
//!
//! It is computed by quadrature on first use, and stored as a table over the cosine, the roughness and the index.
//! Fresnel's reflectance is split into its value at normal incidence and the share of the remainder that it gains
//! towards grazing angles. That share hardly depends on the index, so a few indices suffice.

use super::facets::Smith;
use super::nodes::{GAUSS, NODES, lerp_nodes};
use super::{Ggx, fresnel_dielectric};
use bilux_math::frame::reflect;
use bilux_math::{Vec2, Vec3};
use std::sync::LazyLock;

/// Roughness, the square root of alpha, in uniform steps from 0 to 1.
const ROUGHNESSES: usize = 28;
/// Square roots of cosines, in uniform steps from 0 to 1.
const COSINES: usize = 24;
/// Square roots of the amplitude reflected at normal incidence, in uniform steps from 0 to 1.
const INDICES: usize = 15;
/// Microfacets across and along one half of the cap; the other half mirrors it.
const FACETS: [u32; 2] = [8, 16];

/// For one cosine and roughness: the gain at each index, then the total reflected by opaque microfacets.
type Entry = [f32; INDICES + 1];

/// The table.
#[derive(Debug)]
pub struct AlbedoTable {
    at: [[Entry; COSINES]; ROUGHNESSES],
    /// Cosine-weighted means over the hemisphere.
    mean: [Entry; ROUGHNESSES],
    /// The entries at the nodes of quadratures: for each number of an entry, that at all nodes.
    at_nodes: [[[f32; NODES]; INDICES + 1]; ROUGHNESSES],
    /// Mean loss of opaque microfacets between two neighbouring cosines; `left_before` is its running integral.
    left: [[f32; COSINES - 1]; ROUGHNESSES],
    left_before: [[f32; COSINES]; ROUGHNESSES],
}

static TABLE: LazyLock<AlbedoTable> = LazyLock::new(AlbedoTable::new);

/// The single-bounce albedo of the microfacets of a boundary between two media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// Position among the table's roughnesses.
    roughness: f32,
    /// Position among the table's indices.
    index: f32,
    /// Reflectance at normal incidence.
    straight: f32,
}

impl Albedo {
    /// No reflection at all: an index of 1.
    pub const NONE: Albedo = Albedo { roughness: 0.0, index: 0.0, straight: 0.0 };

    /// The albedo of microfacets on a boundary whose index, below over above, is `eta`, at least 1. Anisotropic
    /// microfacets use the smaller alpha of the two directions, which reflects more.
    pub fn new(ggx: &Ggx, eta: f32) -> Albedo {
        Albedo::of_alpha(ggx.least(), eta)
    }

    /// [`Albedo::new`] for isotropic microfacets of this alpha.
    #[inline(always)]
    pub(super) fn of_alpha(alpha: f32, eta: f32) -> Albedo {
        let amplitude = ((eta - 1.0) / (eta + 1.0)).clamp(0.0, 1.0);
        Albedo {
            roughness: alpha.clamp(0.0, 1.0).sqrt() * (ROUGHNESSES - 1) as f32,
            index: amplitude.sqrt() * (INDICES - 1) as f32,
            straight: amplitude * amplitude,
        }
    }

    /// The reflected fraction along a direction whose cosine with the normal is `cos`, 0..=1.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        self.at_root(cos.clamp(0.0, 1.0).sqrt())
    }

    /// [`Albedo::at`] by the square root of the cosine, 0..=1.
    #[inline(always)]
    pub(super) fn at_root(&self, root: f32) -> f32 {
        self.entry(root, self.shared())
    }

    /// [`Albedo::at_root`] along several directions.
    #[inline(always)]
    pub(super) fn at_roots<const N: usize>(&self, roots: [f32; N]) -> [f32; N] {
        self.entries(roots, self.shared())
    }

    /// Like [`Albedo::at`], for opaque microfacets, which reflect everything.
    #[inline]
    pub fn opaque_at(&self, cos: f32) -> f32 {
        self.entry(cos.clamp(0.0, 1.0).sqrt(), |entry| entry[INDICES])
    }

    /// [`Albedo::opaque_at`] along several directions, by the square roots of their cosines.
    #[inline(always)]
    pub(super) fn opaque_at_roots<const N: usize>(&self, roots: [f32; N]) -> [f32; N] {
        self.entries(roots, |entry| entry[INDICES])
    }

    /// The mean of [`Albedo::at`] over the hemisphere, weighted by the cosine.
    pub fn mean(&self) -> f32 {
        self.between(self.shared())
    }

    /// The mean of [`Albedo::opaque_at`].
    pub fn opaque_mean(&self) -> f32 {
        self.between(|entry| entry[INDICES])
    }

    /// Samples a cosine in proportion to the light that opaque microfacets lose along it; [`Albedo::left_pdf`] gives
    /// the density over the hemisphere.
    pub(super) fn sample_left(&self, u: f32) -> f32 {
        let (row, between) = place(self.roughness, ROUGHNESSES);
        let [a, b] = [&TABLE.left_before[row], &TABLE.left_before[row + 1]];
        let before = |k: usize| lerp(a[k], b[k], between);
        let wanted = u * before(COSINES - 1);
        let k = (1..COSINES - 1).find(|&k| before(k) > wanted).unwrap_or(COSINES - 1) - 1;
        let within =
            ((wanted - before(k)) / (before(k + 1) - before(k)).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        // The square of the cosine is uniform within a step.
        let square = |k: usize| {
            let root = k as f32 / (COSINES - 1) as f32;
            (root * root) * (root * root)
        };
        lerp(square(k), square(k + 1), within).sqrt()
    }

    /// The density of [`Albedo::sample_left`] over the hemisphere, divided by that of cosine-weighted sampling.
    #[inline]
    pub(super) fn left_pdf(&self, cos: f32) -> f32 {
        let (k, _) = place(cos.clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f32, COSINES);
        let (row, between) = place(self.roughness, ROUGHNESSES);
        let whole =
            lerp(TABLE.left_before[row][COSINES - 1], TABLE.left_before[row + 1][COSINES - 1], between);
        lerp(TABLE.left[row][k], TABLE.left[row + 1][k], between) / whole
    }

    /// [`Albedo::opaque_at`] and [`Albedo::at`], but for rounding, without a branch.
    #[inline(always)]
    pub(super) fn pair_at(&self, table: &AlbedoTable, cos: f32) -> [f32; 2] {
        let (column, share) = place(cos.clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f32, COSINES);
        let (row, between) = place(self.roughness, ROUGHNESSES);
        let of = |row: usize| {
            let [a, b] = [&table.at[row][column], &table.at[row][column + 1]].map(|entry| self.pair(entry));
            [lerp(a[0], b[0], share), lerp(a[1], b[1], share)]
        };
        self.mixed(of(row), of(row + 1), between)
    }

    /// [`Albedo::opaque_mean`] and [`Albedo::mean`], as in [`Albedo::pair_at`].
    #[inline(always)]
    pub(super) fn pair_mean(&self, table: &AlbedoTable) -> [f32; 2] {
        let (row, between) = place(self.roughness, ROUGHNESSES);
        self.mixed(self.pair(&table.mean[row]), self.pair(&table.mean[row + 1]), between)
    }

    /// The total of an entry, and its gain at the index.
    #[inline(always)]
    fn pair(&self, entry: &Entry) -> [f32; 2] {
        let (index, share) = place(self.index, INDICES);
        [entry[INDICES], lerp(entry[index], entry[index + 1], share)]
    }

    /// Between two pairs: the total, and the reflected fraction.
    #[inline(always)]
    fn mixed(&self, a: [f32; 2], b: [f32; 2], share: f32) -> [f32; 2] {
        let (total, gain) = (lerp(a[0], b[0], share), lerp(a[1], b[1], share));
        [total, total * self.straight + gain * (1.0 - self.straight)]
    }

    #[inline(always)]
    pub(in crate::bsdf) fn to_numbers(self) -> [f32; 3] {
        [self.roughness, self.index, self.straight]
    }

    #[inline(always)]
    pub(in crate::bsdf) fn from_numbers([roughness, index, straight]: [f32; 3]) -> Albedo {
        Albedo { roughness, index, straight }
    }

    /// One number of the four entries around a position, interpolated bilinearly.
    #[inline(always)]
    fn entry(&self, root: f32, of: impl Fn(&Entry) -> f32) -> f32 {
        let [found] = self.entries([root], of);
        found
    }

    /// [`Albedo::entry`] for several cosines.
    #[inline(always)]
    fn entries<const N: usize>(&self, roots: [f32; N], of: impl Fn(&Entry) -> f32) -> [f32; N] {
        let (row, between) = place(self.roughness, ROUGHNESSES);
        let rows: &[[Entry; COSINES]] = &TABLE.at;
        let [a, b] = [&rows[row], &rows[row + 1]];
        // In place, as `map` would call its closure.
        let mut found = roots;
        for found in &mut found {
            let (column, share) = place(*found * (COSINES - 1) as f32, COSINES);
            let upper = lerp(of(&a[column]), of(&a[column + 1]), share);
            let lower = lerp(of(&b[column]), of(&b[column + 1]), share);
            *found = lerp(upper, lower, between);
        }
        found
    }

    /// [`Albedo::at_root`], but for rounding, at all nodes of [quadratures](super::nodes).
    #[inline]
    pub(super) fn at_nodes(&self) -> [f32; NODES] {
        let (row, between) = place(self.roughness, ROUGHNESSES);
        let (index, share) = place(self.index, INDICES);
        let [a, b] = [&TABLE.at_nodes[row], &TABLE.at_nodes[row + 1]];
        let total = lerp_nodes(&a[INDICES], &b[INDICES], between);
        let [first, second] = [index, index + 1].map(|index| lerp_nodes(&a[index], &b[index], between));
        let gain = lerp_nodes(&first, &second, share);
        std::array::from_fn(|i| total[i] * self.straight + gain[i] * (1.0 - self.straight))
    }

    fn between(&self, of: impl Fn(&Entry) -> f32) -> f32 {
        let (row, between) = place(self.roughness, ROUGHNESSES);
        lerp(of(&TABLE.mean[row]), of(&TABLE.mean[row + 1]), between)
    }

    #[inline(always)]
    fn shared(&self) -> impl Fn(&Entry) -> f32 {
        let (index, share) = place(self.index, INDICES);
        let straight = self.straight;
        move |entry| {
            entry[INDICES] * straight + lerp(entry[index], entry[index + 1], share) * (1.0 - straight)
        }
    }
}

/// The first of the two neighbouring entries, and the position's fraction of the way to the second.
#[inline(always)]
pub(super) fn place(x: f32, count: usize) -> (usize, f32) {
    // An i32 becomes a float by one instruction, a usize by many.
    let first = (x as i32).clamp(0, count as i32 - 2);
    (first as usize, x - first as f32)
}

#[inline(always)]
fn lerp(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}

impl AlbedoTable {
    /// The only one; it is computed on first use.
    #[inline]
    pub fn shared() -> &'static AlbedoTable {
        &TABLE
    }

    fn new() -> AlbedoTable {
        let step = |i: usize, count: usize| i as f32 / (count - 1) as f32;
        let at: [[Entry; COSINES]; ROUGHNESSES] = std::array::from_fn(|row| {
            let roughness = step(row, ROUGHNESSES);
            let ggx = Ggx::new(roughness * roughness);
            std::array::from_fn(|column| {
                // No microfacet is visible from exactly along the surface, so take a limit.
                let root = step(column, COSINES).max(1e-3);
                reflected(&ggx, root * root)
            })
        });
        let mean = std::array::from_fn(|row| mean(&at[row]));
        let left: [[f32; COSINES - 1]; ROUGHNESSES] = std::array::from_fn(|row| {
            let left = |k: usize| 1.0 - at[row][k][INDICES];
            std::array::from_fn(|k| (0.5 * (left(k) + left(k + 1))).max(1e-6))
        });
        let left_before = std::array::from_fn(|row| {
            let fourth = |k: usize| {
                let root = step(k, COSINES);
                (root * root) * (root * root)
            };
            let of = |k: usize| left[row][k] * (fourth(k + 1) - fourth(k));
            std::array::from_fn(|k| (0..k).map(of).sum())
        });
        let at_nodes = std::array::from_fn(|row| at_nodes(&at[row]));
        AlbedoTable { at, mean, at_nodes, left, left_before }
    }
}

/// One entry of the table, by quadrature over the visible microfacets.
fn reflected(ggx: &Ggx, cos: f32) -> Entry {
    if ggx.is_smooth() {
        return gained(cos, 1.0);
    }
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let seen = ggx.seen(wo);
    let (mut sum, mut shares) = ([0f64; INDICES + 1], 0f64);
    let [across, along] = FACETS;
    for i in 0..across * along {
        // Few microfacets tilt far, but they reflect a lot of light, so place more samples there.
        let left = 1.0 - ((i / across) as f32 + 0.5) / along as f32;
        let u = Vec2::new(0.5 * ((i % across) as f32 + 0.5) / across as f32, 1.0 - left * left * left);
        let share = left * left;
        shares += f64::from(share);
        let m = ggx.sample_visible(wo, u, Ggx::FULL);
        let wi = reflect(wo, m);
        if wi.z > 0.0 {
            let weight = share * 4.0 * ggx.visible(wo, wi) / seen;
            for (sum, gain) in sum.iter_mut().zip(gained(wo.dot(m), weight)) {
                *sum += f64::from(gain);
            }
        }
    }
    sum.map(|sum| (sum / shares) as f32)
}

/// The gain of each index at one microfacet, and the total light.
fn gained(cos: f32, weight: f32) -> Entry {
    std::array::from_fn(|i| {
        let root = i as f32 / (INDICES - 1) as f32;
        // At the first index nothing is reflected, and at the last nothing is left to gain.
        let amplitude = (root * root).min(0.999);
        let eta = (1.0 + amplitude) / (1.0 - amplitude);
        let straight = amplitude * amplitude;
        if i == INDICES {
            weight
        } else {
            weight * (fresnel_dielectric(cos, eta) - straight) / (1.0 - straight)
        }
    })
}

/// A row of the table at the nodes of quadratures.
fn at_nodes(row: &[Entry; COSINES]) -> [[f32; NODES]; INDICES + 1] {
    std::array::from_fn(|i| {
        GAUSS.map(|(root, _)| {
            let (column, share) = place(root * (COSINES - 1) as f32, COSINES);
            lerp(row[column][i], row[column + 1][i], share)
        })
    })
}

/// ∫ E(µ) 2µ dµ for E piecewise linear in √µ between the table's cosines.
fn mean(row: &[Entry; COSINES]) -> Entry {
    let mut sum = [0f64; INDICES + 1];
    for (k, pair) in row.windows(2).enumerate() {
        let step = 1.0 / (COSINES - 1) as f64;
        let (a, b) = (k as f64 * step, (k + 1) as f64 * step);
        // The integrals of 4t³, and of 4t³ times the position of t between the two.
        let (a4, b4) = ((a * a) * (a * a), (b * b) * (b * b));
        let whole = b4 - a4;
        let second = (0.8 * (b4 * b - a4 * a) - a * whole) / step;
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum += f64::from(pair[0][i]) * (whole - second) + f64::from(pair[1][i]) * second;
        }
    }
    sum.map(|sum| sum as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table may be coarser at grazing angles, where little light falls.
    fn within(cos: f32) -> f32 {
        if cos < 0.15 { 1.5e-2 } else { 4e-3 }
    }

    #[test]
    fn a_smooth_boundary_reflects_by_fresnel() {
        for eta in [1.05, 1.2, 1.33, 1.5, 1.8, 2.4, 4.0] {
            for i in 2..=50 {
                let cos = i as f32 / 50.0;
                let (found, wanted) = (Albedo::new(&Ggx::SMOOTH, eta).at(cos), fresnel_dielectric(cos, eta));
                assert!((found - wanted).abs() < within(cos), "eta {eta}, cos {cos}: {found}, {wanted}");
            }
        }
    }

    /// Compares with a quadrature over many microfacets, between the table's entries.
    #[test]
    fn the_albedo_table_matches_quadrature() {
        for (alpha, eta) in [(0.03f32, 1.5f32), (0.1, 1.4), (0.3, 1.6), (0.6, 2.0), (0.9, 1.3)] {
            let ggx = Ggx::new(alpha);
            for cos in [0.05f32, 0.11, 0.3, 0.55, 0.9] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let (mut glass, mut all) = (0.0, 0.0);
                const N: usize = 300;
                for i in 0..N * N {
                    let u = Vec2::new(((i % N) as f32 + 0.5) / N as f32, ((i / N) as f32 + 0.5) / N as f32);
                    let m = ggx.sample_visible(wo, u, Ggx::FULL);
                    let wi = reflect(wo, m);
                    if wi.z > 0.0 {
                        let weight = 4.0 * ggx.visible(wo, wi) / ggx.seen(wo) / (N * N) as f32;
                        glass += f64::from(weight * fresnel_dielectric(wo.dot(m), eta));
                        all += f64::from(weight);
                    }
                }
                let albedo = Albedo::new(&ggx, eta);
                let (at, opaque) = (f64::from(albedo.at(cos)), f64::from(albedo.opaque_at(cos)));
                assert!(
                    (at - glass).abs() < f64::from(within(cos)),
                    "alpha {alpha}, eta {eta}, cos {cos}: {at}, {glass}"
                );
                assert!(
                    (opaque - all).abs() < f64::from(within(cos)),
                    "alpha {alpha}, cos {cos}: {opaque}, {all}"
                );
            }
        }
    }

    #[test]
    fn means_are_those_over_the_hemisphere() {
        let albedo = Albedo::new(&Ggx::new(0.37), 1.45);
        const N: usize = 20_000;
        let mid = |i: usize| (i as f32 + 0.5) / N as f32;
        let sum: f64 = (0..N).map(|i| f64::from(albedo.at(mid(i)) * 2.0 * mid(i))).sum();
        assert!((sum / N as f64 - f64::from(albedo.mean())).abs() < 1e-5);
        let sum: f64 = (0..N).map(|i| f64::from(albedo.opaque_at(mid(i)) * 2.0 * mid(i))).sum();
        assert!((sum / N as f64 - f64::from(albedo.opaque_mean())).abs() < 1e-5);
    }
}

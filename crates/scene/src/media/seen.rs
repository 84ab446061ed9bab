//! View of a medium along a line: how much light it would scatter or emit there, how far away, and how much of what lies
//! behind still shows. These are expected values, for comparing pixels: an estimate by a walk would be noise.

use super::medium::{Medium, MediumLine, beer, mean};
use super::tracking::Draws;
use crate::grid::{BLOCK, Grid, GridLine};
use bilux_math::Rgb;

/// Light that is seen along a line through a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The fraction of light that passes from the far end of the line, in `0..=1`.
    pub transmittance: Rgb,
    /// The fraction of light that is scattered on the way, in `0..=1`: for light from everywhere alike, what arrives of it after one event.
    pub scattered: Rgb,
    /// The radiance that is emitted on the way, as far as it arrives, in W/(m² sr).
    pub emitted: Rgb,
    /// The share of what passes here that the medium shows, by scattering it or since it glows, in `0..=1`: the mean over the channels.
    pub shown: f32,
    /// The sum of distances along the line, in metres, weighted by this share.
    pub distance: f32,
}

/// Parts of a line whose optical thickness can be no more than this are looked at in one point.
const THIN: f32 = 0.01;

/// Transmittance below which nothing behind is looked at.
const NOTHING: f32 = 1e-4;

impl Seen {
    /// Of nothing.
    pub const CLEAR: Seen = Seen {
        transmittance: Rgb::WHITE,
        scattered: Rgb::BLACK,
        emitted: Rgb::BLACK,
        shown: 0.0,
        distance: 0.0,
    };
}

impl Medium<'_> {
    /// Light that is seen along a line of this length in metres; `line` is the same in the voxels of the grids, if there are any.
    ///
    /// An even medium has a closed form. The density of a grid is integrated by a sum over steps of at most a voxel, each at a point
    /// that `draws` choose: the optical thickness has no bias, and hardly any noise.
    pub fn seen(&self, line: Option<&MediumLine>, length: f32, draws: &mut Draws) -> Seen {
        if self.is_clear() {
            return Seen::CLEAR;
        }
        if let (Some(grid), Some(line)) = (self.density, line) {
            return self.seen_in_grid(grid, line, length, draws);
        }
        let sigma_t = self.sigma_t();
        let transmittance = beer(sigma_t, length);
        let shown = self.shows() * (Rgb::WHITE - transmittance);
        let [r, g, b] = [0, 1, 2].map(|c| shown[c] * mean_distance(sigma_t[c], length));
        let emitted = match self.glow {
            Some(_) => self.emitted(line, length, || draws.next_1d()),
            None => Rgb::BLACK,
        };
        let scattered = self.single_scattering() * (Rgb::WHITE - transmittance);
        Seen { transmittance, scattered, emitted, shown: mean(shown), distance: mean(Rgb::new(r, g, b)) }
    }

    /// The fraction of extinction that is scattering: the albedo of a single event.
    pub fn single_scattering(&self) -> Rgb {
        let of = |s: f32, t: f32| if t > 0.0 { s / t } else { 0.0 };
        let [s, t] = [self.sigma_s, self.sigma_t()];
        Rgb::new(of(s.r, t.r), of(s.g, t.g), of(s.b, t.b))
    }

    /// The colour of a body of it that nobody sees through, behind a boundary like that of water or skin, nearly: the fraction of light
    /// that comes back out of it. [Hulst 1980]
    pub fn body_color(&self) -> Rgb {
        // As the search in `slab` begins, for an index of 1.4.
        const KAPPA: f32 = 4.4;
        let g = self.phase.mean_cosine();
        self.single_scattering().map(|albedo| {
            let s = ((1.0 - albedo) / (1.0 - g * albedo).max(f32::MIN_POSITIVE)).sqrt();
            (1.0 - s) / (1.0 + KAPPA * s)
        })
    }

    /// The fraction of its extinction that an eye finds something at.
    fn shows(&self) -> Rgb {
        if self.glow.is_some() { Rgb::WHITE } else { self.single_scattering() }
    }

    fn seen_in_grid(&self, grid: &Grid, line: &MediumLine, length: f32, draws: &mut Draws) -> Seen {
        let Some(along) = &line.density else { return Seen::CLEAR };
        let (sigma_t, shows) = (self.sigma_t(), self.shows());
        let mut seen = Seen::CLEAR;
        steps(grid, along, length, sigma_t.max_channel(), |begin, end| {
            let t = begin + (end - begin) * draws.next_1d();
            let thickness = grid.at(along, t) * (end - begin);
            if thickness > 0.0 {
                let stopped = seen.transmittance * (Rgb::WHITE - beer(sigma_t, thickness));
                seen.transmittance = seen.transmittance - stopped;
                if self.glow.is_some() {
                    seen.emitted += stopped * self.emitted_at(line, t);
                }
                let shown = mean(stopped * shows);
                seen.shown += shown;
                seen.distance += shown * t;
            }
            seen.transmittance.max_channel() > NOTHING
        });
        seen.scattered = self.single_scattering() * (Rgb::WHITE - seen.transmittance);
        seen
    }
}

/// Cuts a line through a grid into steps, where there is anything: of a voxel, or of a whole block where that is thin.
fn steps(grid: &Grid, line: &GridLine, length: f32, sigma_t: f32, mut visit: impl FnMut(f32, f32) -> bool) {
    let voxels_per_metre = line.voxels_per_metre();
    grid.for_each_block(line, length, |begin, end, majorant| {
        let (whole, thickest) = (end - begin, majorant * sigma_t * (end - begin));
        if thickest <= 0.0 {
            return true;
        }
        // A diagonal is less than twice as long as a side.
        let voxels = (whole * voxels_per_metre).ceil().clamp(1.0, 2.0 * BLOCK as f32);
        let count = if thickest < THIN { 1 } else { voxels as u32 };
        let at = |i: u32| begin + whole * (i as f32 / count as f32);
        (0..count).all(|i| visit(at(i), at(i + 1)))
    });
}

/// The mean distance of events along a line, given that there is one: of an exponential distribution that ends with the line.
fn mean_distance(sigma_t: f32, length: f32) -> f32 {
    let thickness = sigma_t * length;
    // The closed form is a difference of nearly equal numbers where the line is thin.
    if thickness < 0.05 {
        return length * (0.5 - thickness / 12.0);
    }
    let passed = beer(Rgb::grey(sigma_t), length).g;
    1.0 / sigma_t - length * passed / (1.0 - passed)
}

#[cfg(test)]
mod tests {
    use super::super::glow::Glow;
    use super::*;
    use bilux_math::hash::mix64;
    use bilux_math::transcendental::exp_f64;
    use bilux_math::{Transform, Vec3};

    const SIGMA_A: Rgb = Rgb::new(0.02, 0.1, 0.3);
    const SIGMA_S: Rgb = Rgb::new(0.3, 0.1, 0.0);

    fn close(a: f32, b: f64, within: f64) -> bool {
        (f64::from(a) - b).abs() <= within * b.abs().max(1e-3)
    }

    /// Against integrals by the midpoint rule, of what is thin, thick, and both.
    #[test]
    fn even_media_show_what_integrals_say() {
        for (length, scale) in [(1e-3f32, 1.0f32), (0.4, 1.0), (12.0, 1.0), (50.0, 3.0)] {
            let (sigma_a, sigma_s) = (SIGMA_A * scale, SIGMA_S * scale);
            let medium = Medium { sigma_a, sigma_s, ..Medium::VACUUM };
            let seen = medium.seen(None, length, &mut Draws::new(0));
            let (mut shown, mut distance) = (0.0, 0.0);
            const STEPS: u32 = 20_000;
            let step = f64::from(length) / f64::from(STEPS);
            for c in 0..3 {
                let [s, t] = [f64::from(sigma_s[c]), f64::from(sigma_a[c] + sigma_s[c])];
                let mut scattered = 0.0;
                for i in 0..STEPS {
                    let x = (f64::from(i) + 0.5) * step;
                    let here = s * exp_f64(-t * x) * step;
                    (scattered, shown, distance) =
                        (scattered + here, shown + here / 3.0, distance + here * x / 3.0);
                }
                assert!(close(seen.transmittance[c], exp_f64(-t * f64::from(length)), 1e-5));
                assert!(close(seen.scattered[c], scattered, 2e-3), "{c}: {} {scattered}", seen.scattered[c]);
            }
            assert!(
                close(seen.shown, shown, 2e-3) && close(seen.distance, distance, 3e-3),
                "{seen:?} {distance}"
            );
        }
    }

    fn column(values: &[f32]) -> Grid {
        Grid::dense("", [1, 1, values.len()], &Transform::IDENTITY, values).unwrap()
    }

    /// A grid of ones is the medium without one; its glow too, which hides what it absorbs.
    #[test]
    fn a_grid_of_ones_shows_the_same() {
        let grid = column(&[1.0; 40]);
        let glow = Glow::even(Rgb::new(2.0, 1.0, 0.5));
        for glow in [None, Some(&glow)] {
            let even = Medium { sigma_a: SIGMA_A, sigma_s: SIGMA_S, glow, ..Medium::VACUUM };
            let medium = Medium { density: Some(&grid), ..even };
            let line = medium.line(|| Transform::IDENTITY, Vec3::splat(0.5), Vec3::Z).unwrap();
            for length in [0.3, 7.0, 35.0] {
                let wanted = even.seen(None, length, &mut Draws::new(0));
                let found = medium.seen(Some(&line), length, &mut Draws::new(1));
                for c in 0..3 {
                    assert!(
                        (wanted.transmittance[c] - found.transmittance[c]).abs() < 2e-4,
                        "{wanted:?} {found:?}"
                    );
                    assert!((wanted.scattered[c] - found.scattered[c]).abs() < 2e-4, "{wanted:?} {found:?}");
                    assert!((wanted.emitted[c] - found.emitted[c]).abs() < 1e-3, "{wanted:?} {found:?}");
                }
                // Distances are known to a step, a voxel long.
                assert!((wanted.shown - found.shown).abs() < 2e-4, "{wanted:?} {found:?}");
                assert!(
                    (wanted.distance - found.distance).abs() < 0.2 * wanted.shown,
                    "{wanted:?} {found:?}"
                );
            }
        }
    }

    /// The optical thickness of voxels that have nothing to do with each other: its mean has no bias, and one look hardly any noise.
    #[test]
    fn grids_are_integrated_without_bias_and_with_little_noise() {
        const LOOKS: u64 = 2000;
        let values: Vec<f32> =
            (0..20u64).map(|i| if i.is_multiple_of(4) { 0.0 } else { (mix64(i) >> 62) as f32 }).collect();
        let grid = column(&values);
        let medium = Medium { sigma_s: Rgb::grey(0.1), density: Some(&grid), ..Medium::VACUUM };
        let line = medium.line(|| Transform::IDENTITY, Vec3::new(0.5, 0.5, 1.25), Vec3::Z).unwrap();
        let along = line.density.unwrap();
        const STEPS: u32 = 20_000;
        let step = 15.0 / f64::from(STEPS);
        let exact: f64 =
            (0..STEPS).map(|i| f64::from(grid.at(&along, ((f64::from(i) + 0.5) * step) as f32)) * step).sum();
        let passed = exp_f64(-0.1 * exact);
        let (mut sum, mut squares) = (0.0, 0.0);
        for seed in 0..LOOKS {
            let found = f64::from(medium.seen(Some(&line), 15.0, &mut Draws::new(seed)).transmittance.g);
            (sum, squares) = (sum + found, squares + (found - passed) * (found - passed));
        }
        let [mean, variance] = [sum, squares].map(|sum| sum / LOOKS as f64);
        // The mean of exponentials is larger than the exponential of the mean by half the variance.
        assert!((mean - passed).abs() < 4.0 * (variance / LOOKS as f64).sqrt() + variance, "{mean} {passed}");
        // A walk finds 0 or 1, with a variance of more than half of what passes.
        assert!(variance < 0.02 * passed, "{variance}");
    }
}

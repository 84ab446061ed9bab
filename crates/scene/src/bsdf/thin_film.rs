//! Thin-film interference, such as oil or the oxide on steel: the reflections of the film's two sides add up or cancel,
//! depending on the wavelength.
//!
//! For amplitudes a above the film and b below it, with q = ab, Airy's sum is the reflectance R = 1 - (1-a²)(1-b²) /
//! (1-q²) · (1 + 2 Σ (-q)^m cos mδ), δ = 2π · path / wavelength. Only the cosines depend on the wavelength, and a table
//! over the path stores their means over the channels' sensitivities. [Belcour 2017; Born 1999, 7.6]

use super::{Fresnel, fresnel_dielectric};
use crate::bsdf::wavelength::sensitivity;
use bilux_math::Rgb;
use bilux_math::transcendental::cos;
use std::f32::consts::TAU;
use std::sync::LazyLock;

/// A film on part of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm {
    /// The fraction of the surface that has it, 0..=1.
    pub weight: f32,
    /// Thickness in nm.
    pub thickness: f32,
    /// Refractive index, at least 1.
    pub eta: f32,
}

/// The number of interreflections in the film before the rest is negligible.
const ORDERS: usize = 5;

impl ThinFilm {
    /// Light that meets the film at this cosine.
    #[inline]
    pub(super) fn within(&self, cosine: f32) -> Within {
        let above = cosine.clamp(0.0, 1.0);
        let within = 1.0 - (1.0 - above * above) / (self.eta * self.eta);
        let cosines = (within > 0.0).then(|| [above, within.sqrt()]);
        let path = cosines.map_or(0.0, |[_, within]| 2.0 * self.eta * self.thickness * within);
        let table = COSINES.as_slice();
        Within {
            eta: self.eta,
            cosines,
            interference: std::array::from_fn(|order| mean_cosine(table, path * (order + 1) as f32)),
        }
    }

    /// The reflectance per channel, under the film, of a boundary whose index over the medium above is `eta`, at least
    /// 1.
    pub(super) fn over_glass(&self, cosine: f32, eta: f32) -> Rgb {
        self.within(cosine).over_glass(eta)
    }

    /// The reflectance per channel of clear glass of relative index `eta`, part of whose surface has the film.
    ///
    /// Light comes from the outside or from the inside, at this cosine. A pane has the film on both of its faces.
    #[inline(never)]
    pub(super) fn over_clear(&self, cosine: f32, eta: f32, outside: bool, thin: bool) -> Rgb {
        let above2 = 1.0 - (1.0 - cosine * cosine) * if outside || thin { 1.0 } else { eta * eta };
        if above2 <= 0.0 {
            return Rgb::WHITE;
        }
        let above = above2.sqrt();
        let bare = Rgb::grey(fresnel_dielectric(above, eta));
        let once = if eta < 1.0 { bare } else { bare.lerp(self.over_glass(above, eta), self.weight) };
        if thin { once.map(|r| 2.0 * r / (1.0 + r)) } else { once }
    }

    /// The index of a boundary that reflects as much at normal incidence as the maximum of this film over `eta`.
    pub fn most(&self, eta: f32) -> f32 {
        let (a, b) = ((self.eta - 1.0) / (self.eta + 1.0), (eta - self.eta).abs() / (eta + self.eta));
        let most = (a + b) / (1.0 + a * b);
        let own = (eta - 1.0) / (eta + 1.0);
        let amplitude = (own + (most.max(own) - own) * self.weight).min(0.99);
        (1.0 + amplitude) / (1.0 - amplitude)
    }
}

/// Red, green, blue and nothing: four numbers that are computed at once.
type Four = [f32; 4];

/// Light in a film: what is the same for all that may be below it.
pub(super) struct Within {
    eta: f32,
    /// The cosines above and within the film; `None` where light does not enter it.
    cosines: Option<[f32; 2]>,
    /// The mean cosine of each order.
    interference: [Four; ORDERS],
}

impl Within {
    /// The reflectance per channel of a boundary below the film, whose index over the medium above is `eta`, at least 1.
    pub(super) fn over_glass(&self, eta: f32) -> Rgb {
        let Some([above, within]) = self.cosines else { return Rgb::WHITE };
        let below = (1.0 - (1.0 - above * above) / (eta * eta)).max(0.0).sqrt();
        let across = amplitude(self.eta * within, eta * below);
        let along = amplitude(within / self.eta, below / eta);
        self.reflected([above, within], [Rgb::grey(across), Rgb::grey(along)])
    }

    /// [`Within::over_glass`] for metal, which shifts the phase of light by half a wavelength.
    pub(super) fn over_metal(&self, metal: &Fresnel) -> Rgb {
        let Some([above, within]) = self.cosines else { return Rgb::WHITE };
        let b = metal.at(within).map(f32::sqrt);
        self.reflected([above, within], [b * -1.0, b])
    }

    /// The mean of both polarisations; `b` has the amplitudes below the film, perpendicular and parallel to the plane
    /// of incidence.
    fn reflected(&self, [above, within]: [f32; 2], b: [Rgb; 2]) -> Rgb {
        let a = [amplitude(above, self.eta * within), amplitude(above, within / self.eta)];
        let mut sum = Four::default();
        for (a, Rgb { r, g, b }) in a.into_iter().zip(b) {
            let b = [r, g, b, 0.0];
            // By Horner's rule.
            let mut series = Four::default();
            for cosine in self.interference.iter().rev() {
                for i in 0..4 {
                    series[i] = (series[i] + cosine[i]) * -(b[i] * a);
                }
            }
            for i in 0..4 {
                let q = b[i] * a;
                let passed = (1.0 - a * a) * (1.0 - b[i] * b[i]) / (1.0 - q * q).max(1e-6);
                sum[i] += passed * (1.0 + 2.0 * series[i]);
            }
        }
        let [r, g, b, _] = sum;
        (Rgb::WHITE + Rgb::new(r, g, b) * -0.5).clamp(0.0, 1.0)
    }
}

/// The reflected amplitude between two media. For perpendicular polarisation the arguments are index times cosine of
/// each medium, for parallel polarisation cosine over index.
#[inline]
fn amplitude(first: f32, second: f32) -> f32 {
    (first - second) / (first + second).max(f32::MIN_POSITIVE)
}

/// Paths in nm, in uniform steps; longer ones give no colour.
const LONGEST: f32 = 16_000.0;
const STEPS: usize = 1601;

/// The mean of cos(2π · path / wavelength), weighted by the sensitivity of each channel.
#[inline]
fn mean_cosine(table: &[Four], path: f32) -> Four {
    let place = path / LONGEST * (STEPS - 1) as f32;
    let (first, share) = (place as i32 as usize, place - place as i32 as f32);
    match (table.get(first), table.get(first + 1)) {
        (Some(a), Some(b)) => std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share),
        _ => Four::default(),
    }
}

static COSINES: LazyLock<Vec<Four>> = LazyLock::new(|| {
    let seen: Vec<(f32, Rgb)> =
        (0..90).map(|i| 385.0 + 4.0 * i as f32).map(|nm| (nm, sensitivity(nm))).collect();
    let whole: Rgb = seen.iter().map(|(_, rgb)| *rgb).sum();
    let mean = |step: usize| {
        let path = step as f32 * LONGEST / (STEPS - 1) as f32;
        let sum: Rgb = seen.iter().map(|(nm, rgb)| *rgb * cos(TAU * path / nm)).sum();
        [sum.r / whole.r, sum.g / whole.g, sum.b / whole.b, 0.0]
    };
    (0..STEPS).map(mean).collect()
});

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::transcendental::sin_cos_f64;

    /// Airy's sum computed directly, wavelength by wavelength, with complex amplitudes.
    fn by_wavelengths(film: &ThinFilm, cosine: f32, eta: f32) -> Rgb {
        let (c1, sin2) = (f64::from(cosine), 1.0 - f64::from(cosine * cosine));
        let (n2, n3) = (f64::from(film.eta), f64::from(eta));
        let (c2, c3) = ((1.0 - sin2 / (n2 * n2)).sqrt(), (1.0 - sin2 / (n3 * n3)).sqrt());
        let pairs = [
            ((c1 - n2 * c2) / (c1 + n2 * c2), (n2 * c2 - n3 * c3) / (n2 * c2 + n3 * c3)),
            ((n2 * c1 - c2) / (n2 * c1 + c2), (n3 * c2 - n2 * c3) / (n3 * c2 + n2 * c3)),
        ];
        let (mut sum, mut whole) = (Rgb::BLACK, Rgb::BLACK);
        for nm in 385..745 {
            let delta = 4.0 * std::f64::consts::PI * n2 * f64::from(film.thickness) * c2 / f64::from(nm);
            let (im, re) = sin_cos_f64(delta);
            let reflected = pairs.map(|(a, b)| {
                let (top, bottom) = ((a + b * re, b * im), (1.0 + a * b * re, a * b * im));
                (top.0 * top.0 + top.1 * top.1) / (bottom.0 * bottom.0 + bottom.1 * bottom.1)
            });
            let seen = sensitivity(nm as f32);
            whole += seen;
            sum += seen * (0.5 * (reflected[0] + reflected[1])) as f32;
        }
        Rgb::new(sum.r / whole.r, sum.g / whole.g, sum.b / whole.b).clamp(0.0, 1.0)
    }

    #[test]
    fn colours_are_those_of_airys_sum() {
        let mut most = 0f32;
        for thickness in [0.0f32, 110.0, 250.0, 380.0, 550.0, 800.0] {
            for (film_eta, eta) in [(1.33f32, 1.5f32), (1.8, 1.5), (1.4, 2.6)] {
                let film = ThinFilm { weight: 1.0, thickness, eta: film_eta };
                for cosine in [1.0f32, 0.8, 0.5, 0.2] {
                    let (found, wanted) = (film.over_glass(cosine, eta), by_wavelengths(&film, cosine, eta));
                    let off = found + wanted * -1.0;
                    let off = off.r.abs().max(off.g.abs()).max(off.b.abs());
                    assert!(off < 0.006, "{film:?} over {eta} at {cosine}: {found:?}, {wanted:?}");
                    most = most.max(wanted.max_channel() - wanted.r.min(wanted.g).min(wanted.b));
                }
            }
        }
        // The colours do differ.
        assert!(most > 0.05, "{most}");
    }

    #[test]
    fn clear_glass_has_airys_colours_from_both_sides() {
        for thickness in [110.0f32, 380.0, 550.0] {
            let film = ThinFilm { weight: 1.0, thickness, eta: 1.8 };
            for cosine in [1.0f32, 0.8, 0.5, 0.2] {
                let wanted = by_wavelengths(&film, cosine, 1.5);
                let below = (1.0 - (1.0 - cosine * cosine) / 2.25f32).sqrt();
                let panes = wanted.map(|r| r + (1.0 - r) * (1.0 - r) * r / (1.0 - r * r));
                for (found, wanted) in [
                    (film.over_clear(cosine, 1.5, true, false), wanted),
                    (film.over_clear(below, 1.5, false, false), wanted),
                    (film.over_clear(cosine, 1.5, true, true), panes),
                ] {
                    let off = found + wanted * -1.0;
                    let off = off.r.abs().max(off.g.abs()).max(off.b.abs());
                    assert!(off < 0.01, "{film:?} at {cosine}: {found:?}, {wanted:?}");
                }
            }
            // Beyond the critical angle all light is reflected, with or without a film.
            assert_eq!(film.over_clear(0.5, 1.5, false, false), Rgb::WHITE);
        }
    }

    #[test]
    fn no_film_at_all_changes_nothing() {
        let film = ThinFilm { weight: 1.0, thickness: 0.0, eta: 1.4 };
        for cosine in [1.0f32, 0.6, 0.3] {
            let (found, wanted) =
                (film.over_glass(cosine, 1.5).g, super::super::fresnel_dielectric(cosine, 1.5));
            assert!((found - wanted).abs() < 2e-3, "{cosine}: {found}, {wanted}");
        }
    }
}

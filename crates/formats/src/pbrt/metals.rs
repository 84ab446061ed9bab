//! Refractive indices of metals as three channels.

use super::spectra::{Spectrum, under_daylight};
use bilux_math::Rgb;
use bilux_scene::materials::metal_indices;

/// The channels of a metal of our table; those of copper where it is none.
pub(super) fn indices(metal: &str) -> [Rgb; 2] {
    metal_indices(metal).or_else(|| metal_indices("copper")).unwrap_or([Rgb::WHITE; 2])
}

/// Cosine of 82 degrees, where metals differ most from Schlick's law.
const COS_82: f64 = 0.139_173_1;

/// Reflected fraction of unpolarised light. [pbrt 2023, 9.3.6]
fn reflectance(cos: f64, eta: f64, k: f64) -> f64 {
    let (cos2, sin2) = (cos * cos, 1.0 - cos * cos);
    let a = eta * eta - k * k - sin2;
    let root = (a * a + 4.0 * eta * eta * k * k).sqrt();
    let b = (0.5 * (root + a)).max(0.0).sqrt();
    let across = (root + cos2 - 2.0 * b * cos) / (root + cos2 + 2.0 * b * cos);
    let (c, d) = (cos2 * root + sin2 * sin2, 2.0 * b * cos * sin2);
    0.5 * (across + across * (c - d) / (c + d))
}

/// What each channel reflects, straight on and at 82 degrees, of indices over that of what lies above.
pub(super) fn straight_and_grazing([eta, k]: [Rgb; 2], above: f32) -> [Rgb; 2] {
    [1.0, COS_82].map(|cos| {
        let channel = |c: usize| reflectance(cos, f64::from(eta[c] / above), f64::from(k[c] / above)) as f32;
        Rgb::new(channel(0), channel(1), channel(2))
    })
}

/// For each channel the one index whose reflectance, straight on and at 82 degrees, is that channel of the colour that the
/// spectra reflect there under daylight. [Gulbrandsen 2014]
pub(super) fn from_spectra(eta: &Spectrum, k: &Spectrum) -> [Rgb; 2] {
    let [straight, grazing] = [1.0, COS_82].map(|cos| {
        let seen =
            under_daylight(|wavelength| reflectance(cos, eta.at(wavelength).max(1e-3), k.at(wavelength)));
        seen.to_array()
    });
    let pairs = [0, 1, 2].map(|c| fitted(straight[c].clamp(1e-4, 0.999), grazing[c].clamp(1e-4, 0.9999)));
    [0, 1].map(|i| Rgb::new(pairs[0][i], pairs[1][i], pairs[2][i]))
}

/// Of all indices that reflect so much straight on the one that is nearest at 82 degrees.
fn fitted(straight: f64, grazing: f64) -> [f32; 2] {
    let root = straight.sqrt();
    let (least, most) = ((1.0 - straight) / (1.0 + straight), (1.0 + root) / (1.0 - root));
    let extinction = |eta: f64| {
        let k2 = (straight * (eta + 1.0) * (eta + 1.0) - (eta - 1.0) * (eta - 1.0)) / (1.0 - straight);
        k2.max(0.0).sqrt()
    };
    const STEPS: u32 = 4096;
    let at = |i: u32| {
        let part = f64::from(i) / f64::from(STEPS);
        least + (most - least) * part * part
    };
    let miss = |eta: f64| (reflectance(COS_82, eta, extinction(eta)) - grazing).abs();
    let eta = (0..=STEPS).map(at).min_by(|a, b| miss(*a).total_cmp(&miss(*b))).unwrap_or(least);
    [eta as f32, extinction(eta) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_spectra_give_their_own_index_back() {
        let [eta, k] = from_spectra(&Spectrum::even(1.5), &Spectrum::even(4.0));
        for c in 0..3 {
            let found = [1.0, COS_82].map(|cos| reflectance(cos, f64::from(eta[c]), f64::from(k[c])));
            let wanted = [1.0, COS_82].map(|cos| reflectance(cos, 1.5, 4.0));
            assert!(
                (found[0] - wanted[0]).abs() < 1e-3 && (found[1] - wanted[1]).abs() < 2e-3,
                "{found:?} {wanted:?}"
            );
        }
    }

    #[test]
    fn known_metals_are_known() {
        assert_ne!(indices("gold"), indices("copper"));
        assert_eq!(indices("nothing"), indices("copper"));
    }
}

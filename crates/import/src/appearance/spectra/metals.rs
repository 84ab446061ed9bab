//! Reduces the spectral indices of metals to three channels.

use super::{Spectrum, under_daylight};
use bilux_math::Rgb;
use bilux_scene::materials::metal_indices;

/// Metals for which pbrt's spectra come from other measurements than the table of Bilux: the index of refraction
/// and the extinction of each channel, computed by [`from_spectra`] from the spectra that ship with pbrt.
const MEASURED: [(&str, [Rgb; 2]); 4] = [
    ("aluminium", [Rgb::new(1.431, 0.929, 0.590), Rgb::new(7.748, 6.605, 5.352)]),
    ("copper", [Rgb::new(0.215, 0.975, 1.209), Rgb::new(4.158, 2.621, 2.364)]),
    ("gold", [Rgb::new(0.161, 0.413, 1.559), Rgb::new(3.964, 2.360, 1.719)]),
    ("silver", [Rgb::new(0.130, 0.124, 0.151), Rgb::new(4.118, 3.335, 2.411)]),
];

/// The indices of one of pbrt's metals, by its name in the table of Bilux; those of copper for an unknown name.
pub fn indices(metal: &str) -> [Rgb; 2] {
    let measured =
        |metal: &str| MEASURED.iter().find(|(name, _)| *name == metal).map(|(_, indices)| *indices);
    let known = measured(metal).or_else(|| metal_indices(metal)).or_else(|| measured("copper"));
    known.unwrap_or([Rgb::WHITE; 2])
}

/// The cosine of 82 degrees, where metals differ most from Schlick's approximation.
const COS_82: f64 = 0.139_173_1;

/// The Fresnel reflectance for unpolarised light. [pbrt 2023, 9.3.6]
fn reflectance(cos: f64, eta: f64, k: f64) -> f64 {
    let (cos2, sin2) = (cos * cos, 1.0 - cos * cos);
    let a = eta * eta - k * k - sin2;
    let root = (a * a + 4.0 * eta * eta * k * k).sqrt();
    let b = (0.5 * (root + a)).max(0.0).sqrt();
    let across = (root + cos2 - 2.0 * b * cos) / (root + cos2 + 2.0 * b * cos);
    let (c, d) = (cos2 * root + sin2 * sin2, 2.0 * b * cos * sin2);
    0.5 * (across + across * (c - d) / (c + d))
}

/// The reflectance of each channel at normal incidence and at 82 degrees, relative to the index of the medium
/// above.
pub fn straight_and_grazing([eta, k]: [Rgb; 2], above: f32) -> [Rgb; 2] {
    [1.0, COS_82].map(|cos| {
        let channel = |c: usize| reflectance(cos, f64::from(eta[c] / above), f64::from(k[c] / above)) as f32;
        Rgb::new(channel(0), channel(1), channel(2))
    })
}

/// The spectra of a metal, reduced to three channels.
pub struct Reduced {
    /// The index of refraction and the extinction.
    pub indices: [Rgb; 2],
    /// True if the colour at normal incidence is outside the gamut of sRGB.
    pub is_cut: bool,
}

/// For each channel, the index whose reflectance matches that channel of the metal's colour under daylight.
///
/// The match is at normal incidence and at 82 degrees. [Gulbrandsen 2014] A channel is at most the metal's maximum
/// reflectance at any wavelength: the red of gold in sRGB is above 1, and no index has such a reflectance.
pub fn from_spectra(eta: &Spectrum, k: &Spectrum) -> Reduced {
    let mut is_cut = false;
    let [straight, grazing] = [1.0, COS_82].map(|cos| {
        let of = |wavelength| reflectance(cos, eta.at(wavelength).max(1e-3), k.at(wavelength));
        let most = VISIBLE.map(|nm| of(f64::from(nm))).fold(1e-3, f64::max).min(0.999);
        let seen = under_daylight(of).to_array();
        is_cut |= cos == 1.0 && seen.iter().any(|c| !(-TOLERANCE..=most + TOLERANCE).contains(c));
        seen.map(|c| c.clamp(1e-4, most))
    });
    let pairs = [0, 1, 2].map(|c| fitted(straight[c], grazing[c]));
    Reduced { indices: [0, 1].map(|i| Rgb::new(pairs[0][i], pairs[1][i], pairs[2][i])), is_cut }
}

/// Wavelengths in nm at which the eye's response exceeds one two-hundredth.
const VISIBLE: std::ops::RangeInclusive<u16> = 420..=700;

/// Smaller deviations are not worth a warning.
const TOLERANCE: f64 = 0.005;

/// The maximum index that a material may have.
const MAX_INDEX: f64 = 100.0;

/// Of all indices with the given reflectance at normal incidence, the one that is closest at 82 degrees.
fn fitted(straight: f64, grazing: f64) -> [f32; 2] {
    let root = straight.sqrt();
    let least = (1.0 - straight) / (1.0 + straight);
    let most = ((1.0 + root) / (1.0 - root)).min(MAX_INDEX);
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
    fn constant_spectra_keep_their_index() {
        let Reduced { indices: [eta, k], is_cut } = from_spectra(&Spectrum::even(1.5), &Spectrum::even(4.0));
        assert!(!is_cut);
        for c in 0..3 {
            let found = [1.0, COS_82].map(|cos| reflectance(cos, f64::from(eta[c]), f64::from(k[c])));
            let wanted = [1.0, COS_82].map(|cos| reflectance(cos, 1.5, 4.0));
            assert!(
                (found[0] - wanted[0]).abs() < 1e-3 && (found[1] - wanted[1]).abs() < 2e-3,
                "{found:?} {wanted:?}"
            );
        }
    }

    /// Measured wavelength, index of refraction and extinction of gold. [Johnson 1972]
    const GOLD: [[f64; 3]; 12] = [
        [397.4, 1.47, 1.952],
        [413.3, 1.46, 1.958],
        [430.5, 1.45, 1.948],
        [450.9, 1.38, 1.914],
        [471.4, 1.31, 1.849],
        [495.9, 1.04, 1.833],
        [520.9, 0.62, 2.081],
        [548.6, 0.43, 2.455],
        [582.1, 0.29, 2.863],
        [616.8, 0.21, 3.272],
        [659.5, 0.14, 3.697],
        [704.5, 0.13, 4.103],
    ];

    /// In sRGB it is (1.037, 0.728, 0.365) of white, and no index reflects more than all of the light.
    #[test]
    fn gold_is_outside_srgb_but_has_indices() {
        let part = |i: usize| Spectrum(GOLD.iter().map(|row| [row[0], row[i]]).collect());
        let Reduced { indices: [eta, k], is_cut } = from_spectra(&part(1), &part(2));
        assert!(is_cut);
        let straight = [0, 1, 2].map(|c| reflectance(1.0, f64::from(eta[c]), f64::from(k[c])));
        for (found, wanted) in straight.into_iter().zip([0.971, 0.728, 0.365]) {
            assert!((found - wanted).abs() < 0.005, "{straight:?}");
        }
        for c in 0..3 {
            assert!((0.05..2.0).contains(&eta[c]) && (1.0..6.0).contains(&k[c]), "{eta:?} {k:?}");
        }
    }

    /// Reflectance of pbrt's metals at normal incidence, in linear sRGB. [Akenine-Möller 2018, table 9.2] Gold's
    /// red is 1.022 there.
    #[test]
    fn metals_by_name_have_the_colours_that_tables_have() {
        for (name, wanted) in [
            ("aluminium", [0.913, 0.922, 0.924]),
            ("brass", [0.910, 0.778, 0.423]),
            ("copper", [0.955, 0.638, 0.538]),
            ("gold", [0.962, 0.782, 0.344]),
            ("silver", [0.972, 0.960, 0.915]),
        ] {
            let [found, _] = straight_and_grazing(indices(name), 1.0);
            assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 1.5e-3), "{name}: {found:?}");
        }
    }

    #[test]
    fn known_metals_are_known() {
        assert_ne!(indices("gold"), indices("copper"));
        assert_eq!(indices("brass"), metal_indices("brass").unwrap());
        assert_eq!(indices("nothing"), indices("copper"));
    }
}

//! Converts spectra to colours: reflectance under daylight, or emission.

pub mod colours;
pub mod metals;

use bilux_math::Rgb;
use bilux_math::glam::DVec3;
use bilux_math::transcendental::exp_f64;
use colours::{from_xyz, of_unit_luminance};

/// A spectrum by increasing wavelength (nm), linear between its samples and zero beyond them.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum(pub Vec<[f64; 2]>);

/// The CIE 1931 standard observer and illuminant D65, from 380 to 780 nm in steps of 10. [CIE 15]
const FIRST: f64 = 380.0;
const STEP: f64 = 10.0;
#[rustfmt::skip]
const X_BAR: [f64; 41] = [
    0.001368, 0.004243, 0.01431, 0.04351, 0.13438, 0.2839, 0.34828, 0.3362, 0.2908, 0.19536, 0.09564, 0.03201, 0.0049,
    0.0093, 0.06327, 0.1655, 0.2904, 0.43345, 0.5945, 0.7621, 0.9163, 1.0263, 1.0622, 1.0026, 0.85445, 0.6424, 0.4479,
    0.2835, 0.1649, 0.0874, 0.04677, 0.0227, 0.011359, 0.00579, 0.002899, 0.00144, 0.00069, 0.000332, 0.000166,
    0.000083, 0.000042,
];
#[rustfmt::skip]
const Y_BAR: [f64; 41] = [
    0.000039, 0.00012, 0.000396, 0.00121, 0.004, 0.0116, 0.023, 0.038, 0.06, 0.09098, 0.13902, 0.20802, 0.323, 0.503,
    0.71, 0.862, 0.954, 0.99495, 0.995, 0.952, 0.87, 0.757, 0.631, 0.503, 0.381, 0.265, 0.175, 0.107, 0.061, 0.032,
    0.017, 0.00821, 0.004102, 0.002091, 0.001047, 0.00052, 0.000249, 0.00012, 0.00006, 0.00003, 0.000015,
];
#[rustfmt::skip]
const Z_BAR: [f64; 41] = [
    0.00645, 0.02005, 0.06785, 0.2074, 0.6456, 1.3856, 1.74706, 1.77211, 1.6692, 1.28764, 0.81295, 0.46518, 0.272,
    0.1582, 0.07825, 0.04216, 0.0203, 0.00875, 0.0039, 0.0021, 0.00165, 0.0011, 0.0008, 0.00034, 0.00019, 0.00005,
    0.00002, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
];
#[rustfmt::skip]
const DAYLIGHT: [f64; 41] = [
    49.98, 54.65, 82.75, 91.49, 93.43, 86.68, 104.86, 117.01, 117.81, 114.86, 115.92, 108.81, 109.35, 107.80, 104.79,
    107.69, 104.41, 104.05, 100.0, 96.33, 95.79, 88.69, 90.01, 89.60, 87.70, 83.29, 83.70, 80.03, 80.21, 82.28, 78.28,
    69.72, 71.61, 74.35, 61.60, 69.89, 75.09, 63.59, 46.42, 66.81, 63.38,
];

/// Close to the sodium line: the wavelength at which indices of refraction are quoted.
const YELLOW: f64 = 587.6;

impl Spectrum {
    /// A constant spectrum over all visible wavelengths.
    #[cfg(test)]
    pub fn even(value: f64) -> Spectrum {
        Spectrum(vec![[300.0, value], [900.0, value]])
    }

    /// The value at a wavelength in nm.
    pub fn at(&self, wavelength: f64) -> f64 {
        let after = self.0.partition_point(|[w, _]| *w < wavelength);
        match (after.checked_sub(1).map(|i| self.0[i]), self.0.get(after)) {
            (_, Some([w, value])) if *w == wavelength => *value,
            (Some([w0, v0]), Some([w1, v1])) => v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0),
            _ => 0.0,
        }
    }

    /// The value at 587.6 nm.
    pub fn at_yellow(&self) -> f32 {
        self.at(YELLOW) as f32
    }

    /// 20 / Abbe number of a glass with this spectrum as its index of refraction, from the hydrogen F and C lines.
    ///
    /// `None` if the index does not fall from blue to red as it does in glass, or is not given there.
    pub fn dispersion(&self) -> Option<f32> {
        if self.0.windows(2).all(|pair| pair[0][1] == pair[1][1]) {
            return Some(0.0);
        }
        let [blue, yellow, red] = [486.13, YELLOW, 656.27].map(|nm| self.at(nm));
        let dispersion = 20.0 * (blue - red) / (yellow - 1.0);
        (red > 0.0 && yellow > 1.0 && (0.0..=20.0).contains(&dispersion)).then_some(dispersion as f32)
    }

    /// The colour of a surface with this reflectance spectrum under daylight. Other spectral quantities are
    /// averaged in the same way.
    pub fn surface(&self) -> Rgb {
        let seen = under_daylight(|wavelength| self.at(wavelength));
        Rgb::from_array(seen.max(DVec3::ZERO).as_vec3().to_array())
    }

    /// The colour of a light whose luminance is 1 where this spectrum is 1 throughout.
    pub fn emission(&self) -> Rgb {
        let seen = observed(|wavelength| self.at(wavelength)) / observed(|_| 1.0).y;
        Rgb::from_array(from_xyz(seen).max(DVec3::ZERO).as_vec3().to_array())
    }

    /// The colour of a light with this spectrum, with luminance 1.
    pub fn light(&self) -> Rgb {
        of_unit_luminance(observed(|wavelength| self.at(wavelength)))
    }
}

/// The colour of daylight after reflection, relative to daylight itself; may be outside the gamut.
pub fn under_daylight(reflected: impl Fn(f64) -> f64) -> DVec3 {
    let lit = observed(|wavelength| reflected(wavelength) * sampled(&DAYLIGHT, wavelength));
    let white = observed(|wavelength| sampled(&DAYLIGHT, wavelength));
    from_xyz(lit) / from_xyz(white)
}

/// The colour of a black body at this temperature in kelvin, with luminance 1. [Wyszecki 1982]
pub fn blackbody(kelvin: f32) -> Rgb {
    let kelvin = f64::from(kelvin);
    if kelvin <= 0.0 {
        return Rgb::BLACK;
    }
    // hc/k in nm·K; constant factors do not affect the colour.
    let second = 1.438_776_877e7;
    let emitted = |w: f64| 1.0 / (fifth(w / YELLOW) * (exp_f64(second / (w * kelvin)) - 1.0));
    of_unit_luminance(observed(emitted))
}

/// Spectral radiance of a black body at a wavelength in nm and a temperature in kelvin, in W/(m² sr nm). [Wyszecki 1982]
pub fn planck(wavelength: f64, kelvin: f64) -> f64 {
    // 2hc² in W m², for metres as for nanometres, and hc/k in nm K.
    const FIRST_RADIATION: f64 = 1.191_042_972e-16;
    const SECOND: f64 = 1.438_776_877e7;
    if kelvin <= 0.0 {
        return 0.0;
    }
    FIRST_RADIATION * 1e36 / (fifth(wavelength) * (exp_f64(SECOND / (wavelength * kelvin)) - 1.0))
}

fn fifth(x: f64) -> f64 {
    let x2 = x * x;
    x2 * x2 * x
}

/// The XYZ of a spectrum, up to a constant scale.
fn observed(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    let samples = (X_BAR.len() - 1) * STEP as usize;
    (0..=samples)
        .map(|i| {
            let wavelength = FIRST + i as f64;
            let bars = DVec3::new(
                sampled(&X_BAR, wavelength),
                sampled(&Y_BAR, wavelength),
                sampled(&Z_BAR, wavelength),
            );
            bars * spectrum(wavelength)
        })
        .sum()
}

fn sampled(table: &[f64], wavelength: f64) -> f64 {
    let place = ((wavelength - FIRST) / STEP).clamp(0.0, (table.len() - 1) as f64);
    let i = (place as usize).min(table.len() - 2);
    table[i] + (table[i + 1] - table[i]) * (place - i as f64)
}

#[cfg(test)]
mod tests {
    use super::colours::of_chromaticity;
    use super::*;

    fn close(a: Rgb, b: [f32; 3], by: f32) -> bool {
        (0..3).all(|i| (a[i] - b[i]).abs() < by)
    }

    #[test]
    fn even_spectra_are_grey_and_daylight_is_white() {
        assert!(close(Spectrum::even(0.5).surface(), [0.5; 3], 1e-4));
        let daylight: Vec<[f64; 2]> =
            DAYLIGHT.iter().enumerate().map(|(i, v)| [FIRST + STEP * i as f64, *v]).collect();
        let white = Spectrum(daylight).light();
        assert!(close(white, [1.0; 3], 5e-3), "{white:?}");
    }

    #[test]
    fn black_bodies_have_the_colours_of_the_planckian_locus() {
        // Chromaticities of the Planckian locus. [Wyszecki 1982, table I(6.2.2)]
        for (kelvin, xy) in
            [(2856.0, [0.4476, 0.4074]), (6500.0, [0.3135, 0.3237]), (10000.0, [0.2807, 0.2884])]
        {
            let (found, wanted) = (blackbody(kelvin), of_chromaticity(xy));
            assert!(close(found, wanted.to_array(), 0.01), "{kelvin}: {found:?} {wanted:?}");
            assert!((found.luminance() - 1.0).abs() < 1e-3);
        }
        assert_eq!(blackbody(-1.0), Rgb::BLACK);
    }

    #[test]
    fn steps_have_the_colour_of_their_side() {
        let red = Spectrum(vec![[380.0, 0.0], [599.0, 0.0], [600.0, 1.0], [780.0, 1.0]]).surface();
        assert!(red.r > 0.7 && red.g < 0.1 && red.b < 0.05, "{red:?}");
        assert_eq!(Spectrum(vec![[400.0, 1.0], [500.0, 3.0]]).at(450.0), 2.0);
        assert_eq!(Spectrum(vec![[400.0, 1.0]]).at(450.0), 0.0);
    }
}

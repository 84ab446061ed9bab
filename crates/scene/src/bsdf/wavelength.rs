//! Wavelengths. Light is red, green and blue here, and a path carries all three at once, until a dispersive surface
//! refracts each wavelength differently. From then on the path has the single wavelength that was sampled for it at its
//! start, and the channels weight it by their sensitivity to light of that wavelength. Several wavelengths at once
//! [Wilkie 2014] would need spectral reflectances and lights, which files do not contain.

use bilux_math::Rgb;
use bilux_math::transcendental::exp;
use std::sync::LazyLock;

/// A wavelength of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelength {
    /// In nanometres.
    pub nm: f32,
    /// The sensitivity of the channels to it, over its sampling density: 1 each on average.
    pub weight: Rgb,
    /// Difference from the d line in Cauchy's formula: in 1/nm², over the difference between the F and C lines.
    from_d: f32,
}

/// The Fraunhofer lines that specify glass, in nm: helium's yellow line, hydrogen's blue and red lines.
const D_LINE: f32 = 587.5618;
const F_LINE: f32 = 486.1327;
const C_LINE: f32 = 656.2725;

/// The range of sampled wavelengths, in nm. The channels are almost blind to others.
const SHORTEST: f32 = 385.0;
const STEPS: usize = 340;

impl Wavelength {
    /// The wavelength for which indices are given.
    pub const D: Wavelength = Wavelength { nm: D_LINE, weight: Rgb::WHITE, from_d: 0.0 };

    /// Samples a wavelength from a number in `[0, 1)`, in proportion to the mean sensitivity of the channels.
    pub fn sample(u: f32) -> Wavelength {
        let step = SPECTRUM.before.partition_point(|before| *before <= u).clamp(1, STEPS) - 1;
        let within = (u - SPECTRUM.before[step]) / (SPECTRUM.before[step + 1] - SPECTRUM.before[step]);
        Wavelength::of(SHORTEST + step as f32 + within.clamp(0.0, 1.0 - f32::EPSILON))
    }

    /// The wavelength of `nm` nanometres.
    pub fn of(nm: f32) -> Wavelength {
        let inverse_square = |nm: f32| 1.0 / (nm * nm);
        let from_d =
            (inverse_square(nm) - inverse_square(D_LINE)) / (inverse_square(F_LINE) - inverse_square(C_LINE));
        let step = (nm - SHORTEST).max(0.0) as usize;
        Wavelength { nm, weight: SPECTRUM.weights.get(step).copied().unwrap_or(Rgb::BLACK), from_d }
    }

    /// The index at this wavelength of a boundary whose index at the d line is `eta`; `dispersion` is 1 over the Abbe
    /// number.
    ///
    /// It uses Cauchy's formula for the index of the denser side, which stays the denser one at every wavelength.
    /// [Cauchy 1836]
    pub fn index(&self, eta: f32, dispersion: f32) -> f32 {
        if eta < 1.0 {
            return 1.0 / self.index(1.0 / eta, dispersion);
        }
        1.0 + (eta - 1.0) * (1.0 + dispersion * self.from_d).max(0.0)
    }
}

/// The sampling table, in steps of 1 nm.
struct Spectrum {
    weights: Vec<Rgb>,
    /// The cumulative probability before each step.
    before: Vec<f32>,
}

static SPECTRUM: LazyLock<Spectrum> = LazyLock::new(|| {
    // Light of one wavelength is more saturated than red, green and blue can show: a channel that would be negative is
    // 0, and the rest of the spectrum compensates slightly.
    let clipped = |step| sensitivity(SHORTEST + step as f32 + 0.5).map(|channel| channel.max(0.0));
    let seen: Vec<Rgb> = (0..STEPS).map(clipped).collect();
    let whole = [0, 1, 2].map(|c| seen.iter().map(|rgb| f64::from(rgb[c])).sum::<f64>());
    // The fraction of each channel in each step; steps are sampled by the mean over the channels.
    let parts = |rgb: &Rgb| [0, 1, 2].map(|c| f64::from(rgb[c]) / whole[c]);
    let density = |rgb: &Rgb| parts(rgb).iter().sum::<f64>() / 3.0;
    let weight = |rgb: &Rgb| Rgb::from_array(parts(rgb).map(|part| (part / density(rgb)) as f32));
    let mut sum = 0.0;
    let after = seen.iter().map(|rgb| {
        sum += density(rgb);
        sum as f32
    });
    let before = std::iter::once(0.0).chain(after).collect();
    Spectrum { weights: seen.iter().map(weight).collect(), before }
});

/// The sensitivity of the Rec. 709 channels to a wavelength in nm, unnormalised: the standard observer's curves
/// [Wyman 2013, eq. 4] times the primaries' matrix. Negative where a colour is out of gamut.
pub(crate) fn sensitivity(nm: f32) -> Rgb {
    let bell = |middle: f32, below: f32, above: f32| {
        let t = (nm - middle) / if nm < middle { below } else { above };
        exp(-0.5 * t * t)
    };
    let x =
        1.056 * bell(599.8, 37.9, 31.0) + 0.362 * bell(442.0, 16.0, 26.7) - 0.065 * bell(501.1, 20.4, 26.2);
    let y = 0.821 * bell(568.8, 46.9, 40.5) + 0.286 * bell(530.9, 16.3, 31.1);
    let z = 1.217 * bell(437.0, 11.8, 36.0) + 0.681 * bell(459.0, 26.0, 13.8);
    Rgb::new(
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    )
}

/// hc/k, in nm K.
const SECOND: f32 = 1.438_776_9e7;

/// The colour of a black body whose spectrum is scaled to a maximum of 1, wherever that is: in Rec. 709, the luminance a sum over
/// steps of 1 nm, up to 107. [Planck 1901; pbrt 2023]
pub fn black_body_of_peak_one(kelvin: f32) -> Rgb {
    /// hc/(kT) over the wavelength of the maximum, and exp of it, minus 1.
    const WIEN: f32 = 4.965_114;
    const OCCUPIED: f32 = 142.325;
    let w = SECOND / (WIEN * kelvin.max(f32::MIN_POSITIVE) * 555.0);
    let colour = black_body(kelvin) * (w * w * w * w * w * OCCUPIED);
    if colour.is_finite() { colour } else { Rgb::BLACK }
}

/// The colour of a black body at a temperature in kelvin, in Rec. 709, up to a factor that is the same for all; black where that is beyond
/// the range of numbers. [Planck 1901]
pub(crate) fn black_body(kelvin: f32) -> Rgb {
    let part = |step: usize| {
        let nm = SHORTEST + step as f32 + 0.5;
        let w = nm / 555.0;
        let emitted = 1.0 / (w * w * w * w * w * (exp(SECOND / (nm * kelvin)) - 1.0));
        sensitivity(nm) * emitted
    };
    let sum: Rgb = (0..STEPS).map(part).sum();
    if kelvin > 0.0 && sum.is_finite() { sum.map(|channel| channel.max(0.0)) } else { Rgb::BLACK }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: u32 = 1 << 20;

    fn drawn() -> impl Iterator<Item = Wavelength> {
        (0..N).map(|i| Wavelength::sample((i as f32 + 0.5) / N as f32))
    }

    #[test]
    fn sampled_wavelengths_average_to_white() {
        for channel in 0..3 {
            let mean = drawn().map(|one| f64::from(one.weight[channel])).sum::<f64>() / f64::from(N);
            assert!((mean - 1.0).abs() < 1e-5, "{channel}: {mean}");
        }
        for one in drawn().step_by(997) {
            let sum = one.weight.r + one.weight.g + one.weight.b;
            assert!((sum - 3.0).abs() < 1e-5, "{one:?}: no weight is above 3");
            assert_eq!(one, Wavelength::of(one.nm));
        }
    }

    /// By another program, in double precision, from the same curve of the observer.
    #[test]
    fn black_bodies_of_peak_one_have_the_luminance_of_their_spectrum() {
        for (kelvin, wanted) in [(1500.0, 0.36595), (2856.0, 37.217), (5500.0, 104.72), (9000.0, 58.859)] {
            let found = black_body_of_peak_one(kelvin).luminance();
            // Blue that would be negative is 0, which adds a little to red light.
            assert!((found - wanted).abs() < 1e-2 * wanted, "{found} for {wanted} at {kelvin} K");
        }
        assert_eq!([0.0, 1.0, -5.0].map(black_body_of_peak_one), [Rgb::BLACK; 3]);
    }

    #[test]
    fn colours_are_where_they_belong() {
        let brightest = |nm: f32| {
            let Rgb { r, g, b } = Wavelength::of(nm).weight;
            if r > g.max(b) {
                'r'
            } else if g > b {
                'g'
            } else {
                'b'
            }
        };
        let seen: String = [430.0, 460.0, 520.0, 550.0, 620.0, 680.0].map(brightest).iter().collect();
        assert_eq!(seen, "bbggrr");
        // Violet contains red, and yellow is half red and half green.
        assert!(Wavelength::of(420.0).weight.r > 0.1);
        let yellow = Wavelength::of(578.0).weight;
        assert!((yellow.r / yellow.g - 1.0).abs() < 0.35 && yellow.b < 0.02, "{yellow:?}");
    }

    #[test]
    fn indices_are_what_abbes_number_says() {
        let (eta, abbe) = (1.5168f32, 64.17f32);
        let at = |nm: f32| Wavelength::of(nm).index(eta, 1.0 / abbe);
        assert_eq!(Wavelength::D.index(eta, 1.0 / abbe), eta);
        let found = (eta - 1.0) / (at(F_LINE) - at(C_LINE));
        assert!((found - abbe).abs() < 0.1, "{found}");
        // This glass has an index of 1.5143 at 656 nm, of 1.5224 at 486 nm and of 1.5302 at 405 nm.
        for (nm, index) in [(656.3, 1.51432), (486.1, 1.52238), (404.7, 1.53024)] {
            assert!((at(nm) - index).abs() < 5e-4, "{nm}: {}", at(nm));
        }
        // From the other side.
        let other = Wavelength::of(450.0).index(1.0 / eta, 1.0 / abbe);
        assert!((other * at(450.0) - 1.0).abs() < 1e-6);
        assert_eq!(Wavelength::of(700.0).index(1.5, 1e3), 1.0, "the thinner side never becomes the denser");
    }
}

//! Which albedo gives a half space a colour.

use super::Slab;

/// Nodes on each side of the critical angle: the colour is right to about 5·10⁻⁴.
const NODES: usize = 8;

/// Error of the colour below which the search ends, and its maximum number of tries.
const TOLERANCE: f64 = 1e-5;
const MAX_TRIES: u32 = 12;

/// The fraction of extinction that is absorption, one minus the albedo, in a half space that sends `colour` of what enters it at
/// normal incidence back out: with the boundary of a refractive index, and Henyey and Greenstein's phase function of this mean
/// cosine. [OpenPBR 1.1]
///
/// A colour of 1 absorbs nothing, a colour of 0 scatters nothing.
pub fn absorbed_fraction(colour: f64, anisotropy: f64, eta: f64) -> f64 {
    if colour >= 1.0 {
        return 0.0;
    }
    if colour <= 0.0 {
        return 1.0;
    }
    // Colours are nearly (1 - s) / (1 + κ s), where the similarity s is the root of (1 - albedo) / (1 - g albedo), and κ hardly
    // depends on it. [Hulst 1980]
    let of = |s: f64| {
        let square = s * s;
        square * (1.0 - anisotropy) / (1.0 - anisotropy * square)
    };
    let mut kappa = 2.0 + 6.0 * (eta - 1.0);
    let mut s = 0.0;
    for _ in 0..MAX_TRIES {
        s = (1.0 - colour) / (1.0 + kappa * colour);
        let slab = Slab { absorbed: of(s), thickness: f64::INFINITY, anisotropy, eta };
        let light = slab.light(NODES);
        let found = light.from_inside / (1.0 - light.at_surface);
        if (found - colour).abs() < TOLERANCE {
            break;
        }
        kappa = ((1.0 - s) / found - 1.0) / s;
    }
    of(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours and their albedos, for an index of 1 and of 1.5: by discrete ordinates.
    const ALBEDOS: [(f64, f64, f64); 7] = [
        (0.10, 0.45487, 0.720661),
        (0.30, 0.81497, 0.937690),
        (0.50, 0.93817, 0.982323),
        (0.70, 0.98409, 0.995835),
        (0.80, 0.99388, 0.998447),
        (0.90, 0.99866, 0.999669),
        (0.95, 0.99969, 0.999923),
    ];

    #[test]
    fn albedos_are_those_of_discrete_ordinates() {
        for (colour, matched, glass) in ALBEDOS {
            for (albedo, eta) in [(matched, 1.0), (glass, 1.5)] {
                let absorbed = absorbed_fraction(colour, 0.0, eta);
                assert!(
                    (absorbed / (1.0 - albedo) - 1.0).abs() < 0.015,
                    "{colour} {eta}: {absorbed} of {albedo}"
                );
            }
        }
    }

    /// Twice as many nodes see the colour that was asked for.
    #[test]
    fn half_spaces_of_an_albedo_have_its_colour() {
        for colour in [1e-6, 0.01, 0.2, 0.5, 0.8, 0.97, 0.999] {
            for (anisotropy, eta) in
                [(0.0, 1.4), (0.8, 1.4), (-0.5, 1.0), (0.9, 1.0), (0.3, 2.4), (0.0, 1.01), (0.9, 2.0)]
            {
                let absorbed = absorbed_fraction(colour, anisotropy, eta);
                let light = Slab { absorbed, thickness: f64::INFINITY, anisotropy, eta }.light(24);
                let found = light.from_inside / (1.0 - light.at_surface);
                assert!((found - colour).abs() < 1.5e-3, "{colour} {anisotropy} {eta}: {found}");
            }
        }
    }

    #[test]
    fn white_absorbs_nothing_and_black_all() {
        assert_eq!(absorbed_fraction(1.0, 0.3, 1.5), 0.0);
        assert_eq!(absorbed_fraction(0.0, 0.3, 1.5), 1.0);
    }
}

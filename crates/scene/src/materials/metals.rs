//! Metals by name. [Johnson 1972; Johnson 1974; Rakić 1995; Querry 1985]
//!
//! One index per channel has to represent a third of the spectrum. It is chosen so that its reflectance, at normal
//! incidence and at 82 degrees, equals that channel of the colour that the measured indices reflect there under D65,
//! for the observer of 1931. In between it differs from that colour by less than 0.006. Only gold is more saturated
//! than Rec. 709 can show: its red channel is limited to 0.985.

use bilux_math::Rgb;

/// The real and the imaginary part of a metal's refractive index, in vacuum.
pub(super) struct Metal {
    pub(super) name: &'static str,
    pub(super) eta: Rgb,
    pub(super) k: Rgb,
}

/// The names that users choose from.
pub(super) const NAMES: &[&str] =
    &["aluminium", "brass", "chromium", "copper", "gold", "iron", "nickel", "silver", "titanium"];

pub(super) const METALS: &[Metal] = &[
    metal("aluminium", [1.505, 0.985, 0.606], [7.662, 6.550, 5.349]),
    metal("brass", [0.440, 0.522, 1.121], [4.170, 2.664, 1.808]),
    metal("chromium", [3.247, 3.114, 2.286], [3.287, 3.336, 3.117]),
    metal("copper", [0.210, 1.043, 1.294], [3.294, 2.623, 2.361]),
    metal("gold", [0.061, 0.503, 1.463], [3.887, 2.268, 1.773]),
    metal("iron", [2.923, 2.919, 2.546], [3.077, 2.937, 2.750]),
    metal("nickel", [2.033, 1.903, 1.727], [4.201, 3.570, 2.895]),
    metal("silver", [0.056, 0.055, 0.043], [4.480, 3.543, 2.586]),
    metal("titanium", [2.748, 2.508, 2.239], [3.844, 3.397, 3.015]),
];

const fn metal(name: &'static str, eta: [f32; 3], k: [f32; 3]) -> Metal {
    Metal { name, eta: Rgb::new(eta[0], eta[1], eta[2]), k: Rgb::new(k[0], k[1], k[2]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Fresnel;

    #[test]
    fn every_name_has_its_metal() {
        assert!(METALS.iter().map(|metal| metal.name).eq(NAMES.iter().copied()));
    }

    #[test]
    fn colours_are_those_that_the_measurements_reflect() {
        let straight = |name: &str| {
            let metal = METALS.iter().find(|metal| metal.name == name).unwrap();
            Fresnel::Complex { eta: metal.eta, k: metal.k }.at(1.0)
        };
        for (name, wanted) in [
            ("aluminium", [0.9073, 0.9159, 0.9223]),
            ("copper", [0.9317, 0.6227, 0.5223]),
            ("gold", [0.985, 0.7283, 0.3646]),
            ("silver", [0.9894, 0.9840, 0.9778]),
            ("iron", [0.5297, 0.5132, 0.4942]),
        ] {
            let found = straight(name);
            assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 2e-3), "{name}: {found:?}");
        }
    }
}

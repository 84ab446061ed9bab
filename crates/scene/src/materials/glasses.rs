//! Transparent materials by name: refractive index at 587.6 nm, and Abbe number. Glasses are from the maker's data
//! sheets [Schott 2023]. The others are from formulas fitted to measurements: silica [Malitson 1965], sapphire for the
//! ordinary ray [Malitson 1962], diamond [Peter 1923], water at 20 °C [Daimon 2007], acrylic and polycarbonate
//! [Sultanova 2009].

/// The names that users choose from.
pub(super) const NAMES: &[&str] = &[
    "none",
    "acrylic",
    "baf10",
    "bk7",
    "diamond",
    "fk51a",
    "lasf9",
    "polycarbonate",
    "sapphire",
    "sf10",
    "sf11",
    "sf5",
    "silica",
    "water",
];

/// Each name with its refractive index and its Abbe number.
const GLASSES: &[(&str, f32, f32)] = &[
    ("acrylic", 1.4906, 53.18),
    ("baf10", 1.6700, 47.11),
    ("bk7", 1.5168, 64.17),
    ("diamond", 2.4175, 55.30),
    ("fk51a", 1.4866, 84.47),
    ("lasf9", 1.8503, 32.17),
    ("polycarbonate", 1.5848, 27.86),
    ("sapphire", 1.7682, 72.31),
    ("sf10", 1.7283, 28.53),
    ("sf11", 1.7847, 25.68),
    ("sf5", 1.6727, 32.25),
    ("silica", 1.4585, 67.82),
    ("water", 1.3334, 55.76),
];

/// The refractive index of a named material at 587.6 nm, and its Abbe number.
pub fn glass_indices(name: &str) -> Option<(f32, f32)> {
    GLASSES.iter().find(|(known, ..)| *known == name).map(|&(_, index, abbe_number)| (index, abbe_number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_its_glass() {
        assert!(GLASSES.iter().map(|(name, ..)| *name).eq(NAMES[1..].iter().copied()));
    }

    /// Index and Abbe number by the Sellmeier equation: n² - 1 is the sum of a·λ²/(λ² - b), λ in µm.
    fn sellmeier(terms: &[(f64, f64)]) -> (f64, f64) {
        let index = |l: f64| (1.0 + terms.iter().map(|(a, b)| a * l * l / (l * l - b)).sum::<f64>()).sqrt();
        let [d, f, c] = [0.587_561_8, 0.486_132_7, 0.656_272_5].map(index);
        (d, (d - 1.0) / (f - c))
    }

    #[test]
    fn indices_are_those_of_the_formulas() {
        let square = |b: f64| b * b;
        let silica = [
            (0.696_166_3, square(0.068_404_3)),
            (0.407_942_6, square(0.116_241_4)),
            (0.897_479_4, square(9.896_161)),
        ];
        let sapphire = [
            (1.431_349_3, square(0.072_663_1)),
            (0.650_547_13, square(0.119_324_2)),
            (5.341_402_1, square(18.028_251)),
        ];
        let water = [
            (0.568_402_756_5, 0.005_101_829_712),
            (0.172_617_739_1, 0.018_211_539_36),
            (0.020_861_895_78, 0.026_207_222_93),
            (0.113_074_868_8, 10.697_927_21),
        ];
        for (name, terms) in [
            ("silica", &silica[..]),
            ("sapphire", &sapphire),
            ("diamond", &[(0.3306, square(0.175)), (4.3356, square(0.106))]),
            ("water", &water),
            ("acrylic", &[(1.1819, 0.011_313)]),
            ("polycarbonate", &[(1.4182, 0.021_304)]),
        ] {
            let ((index, abbe), (wanted, wanted_abbe)) = (glass_indices(name).unwrap(), sellmeier(terms));
            assert!((f64::from(index) - wanted).abs() < 1e-4, "{name}: {wanted}");
            assert!((f64::from(abbe) - wanted_abbe).abs() < 0.02, "{name}: {wanted_abbe}");
        }
    }
}

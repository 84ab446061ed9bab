//! `cie-sky`: one of the 15 standard skies of the CIE, from overcast to clear, or its traditional overcast sky. [CIE 2003]

use super::LightEntry;
use super::sky_dome::{
    AZIMUTH, Amount, ELEVATION, GROUND, Gradation, SUN_DIAMETER, SkyFormula, Surroundings,
};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::exp;
use std::f32::consts::FRAC_PI_2;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "cie-sky",
        summary: "standard general sky of the CIE, from overcast to clear, with the light that it is to give",
        source: "CIE 2003",
        parameters: &[
            Parameter {
                name: "standard",
                summary: "its number: 1 overcast, 5 uniform, 7 partly cloudy, 12 clear, 13 clear and polluted, 15 turbid, 16 \
                          traditional overcast",
                unit: "",
                kind: ParameterKind::Integer { min: 1, max: 16 },
                default: "1",
            },
            ELEVATION,
            AZIMUTH,
            super::colour("irradiance", "irradiance of level ground by the sky without the sun", "W/m²", "1"),
            super::colour(
                "zenith",
                "radiance of the zenith; if it is not 0, irradiance does not count",
                "W/(m² sr)",
                "0",
            ),
            super::colour("sun", "irradiance by the sun of a surface that faces it", "W/m²", "0"),
            SUN_DIAMETER,
            GROUND,
            super::GROUP,
        ],
    },
    surrounds: true,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| {
        let zenith = reader.colour("zenith");
        let amount = match zenith.is_black() {
            true => Amount::Level(reader.colour("irradiance")),
            false => Amount::Zenith(zenith),
        };
        let formula = formula(reader.integer("standard"));
        Ok(Surroundings::read(reader).lights(&formula, amount, reader.colour("sun")))
    },
};

/// The number of the traditional overcast sky.
const OVERCAST: i64 = 16;

/// The sky of a number.
fn formula(standard: i64) -> SkyFormula {
    if standard == OVERCAST {
        return SkyFormula { gradation: Gradation::Overcast, indicatrix: [0.0; 3], across: 0.0 };
    }
    let [a, b, c, d, e] = STANDARD[(standard.clamp(1, STANDARD.len() as i64) - 1) as usize];
    let gradation = Gradation::Exponential([a, b]);
    SkyFormula { gradation, indicatrix: [c, d, e], across: exp(d * FRAC_PI_2) }
}

/// a to e of each type. \[CIE 2003, table 1]
const STANDARD: [[f32; 5]; 15] = [
    [4.0, -0.7, 0.0, -1.0, 0.0],
    [4.0, -0.7, 2.0, -1.5, 0.15],
    [1.1, -0.8, 0.0, -1.0, 0.0],
    [1.1, -0.8, 2.0, -1.5, 0.15],
    [0.0, -1.0, 0.0, -1.0, 0.0],
    [0.0, -1.0, 2.0, -1.5, 0.15],
    [0.0, -1.0, 5.0, -2.5, 0.3],
    [0.0, -1.0, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.3],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.3],
    [-1.0, -0.15, 16.0, -3.0, 0.3],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Vec3;
    use bilux_math::transcendental::{acos_f64, exp_f64, sin_cos_f64};

    /// The skies of the standard are pairs of six gradations, by a and b, and six indicatrices, by c, d and e. \[CIE 2003, 4]
    const GRADATIONS: [[f64; 2]; 6] =
        [[4.0, -0.7], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];
    const INDICATRICES: [[f64; 3]; 6] = [
        [0.0, -1.0, 0.0],
        [2.0, -1.5, 0.15],
        [5.0, -2.5, 0.3],
        [10.0, -3.0, 0.45],
        [16.0, -3.0, 0.3],
        [24.0, -2.8, 0.15],
    ];
    const PAIRS: [[usize; 2]; 15] = [
        [1, 1],
        [1, 2],
        [2, 1],
        [2, 2],
        [3, 1],
        [3, 2],
        [3, 3],
        [3, 4],
        [4, 2],
        [4, 3],
        [4, 4],
        [5, 4],
        [5, 5],
        [6, 5],
        [6, 6],
    ];

    /// Luminance of a sky at an elevation and an azimuth from the sun's, over that of the zenith; the sun stands 35 degrees high.
    fn found(standard: i64, [elevation, azimuth]: [f64; 2]) -> f64 {
        let direction = |elevation: f64, azimuth: f64| {
            let ((sin_e, cos_e), (sin_a, cos_a)) =
                (sin_cos_f64(elevation.to_radians()), sin_cos_f64(azimuth.to_radians()));
            Vec3::new((cos_e * sin_a) as f32, sin_e as f32, (cos_e * cos_a) as f32)
        };
        let (formula, sun) = (formula(standard), direction(35.0, 0.0));
        f64::from(formula.at(direction(elevation, azimuth), sun) / formula.at(Vec3::Y, sun))
    }

    #[test]
    fn skies_are_the_pairs_of_the_standard() {
        let sun = 35f64.to_radians();
        for (standard, [gradation, indicatrix]) in (1..).zip(PAIRS) {
            let ([a, b], [c, d, e]) = (GRADATIONS[gradation - 1], INDICATRICES[indicatrix - 1]);
            let part = |up: f64, away: f64| {
                let across = exp_f64(d * std::f64::consts::FRAC_PI_2);
                let cos = sin_cos_f64(away).1;
                (1.0 + a * exp_f64(b / up)) * (1.0 + c * (exp_f64(d * away) - across) + e * cos * cos)
            };
            for [elevation, azimuth] in [[10.0, 0.0], [35.0, 180.0], [60.0, 75.0]] {
                let (sin, cos) = sin_cos_f64(f64::to_radians(elevation));
                let across = sin_cos_f64(f64::to_radians(azimuth)).1;
                let away = acos_f64(sin * sin_cos_f64(sun).0 + cos * sin_cos_f64(sun).1 * across);
                let expected = part(sin, away) / part(1.0, std::f64::consts::FRAC_PI_2 - sun);
                let found = found(standard, [elevation, azimuth]);
                assert!(
                    (found / expected - 1.0).abs() < 1e-4,
                    "{standard} at {elevation}: {found} for {expected}"
                );
            }
        }
    }

    /// Radiance's `gensky 6 21 12 -c` gives these over the zenith: (1 + 2 sin γ) / 3, whatever the sun.
    #[test]
    fn the_sixteenth_is_the_overcast_sky_of_gensky() {
        for (elevation, expected) in [(0.0, 1.0 / 3.0), (30.0, 2.0 / 3.0), (45.0, 0.804_738), (90.0, 1.0)] {
            for azimuth in [0.0, 120.0] {
                let found = found(OVERCAST, [elevation, azimuth]);
                assert!((found - expected).abs() < 1e-5, "{elevation}: {found}");
            }
        }
    }
}

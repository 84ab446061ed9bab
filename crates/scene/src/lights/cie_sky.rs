//! `cie-sky`: one of the 15 standard skies of the CIE, from overcast to clear. [CIE 2003]

use super::LightEntry;
use super::sky_dome::{AZIMUTH, Amount, ELEVATION, GROUND, SUN_DIAMETER, SkyFormula, Surroundings};
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
                summary: "its number: 1 overcast, 5 uniform, 7 partly cloudy, 12 clear, 13 clear and polluted, 15 turbid",
                unit: "",
                kind: ParameterKind::Integer { min: 1, max: 15 },
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
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| {
        let zenith = reader.colour("zenith");
        let amount = match zenith.is_black() {
            true => Amount::Level(reader.colour("irradiance")),
            false => Amount::Zenith(zenith),
        };
        let coefficients = STANDARD[(reader.integer("standard").clamp(1, 15) - 1) as usize];
        let formula = SkyFormula { coefficients, across: exp(coefficients[3] * FRAC_PI_2) };
        Ok(Surroundings::read(reader).lights(&formula, amount, reader.colour("sun")))
    },
};

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

//! Light of the sun and of the sky, from irradiances that were measured. [Perez 1990]

use bilux_math::transcendental::{cos_f64, exp_f64, ln_f64, powf_f64, sin_cos_f64};
use std::f64::consts::TAU;

/// The irradiance by the sun above the atmosphere in W/m².
pub(super) const SOLAR_CONSTANT: f64 = 1367.0;

/// The amount of water in the air in cm at a dew point in °C.
pub(super) fn water(dew_point: f64) -> f64 {
    exp_f64(0.07 * dew_point - 0.075)
}

/// A sky by its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Air {
    pub(super) clearness: f64,
    pub(super) brightness: f64,
    /// The zenith angle of the sun in radians.
    pub(super) zenith: f64,
    /// The day of the year.
    pub(super) day: f64,
}

/// The upper ends of the ranges of clearness.
const RANGES: [f64; 7] = [1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2];

/// Of each range of clearness: lm/W of the sky. \[Perez 1990, table 4]
const OF_SKY: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91],
    [107.22, 1.15, 0.59, -3.95],
    [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74],
    [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03],
    [152.23, 0.35, -45.27, -7.98],
];

/// Of each range of clearness: lm/W of the sun. \[Perez 1990, table 4]
const OF_SUN: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12],
    [98.99, -3.46, -1.21, 12.38],
    [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16],
    [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44],
    [101.18, 1.58, -1.10, -8.29],
];

impl Air {
    /// By the irradiances by the sun, of a surface that faces it, and by the sky, of level ground.
    pub(super) fn of([direct, diffuse]: [f64; 2], zenith: f64, day: f64) -> Air {
        let cube = 1.041 * zenith * zenith * zenith;
        let clearness =
            if diffuse > 0.0 { ((diffuse + direct) / diffuse + cube) / (1.0 + cube) } else { 1.0 };
        let air = Air { clearness, brightness: 0.0, zenith, day };
        Air { brightness: diffuse * air.mass() / air.above(), ..air }.held()
    }

    /// Within the ranges of the formulas.
    pub(super) fn held(self) -> Air {
        let (clearness, brightness) = (self.clearness.clamp(1.0, 12.009), self.brightness.clamp(0.01, 0.6));
        Air { clearness, brightness, ..self }
    }

    /// The irradiances that it has.
    pub(super) fn irradiances(self) -> [f64; 2] {
        let cube = 1.041 * self.zenith * self.zenith * self.zenith;
        let diffuse = self.brightness / self.mass() * self.above();
        [diffuse * (self.clearness - 1.0) * (1.0 + cube), diffuse]
    }

    /// lm/W of the sun and of the sky, with so much water in the air.
    pub(super) fn efficacies(self, water: f64) -> [f64; 2] {
        let range = RANGES.partition_point(|end| *end <= self.clearness);
        let [a, b, c, d] = OF_SUN[range];
        let sun = a + b * water + c * exp_f64(5.73 * self.zenith - 5.0) + d * self.brightness;
        let [a, b, c, d] = OF_SKY[range];
        let sky = a + b * water + c * cos_f64(self.zenith) + d * ln_f64(self.brightness);
        [sun.max(0.0), sky.max(0.0)]
    }

    /// Air mass: how many times the vertical depth of the atmosphere the light of the sun passes. [Kasten 1966]
    fn mass(self) -> f64 {
        let degrees = self.zenith.to_degrees().min(90.0);
        1.0 / (cos_f64(degrees.to_radians()).max(0.0) + 0.15 * powf_f64(93.885 - degrees, -1.253))
    }

    /// The irradiance above the atmosphere on this day. [Spencer 1971]
    fn above(self) -> f64 {
        let day = TAU * (self.day - 1.0) / 365.0;
        let ((sin, cos), (sin_2, cos_2)) = (sin_cos_f64(day), sin_cos_f64(2.0 * day));
        SOLAR_CONSTANT * (1.00011 + 0.034221 * cos + 0.00128 * sin + 0.000719 * cos_2 + 0.000077 * sin_2)
    }
}

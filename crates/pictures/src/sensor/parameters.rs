//! Parameters of a sensor, on the command line and in Python.

use super::Pattern;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};

/// The row of the sensor.
pub const SENSOR: Entry = Entry {
    name: "sensor",
    summary: "what a camera's sensor reads of absolute radiance: photons, electrons, digital numbers",
    source: "EMVA 1288",
    parameters: &[
        number("exposure_time", "how long light is collected", "s", 1e-12, 1e6, "0.01"),
        number("f_number", "focal length over the diameter of the aperture", "", 0.25, 1e4, "2.8"),
        number("transmission", "the fraction of light that the lens lets through", "", 0.0, 1.0, "1"),
        number("iso", "saturation-based speed, which sets the gain; 0 leaves it to gain", "", 0.0, 1e9, "0"),
        number(
            "gain",
            "digital numbers per electron; 0 lets the full well reach the largest number",
            "DN/e-",
            0.0,
            1e9,
            "0",
        ),
        number("pixel_pitch", "side of a pixel", "µm", 0.01, 1e4, "3.45"),
        triple(
            "quantum_efficiency",
            "electrons per photon, in red, green and blue",
            "",
            0.0,
            1.0,
            "0.45 0.6 0.5",
        ),
        triple(
            "wavelength",
            "the wavelength that all light of a channel is taken to have",
            "nm",
            100.0,
            20_000.0,
            "600 555 450",
        ),
        number("full_well", "the most electrons that a pixel holds", "e-", 1.0, 1e9, "10000"),
        number("dark_current", "electrons per second without light", "e-/s", 0.0, 1e9, "1"),
        number("read_noise", "standard deviation of the noise of reading", "e-", 0.0, 1e6, "2.5"),
        number(
            "dark_nonuniformity",
            "standard deviation of the pixels' own dark signals (DSNU), the same for every seed",
            "e-",
            0.0,
            1e6,
            "0",
        ),
        number(
            "response_nonuniformity",
            "standard deviation of the pixels' own responses (PRNU), as a fraction, the same for every seed",
            "",
            0.0,
            1.0,
            "0",
        ),
        number("black_level", "the digital number without any electron", "DN", 0.0, 65_535.0, "64"),
        integer("bit_depth", "bits of a digital number", 1, 16, "12"),
        choice(
            "pattern",
            "colour filters of squares of four pixels; mono has none, prism all three in every pixel",
            Pattern::NAMES,
            "rggb",
        ),
        choice(
            "unit",
            "what the samples of the picture are; in cd/m2 a grey is taken as light of 555 nm, 683 lm/W",
            &["W/(m2 sr)", "cd/m2"],
            "W/(m2 sr)",
        ),
        choice(
            "output",
            "raw digital numbers, or the light that they stand for, in the unit of the picture",
            &["developed", "raw"],
            "developed",
        ),
        integer("seed", "chooses the noise", 0, i64::MAX, "0"),
    ],
};

const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    min: f64,
    max: f64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min, max }, default }
}

const fn triple(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    min: f64,
    max: f64,
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Colour { min, max }, default }
}

//! Parameters of a laser scanner.

use bilux_math::registry::{Entry, Parameter, ParameterKind, choice, integer};

/// The row of the scanner.
pub const LIDAR: Entry = Entry {
    name: "lidar",
    summary: "what a laser scanner measures: distance and intensity of the echoes of pulses",
    source: "",
    parameters: &[
        choice(
            "channel",
            "the channel whose reflectance is that at the laser's wavelength",
            &["red", "green", "blue"],
            "red",
        ),
        number("divergence", "full angle of a pulse's cone, evenly filled", "mrad", 0.0, 1000.0, "0"),
        integer("rays", "rays that follow each pulse", 1, 4096, "1"),
        number("min_range", "the least distance that is measured", "m", 0.0, 1e9, "0"),
        number("max_range", "the greatest distance that is measured", "m", 0.0, 1e9, "1e9"),
        number("separation", "echoes that are closer than this are one return", "m", 0.0, 1e9, "0.2"),
        number("threshold", "returns that are weaker than this are missed", "1/m²", 0.0, 1e9, "0"),
        number("range_noise", "standard deviation of distances", "m", 0.0, 1e6, "0"),
        number("intensity_noise", "standard deviation of intensities, as a fraction", "", 0.0, 10.0, "0"),
        integer("max_events", "mirrors and smooth glass that a ray is followed through", 0, 32, "8"),
        choice("returns", "which returns of each pulse are kept", Keep::NAMES, "all"),
        integer("seed", "chooses the noise", 0, i64::MAX, "0"),
    ],
};

/// Which returns of a pulse are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// All.
    All,
    /// The nearest one.
    First,
    /// The farthest one.
    Last,
    /// The most intense one.
    Strongest,
}

impl Keep {
    /// The names of the choices.
    pub const NAMES: &[&str] = &["all", "first", "last", "strongest"];

    /// The choice of one of the names.
    pub fn named(name: &str) -> Keep {
        match name {
            "first" => Keep::First,
            "last" => Keep::Last,
            "strongest" => Keep::Strongest,
            _ => Keep::All,
        }
    }
}

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

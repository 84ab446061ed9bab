//! The parameters of a material by which the phase function of its inside is chosen.

use bilux_math::registry::{Parameter, ParameterKind, choice};

pub(super) const NAMES: &[&str] = &["henyey-greenstein", "rayleigh", "draine", "droplets"];

pub(crate) const KIND: Parameter = choice(
    "phase",
    "the directions that the inside scatters into: by one number (henyey-greenstein), as air (rayleigh), as dust (draine), or as \
     fog, by the size of its droplets",
    NAMES,
    "henyey-greenstein",
);

pub(crate) const ANISOTROPY: Parameter = Parameter {
    name: "scattering_anisotropy",
    summary: "the mean cosine by which henyey-greenstein and draine scatter: 0 is even, 0.9 nearly straight on, negative back",
    unit: "",
    kind: ParameterKind::Number { min: -0.99, max: 0.99 },
    default: "0",
};

pub(crate) const DRAINE_ALPHA: Parameter = Parameter {
    name: "draine_alpha",
    summary: "the second number of draine: 0 is henyey-greenstein; 1 without anisotropy is rayleigh",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 1000.0 },
    default: "1",
};

pub(crate) const DIAMETER: Parameter = Parameter {
    name: "droplet_diameter",
    summary: "the diameter of droplets: 5 to 15 in clouds, 10 to 20 in fog, 50 in mist",
    unit: "µm",
    kind: ParameterKind::Number { min: 5.0, max: 50.0 },
    default: "15",
};

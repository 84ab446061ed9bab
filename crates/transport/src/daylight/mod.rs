//! Daylight over a year: how much of the light of each part of the sky reaches points, and where the sun reaches them itself.

mod coefficients;
mod patches;
mod sunlight;

pub use coefficients::{DaylightCoefficients, PartOfSky, daylight_coefficients};
pub use patches::SkyPatches;
pub use sunlight::sunlight;

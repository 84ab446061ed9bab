//! Readers and writers of the scenes of other renderers: Mitsuba, pbrt and Radiance.

pub mod mitsuba;
pub mod pbrt;
pub mod radiance;

//! Readers and writers of the scenes of other renderers: Mitsuba and pbrt.

pub mod mitsuba;
pub mod pbrt;

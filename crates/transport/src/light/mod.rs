//! Which lights are sampled, and where light subpaths begin.

pub(crate) mod choice;
pub(crate) mod emission;

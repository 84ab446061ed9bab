//! How light gets to the film: samplers, tiles and one file per integrator.

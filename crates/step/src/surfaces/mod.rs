//! Surfaces. [ISO 10303-42, 4.4]

mod elementary;
mod read;
mod spline;
mod surface;
mod swept;

pub(super) use read::{Scale, plane, surface};
pub(super) use surface::{Pole, Surface};

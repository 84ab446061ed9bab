//! Curves. [ISO 10303-42, 4.4]

mod conic;
mod curve;
mod read;
mod sampled;
mod spline;
mod trimmed;

pub(super) use curve::{Curve, least};
pub(super) use read::{curve, spline_form};
pub(super) use sampled::{Accuracy, sampled};

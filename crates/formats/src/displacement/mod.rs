//! Displacement: surfaces that a picture moves.

mod map;
mod moved;
mod tessellated;

pub(crate) use map::{Along, Displacement, Moved};
pub(crate) use moved::moved;
pub(crate) use tessellated::tessellated;

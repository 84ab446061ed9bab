//! Displacement: surfaces that a picture moves.

mod map;
mod moved;
mod tessellated;

pub use map::{Along, Displacement, Moved};
pub use moved::moved;
pub use tessellated::tessellated;

//! Meshes that change their shape: skins on joints, and blend shapes. Readers of several formats share them.

mod dual_quaternions;
mod shapes;
mod skin;

pub use dual_quaternions::{DualBlends, DualJoint};
pub use shapes::amounts;
pub use skin::{Blends, are_mirrored, move_points, turned};

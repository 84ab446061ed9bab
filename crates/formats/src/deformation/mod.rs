//! Meshes that change their shape: skins on joints, and blend shapes. Readers of several formats share them.

mod dual_quaternions;
mod shapes;
mod skin;

pub(crate) use dual_quaternions::{DualBlends, DualJoint};
pub(crate) use shapes::amounts;
pub(crate) use skin::{Blends, are_mirrored, move_points, turned};

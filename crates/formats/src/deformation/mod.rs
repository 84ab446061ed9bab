//! Meshes that change their shape: skins on joints, and blend shapes. Readers of several formats share them.

mod shapes;
mod skin;

pub(crate) use shapes::amounts;
pub(crate) use skin::{Blends, are_mirrored, move_points, turned};

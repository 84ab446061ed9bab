//! Placement of things: axes and units, transforms, animations, cameras, and what is all around.

pub mod between_keys;
pub mod camera_loss;
pub mod dome;
pub mod frame;
pub mod movement;
pub mod placement;
pub mod views;

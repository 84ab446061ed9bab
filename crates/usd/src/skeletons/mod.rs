//! `UsdSkel`: meshes that follow the joints of skeletons, and blend shapes.

mod animation;
mod binding;
mod blend_shapes;
mod influences;
mod rig;
mod skeleton;

pub(super) use animation::playing;
pub(super) use binding::Binding;
pub(super) use rig::{Bent, Rig};
pub(super) use skeleton::Pose;

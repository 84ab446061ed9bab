//! `UsdSkel`: meshes that follow the joints of skeletons, and blend shapes.

mod animation;
mod binding;
mod blend_shapes;
mod influences;
mod rig;
mod skeleton;

pub(crate) use animation::playing;
pub(crate) use binding::Binding;
pub(crate) use rig::{Bent, Rig};
pub(crate) use skeleton::Pose;

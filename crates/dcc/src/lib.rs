//! Readers of the files that modelling programs exchange: Collada and FBX.

pub mod dae;
pub mod fbx;

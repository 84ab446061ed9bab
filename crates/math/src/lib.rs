//! The mathematics under Bilux: vectors, boxes, frames, transforms, colour, warps, distributions.
//!
//! Nothing here knows what a scene is. Sampling routines come in triplets (`sample_x`, `x_pdf_…`, and the inverse
//! where it exists) so that each can be tested against the others deterministically.

pub mod aabb;
pub mod colour;
pub mod cpu_level;
pub mod frame;
pub mod hash;
pub mod motion;
pub mod parallel;
pub mod photometry;
pub mod registry;
pub mod stream;
pub mod transcendental;
pub mod transform;
pub mod warp;

pub use aabb::Aabb;
pub use colour::Rgb;
pub use cpu_level::CpuLevel;
pub use frame::Frame;
pub use glam::{self, DMat3, DMat4, DVec2, DVec3, Mat3, Mat4, Quat, UVec2, Vec2, Vec3};
pub use motion::{Motion, MotionKey};
pub use stream::{Stream, poisson};
pub use transform::Transform;

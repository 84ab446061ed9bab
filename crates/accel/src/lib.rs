//! Ray queries on triangles: watertight, deterministic, and with the same answer from every structure.
//!
//! ```
//! use bilux_accel::{build, BuildOptions, Query, Ray, TriangleMesh};
//!
//! let mesh = TriangleMesh::new(
//!     vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
//!     vec![[0, 1, 2]],
//! )?;
//! let tree = build("auto", mesh.into(), &BuildOptions::default())?;
//! let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
//! let hit = tree.closest_hit(&ray, &Query::default()).expect("the ray goes through the triangle");
//! assert_eq!((hit.t, hit.primitive), (1.0, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # One answer
//! Every structure returns the same hit as [`brute_force`], bit for bit: the smallest `t`, and among equal `t` the
//! lowest primitive. [`triangle`] (the lemma) and `docs/adr/0002-one-answer.md` explain why this holds.

pub mod accelerator;
pub mod brute_force;
pub mod brute_simd;
pub mod bsp;
pub mod bvh;
pub mod bvh8;
pub mod counters;
pub mod forest;
pub mod instancing;
pub mod kd_tree;
pub mod mesh;
pub mod primitives;
pub mod ray;
pub mod registry;
pub mod slab;
pub mod triangle;

pub use accelerator::{Accelerator, Traverse, TreeShape};
pub use bilux_math::CpuLevel;
pub use bvh::Bvh;
pub use bvh8::{Bvh8, CompactBvh8, RefitError};
pub use counters::Counters;
pub use forest::{Forest, PartialTree};
pub use instancing::{Instance, TopLevel, TwoLevel};
pub use kd_tree::KdTree;
pub use mesh::{MeshError, TriangleMesh};
pub use primitives::{PrimitiveTree, Primitives};
pub use ray::{Culling, Hit, Primitive, Query, Ray};
pub use registry::{ACCELERATORS, AcceleratorEntry, BuildError, BuildOptions, build};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

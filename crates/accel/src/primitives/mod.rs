//! Primitives other than triangles: spheres, capsules, discs, cones, quadrics and curves, each intersected
//! analytically, and any other shape whose crossings the caller can compute.
//!
//! ```
//! use bilux_accel::primitives::{PrimitiveTree, Shape, Sphere};
//! use bilux_accel::{Accelerator, Query, Ray};
//!
//! let balls = vec![
//!     Shape::Sphere(Sphere { centre: [0.0, 0.0, 0.0], radius: 1.0 }),
//!     Shape::Sphere(Sphere { centre: [0.0, 0.0, -5.0], radius: 2.0 }),
//! ];
//! let tree = PrimitiveTree::new(balls);
//! let hits = tree.all_hits(&Ray::new([0.0, 0.0, 4.0], [0.0, 0.0, -1.0]), &Query::default());
//! assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [3.0, 5.0, 7.0, 11.0]);
//! ```
//!
//! A [`PrimitiveTree`] is an [`crate::Accelerator`] like any other: as an [`crate::Instance`] it can stand next to
//! meshes in a [`crate::TwoLevel`].
//!
//! # Crossings
//! All crossings are computed in f64 from the given f32 numbers, and rounded once. When a ray leaves a curved
//! primitive ([`Ray::exclude`]), that primitive omits the crossing nearest to the ray's origin, which is the origin
//! itself: so a ray sent through a sphere from its surface hits the far side, and never the near one again.

mod capsule;
mod cone;
mod curve;
mod disc;
mod quadric;
mod roots;
mod rounding;
mod sphere;
mod tree;

pub use crate::triangle::Crossing;
pub use capsule::Capsule;
pub use cone::Cone;
pub use curve::Curve;
pub use disc::Disc;
pub use quadric::Quadric;
pub use sphere::Sphere;
pub use tree::PrimitiveTree;

use crate::ray::Ray;

/// Any indexed primitives with known bounding boxes and crossings.
pub trait Primitives: Send + Sync {
    /// The number of primitives; only the first 2³² − 2 are used.
    fn len(&self) -> usize;
    /// The bounding box of one primitive, as its minimum and maximum corner: every crossing lies within it, apart
    /// from the rounding of the distance. Primitives whose box is empty or not finite are never hit.
    fn bounds(&self, index: u32) -> [[f32; 3]; 2];
    /// Calls `visit` with every crossing of one primitive with the infinite line of a ray, in any order; the caller
    /// checks the ends of the ray itself. The ray is valid: finite, with a non-zero direction. NaN distances are
    /// ignored.
    fn crossings(&self, index: u32, ray: &Ray, visit: &mut dyn FnMut(Crossing));
    /// True when there are no primitives.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One of the built-in shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// See [`Sphere`].
    Sphere(Sphere),
    /// See [`Disc`].
    Disc(Disc),
    /// See [`Cone`]; a cylinder is one.
    Cone(Cone),
    /// See [`Quadric`].
    Quadric(Quadric),
    /// See [`Curve`].
    Curve(Curve),
    /// See [`Capsule`].
    Capsule(Capsule),
}

impl Shape {
    /// Minimum and maximum corner of the bounding box.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        match self {
            Shape::Sphere(sphere) => sphere.bounds(),
            Shape::Disc(disc) => disc.bounds(),
            Shape::Cone(cone) => cone.bounds(),
            Shape::Quadric(quadric) => quadric.bounds(),
            Shape::Curve(curve) => curve.bounds(),
            Shape::Capsule(capsule) => capsule.bounds(),
        }
    }

    /// Calls `visit` with every crossing with the infinite line of a ray, as [`Primitives::crossings`] does; `leaves`
    /// says whether the ray leaves this shape.
    pub fn crossings(&self, ray: &Ray, leaves: bool, visit: &mut dyn FnMut(Crossing)) {
        match self {
            Shape::Sphere(sphere) => sphere.crossings(ray, leaves, visit),
            Shape::Disc(disc) if !leaves => disc.crossings(ray, visit),
            Shape::Cone(cone) => cone.crossings(ray, leaves, visit),
            Shape::Quadric(quadric) => quadric.crossings(ray, leaves, visit),
            Shape::Curve(curve) if !leaves => curve.crossings(ray, visit),
            Shape::Capsule(capsule) => capsule.crossings(ray, leaves, visit),
            Shape::Disc(_) | Shape::Curve(_) => {}
        }
    }
}

impl Primitives for Vec<Shape> {
    fn len(&self) -> usize {
        self.as_slice().len()
    }

    fn bounds(&self, index: u32) -> [[f32; 3]; 2] {
        self[index as usize].bounds()
    }

    fn crossings(&self, index: u32, ray: &Ray, visit: &mut dyn FnMut(Crossing)) {
        self[index as usize].crossings(ray, ray.exclude.index == index, visit);
    }
}

//! What is no triangle: spheres, capsules, discs, cones, quadrics and curves, each met where its formula says, and whatever
//! else somebody can find the crossings of.
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
//! A [`PrimitiveTree`] is an [`crate::Accelerator`] like any other: as an [`crate::Instance`] it stands beside
//! meshes in a [`crate::TwoLevel`].
//!
//! # Crossings
//! All of them are computed in f64 from the f32 numbers given, and rounded once. Of the primitive that a ray leaves
//! ([`Ray::exclude`]) a curved one leaves out the crossing that is nearest to the ray's origin, which is the origin
//! itself: so a ray that is sent through a sphere from its surface meets the far side, and never the near one again.

mod capsule;
mod cone;
mod curve;
mod disc;
mod quadric;
mod roots;
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
use bilux_math::Aabb;
use bilux_math::glam::DVec3;

/// Anything numbered whose boxes and crossings are known.
pub trait Primitives: Send + Sync {
    /// How many there are; the first 2³² − 2 are looked at.
    fn len(&self) -> usize;
    /// A box around one, as its least and greatest corner: every crossing lies within it, but for the rounding of
    /// the distance. Primitives whose box is empty or not finite are never met.
    fn bounds(&self, index: u32) -> [[f32; 3]; 2];
    /// Calls `visit` with every crossing of one with the line of a ray, in any order; it looks at the ends of the
    /// ray itself. The ray is one that makes sense: finite, with a direction. Distances that are not numbers
    /// are not looked at.
    fn crossings(&self, index: u32, ray: &Ray, visit: &mut dyn FnMut(Crossing));
    /// True when there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One of the shapes that are known here.
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
    /// Least and greatest corner of the box around it.
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

    /// Calls `visit` with every crossing with the line of a ray, as [`Primitives::crossings`]; `leaves` where the ray leaves this
    /// shape.
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

/// Exactly.
fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// The box around two corners, rounded outwards.
fn outwards(low: DVec3, high: DVec3) -> [[f32; 3]; 2] {
    [low.to_array().map(|x| (x as f32).next_down()), high.to_array().map(|x| (x as f32).next_up())]
}

/// The box as the trees have it; empty when a corner is not finite.
fn aabb([low, high]: [[f32; 3]; 2]) -> Aabb {
    if low.iter().chain(&high).all(|x| x.is_finite()) {
        Aabb { min: low.into(), max: high.into() }
    } else {
        Aabb::EMPTY
    }
}

//! A ray in a tree's coordinates: which sides of a plane it must visit, and between which distances.
//!
//! # Why no hit is missed
//! Suppose the triangle test accepts a triangle at `t`. By the lemma of [`crate::triangle`], the point P at `t` is
//! within `pad` of a point Q of the triangle, on every axis. Follow Q down the tree: a builder puts a triangle on
//! each side where it has points, and omits a side only when the triangle reaches less than `tolerance` over the
//! plane. So at every node, some side that holds the triangle has Q no further than `tolerance` behind the plane, and
//! P no further than `tolerance + pad · |n|₁`. Traversal visits a child where the ray is at most [`Path`]'s `slack`
//! behind the plane, which covers this and the roundings of the traversal itself, with u = 2⁻²⁴ and all lengths in
//! units of `far`:
//!
//! | | axis planes, u | other planes, u (|n|₁ ≤ √3) |
//! | --- | --- | --- |
//! | the lemma's pad | 16 | 28 |
//! | tolerance of the builder | 8 | 8 |
//! | moving the origin; distance from the plane | 2 | 11 |
//! | direction along the normal, times t | – | 6 |
//! | offset, reciprocal and product | 5 | 7 |
//! | sum | 31 | 60 |
//! | allowed | 32 = 2 pads | 64 = 4 pads |

use crate::triangle::PreparedRay;
use bilux_math::{Aabb, Vec3};

/// A ray on its way down a tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    origin: [f32; 3],
    direction: [f32; 3],
    inverse: [f32; 3],
    /// Added to a plane's offset, these give the distances (before `inverse`) up to which the near side must be
    /// visited, and from which the far side must be.
    near: [f32; 3],
    far: [f32; 3],
    /// 1 where the ray travels down an axis, so that the right child is the near one.
    flip: [u32; 3],
    slack: f32,
}

/// Crossing of a ray and a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneCrossing {
    /// 1 when the right side is the near one.
    pub(super) flip: u32,
    /// The near side ends here.
    pub(super) near_until: f32,
    /// The far side begins here.
    pub(super) far_from: f32,
}

impl Path {
    pub(super) fn new(ray: &PreparedRay, bounds: &Aabb, centre: Vec3) -> Path {
        let slack = 2.0 * slack(ray, bounds);
        let direction = ray.ray.direction;
        let origin = (Vec3::from(ray.ray.origin) - centre).to_array();
        let down = direction.map(f32::is_sign_negative);
        let offset =
            |axis: usize, sign: f32| (if down[axis] { -sign * slack } else { sign * slack }) - origin[axis];
        Path {
            origin,
            direction,
            inverse: direction.map(|d| 1.0 / d),
            near: [offset(0, 1.0), offset(1, 1.0), offset(2, 1.0)],
            far: [offset(0, -1.0), offset(1, -1.0), offset(2, -1.0)],
            flip: down.map(u32::from),
            slack: 2.0 * slack,
        }
    }

    /// The interval between two distances in which the ray is inside a box (in the tree's coordinates); `None` if it
    /// never is.
    pub(super) fn clip(&self, low: Vec3, high: Vec3, mut from: f32, mut until: f32) -> Option<(f32, f32)> {
        for axis in 0..3 {
            let (near, far) =
                if self.flip[axis] == 0 { (low[axis], high[axis]) } else { (high[axis], low[axis]) };
            from = later(from, self.across(axis, near).far_from);
            until = earlier(until, self.across(axis, far).near_until);
        }
        (from <= until).then_some((from, until))
    }

    /// The crossing of a plane perpendicular to an axis.
    #[inline(always)]
    pub(super) fn across(&self, axis: usize, at: f32) -> PlaneCrossing {
        let inverse = self.inverse[axis];
        PlaneCrossing {
            flip: self.flip[axis],
            near_until: (at + self.near[axis]) * inverse,
            far_from: (at + self.far[axis]) * inverse,
        }
    }

    /// The crossing of any plane, given as its normal and offset.
    #[inline(always)]
    pub(super) fn through(&self, [x, y, z, at]: [f32; 4]) -> PlaneCrossing {
        let [ox, oy, oz] = self.origin;
        let [dx, dy, dz] = self.direction;
        let speed = x * dx + y * dy + z * dz;
        let distance = at - (x * ox + y * oy + z * oz);
        let down = speed.is_sign_negative();
        let (ahead, inverse) = (if down { -distance } else { distance }, 1.0 / speed.abs());
        PlaneCrossing {
            flip: u32::from(down),
            near_until: (ahead + self.slack) * inverse,
            far_from: (ahead - self.slack) * inverse,
        }
    }
}

/// The lemma's pad, or infinity for rays whose arithmetic might leave the range of f32: those are not pruned at all.
/// A `t` that underflows is off by up to 2⁻¹⁴⁹, hence the last term (a normal number, because denormals are slow).
fn slack(ray: &PreparedRay, bounds: &Aabb) -> f32 {
    let pad = ray.pad(bounds);
    let reach = ray.ray.direction.iter().fold(0f32, |reach, d| reach.max(d.abs()));
    let is_regular = pad < LARGE && reach < LARGE && reach > 1.0 / LARGE;
    if is_regular { pad + reach.max(1.0) * f32::MIN_POSITIVE } else { f32::INFINITY }
}

/// 2¹⁰⁰.
const LARGE: f32 = 1.267_650_6e30;

/// The smaller of two distances. The second may be NaN (0 · ∞, for a ray within a plane): it then carries no
/// information, and the first is returned.
#[inline(always)]
pub(super) fn earlier(this: f32, that: f32) -> f32 {
    if that < this { that } else { this }
}

/// The larger of two distances, likewise.
#[inline(always)]
pub(super) fn later(this: f32, that: f32) -> f32 {
    if that > this { that } else { this }
}

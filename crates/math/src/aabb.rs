//! Axis-aligned bounding boxes.

use glam::Vec3;

/// An axis-aligned bounding box, closed on every side. Empty when `min > max` on some axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The minimum corner.
    pub min: Vec3,
    /// The maximum corner.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box; the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box that contains some points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, Aabb::with_point)
    }

    /// This box enlarged to contain `point`.
    #[inline]
    pub fn with_point(self, point: Vec3) -> Aabb {
        Aabb { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that contains both.
    #[inline]
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The intersection of both.
    #[inline]
    pub fn intersection(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// True when the box contains no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// True when a point is inside or on the boundary.
    #[inline]
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The centre; meaningless for an empty box.
    #[inline]
    pub fn centre(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths; zero for an empty box.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// Half of the surface area, the measure that the surface-area heuristic uses.
    #[inline]
    pub fn half_area(&self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The box enlarged by `margin` on every side.
    #[inline]
    pub fn expanded(self, margin: f32) -> Aabb {
        Aabb { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        let pick = |bit: usize, i: usize, axis: usize| {
            if i >> bit & 1 == 0 { self.min[axis] } else { self.max[axis] }
        };
        std::array::from_fn(|i| Vec3::new(pick(0, i, 0), pick(1, i, 1), pick(2, i, 2)))
    }

    /// Radius of the sphere around [`Aabb::centre`] that contains the box; zero when empty.
    pub fn radius(&self) -> f32 {
        self.extent().length() * 0.5
    }
}

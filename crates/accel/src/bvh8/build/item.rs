//! The items of the builder: bounding boxes of triangles, as vectors of four.

use crate::bvh8::layout::Planes;
use crate::mesh::TriangleMesh;
use bilux_math::Vec3;
use bilux_math::glam::Vec4;
use bilux_math::parallel::{map, ranges, table};
use std::ops::Range;

/// The bounding box of a triangle. The fourth components hold the two halves of its index, as integer-valued floats:
/// the raw bits of an index would be denormal numbers, which are slow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

impl Item {
    pub(super) fn new(planes: &Planes, index: u32) -> Item {
        let with = |corner: [f32; 3], half: u32| Vec3::from(corner).extend(half as f32);
        Item { low: with(planes[0], index & 0xffff), high: with(planes[1], index >> 16) }
    }

    pub(super) fn index(&self) -> u32 {
        self.low.w as u32 | (self.high.w as u32) << 16
    }

    /// The part of it that lies in a box.
    pub(super) fn within(&self, bounds: &Bounds) -> Item {
        let (low, high) = (self.low.max(bounds.low), self.high.min(bounds.high));
        Item { low: low.truncate().extend(self.low.w), high: high.truncate().extend(self.high.w) }
    }

    /// True when its box is empty.
    pub(super) fn is_nothing(&self) -> bool {
        (0..3).any(|k| self.low[k] > self.high[k])
    }

    #[inline(always)]
    pub(super) fn centre(&self) -> Vec4 {
        self.low * 0.5 + self.high * 0.5
    }
}

/// Number of items that one thread processes.
const MANY: usize = 1 << 14;

/// A bounding box that grows; the fourth components have no meaning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vec4,
    pub(super) high: Vec4,
}

impl Bounds {
    pub(super) const EMPTY: Bounds = Bounds { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };

    pub(super) fn of(items: &[Item]) -> Bounds {
        if items.len() > MANY {
            return map(items.chunks(MANY), Bounds::of).into_iter().fold(Bounds::EMPTY, Bounds::union);
        }
        items.iter().fold(Bounds::EMPTY, |all, item| all.with(item))
    }

    #[inline(always)]
    pub(super) fn with(self, item: &Item) -> Bounds {
        Bounds { low: self.low.min(item.low), high: self.high.max(item.high) }
    }

    #[inline(always)]
    pub(super) fn with_point(self, point: Vec4) -> Bounds {
        Bounds { low: self.low.min(point), high: self.high.max(point) }
    }

    #[inline(always)]
    pub(super) fn union(self, other: Bounds) -> Bounds {
        Bounds { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let e = self.high - self.low;
        e.x * (e.y + e.z) + e.y * e.z
    }

    /// The half area of the overlap of two boxes.
    pub(super) fn shared_half_area(&self, other: &Bounds) -> f32 {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if (0..3).all(|k| low[k] <= high[k]) { Bounds { low, high }.half_area() } else { 0.0 }
    }

    pub(super) fn planes(&self) -> Planes {
        [self.low.truncate().to_array(), self.high.truncate().to_array()]
    }
}

/// One item for each finite triangle, in their order.
pub(super) fn items_of(mesh: &TriangleMesh) -> Vec<Item> {
    let triangles = mesh.triangles();
    let item = |index: usize| {
        let [a, b, c] = triangles[index].map(Vec3::from);
        let planes = [a.min(b).min(c).to_array(), a.max(b).max(c).to_array()];
        // Zero times a finite number is zero, and NaN otherwise.
        let finite = ((a * 0.0 + b * 0.0) + c * 0.0).cmpeq(Vec3::ZERO).all();
        (Item::new(&planes, index as u32), finite)
    };
    let is_finite = |some: &[[[f32; 3]; 3]]| some.iter().flatten().flatten().all(|x| x.is_finite());
    if map(triangles.chunks(MANY), is_finite).into_iter().all(|is_finite| is_finite) {
        return table(triangles.len(), MANY, |index| item(index).0);
    }
    let of = |some: Range<usize>| {
        some.map(item).filter_map(|(item, finite)| finite.then_some(item)).collect::<Vec<_>>()
    };
    map(ranges(triangles.len(), MANY), of).concat()
}

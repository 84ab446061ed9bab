//! Rays, queries, and hits.

use crate::mesh::TriangleMesh;
use bilux_math::glam::DVec3;
use std::fmt;

/// A half-line, or a segment of one: points `origin + t * direction` for `t_min <= t <= t_max`.
///
/// The direction need not have unit length; `t` is measured in lengths of the direction. A ray whose origin or
/// direction is not finite, or whose direction is zero, hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Origin of the ray.
    pub origin: [f32; 3],
    /// Direction of the ray.
    pub direction: [f32; 3],
    /// Minimum `t` that counts as a hit.
    pub t_min: f32,
    /// Maximum `t` that counts as a hit; may be infinite.
    pub t_max: f32,
    /// The time of the ray, in seconds; only moving instances use it.
    pub time: f32,
    /// The primitive that the ray leaves, and therefore cannot hit: a line does not hit a plane twice.
    pub exclude: Primitive,
    /// Which instances it can hit: those that share a bit with it.
    pub mask: u32,
}

impl Ray {
    /// A ray from `origin` without an end.
    pub const fn new(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        let (exclude, mask) = (Primitive::NONE, u32::MAX);
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, time: 0.0, exclude, mask }
    }

    /// Whether its direction is zero: what a camera returns where its film sees nothing.
    pub fn is_nowhere(&self) -> bool {
        self.direction == [0.0; 3]
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> [f32; 3] {
        std::array::from_fn(|axis| self.origin[axis] + t * self.direction[axis])
    }
}

/// A triangle of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Primitive {
    /// Index of the instance; 0 where there is only a mesh.
    pub instance: u32,
    /// Index of the triangle within its mesh.
    pub index: u32,
}

impl Primitive {
    /// No primitive at all.
    pub const NONE: Primitive = Primitive { instance: u32::MAX, index: u32::MAX };
}

/// A hit of a ray on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex, 0..=1.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex, 0..=1.
    pub v: f32,
    /// Index of the triangle within its mesh.
    pub primitive: u32,
    /// Index of the instance; 0 where there is only a mesh.
    pub instance: u32,
}

impl Hit {
    /// Which triangle of which instance was hit.
    pub const fn primitive(&self) -> Primitive {
        Primitive { instance: self.instance, index: self.primitive }
    }

    /// The hit point; `ray` is the ray of the query.
    pub fn point(&self, ray: &Ray) -> [f32; 3] {
        ray.at(self.t)
    }

    /// The unit normal of the triangle that was hit, on the side from which its vertices run counter-clockwise, in
    /// the space of its mesh; zero where the triangle has no area. Panics, as indexing a slice does, when the hit
    /// comes from another mesh that has more triangles.
    pub fn normal(&self, mesh: &TriangleMesh) -> [f32; 3] {
        let [a, b, c] = mesh.triangles()[self.primitive as usize].map(|p| DVec3::from(p.map(f64::from)));
        (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
    }

    /// This hit without negative zeros.
    pub(crate) fn with_positive_zeros(self) -> Hit {
        // Adding zero changes no number but -0.
        Hit { t: self.t + 0.0, u: self.u + 0.0, v: self.v + 0.0, ..self }
    }
}

/// Which side of triangles can be hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Culling {
    /// Both sides.
    #[default]
    None,
    /// Only the front, from which the vertices run counter-clockwise. For closed, opaque meshes.
    Back,
}

/// Decides whether a hit counts: false lets the ray pass, as through the cut-out part of a leaf's opacity mask. It
/// must give the same answer every time for the same hit: structures evaluate hits in any order, some of them twice,
/// and others not at all.
pub type Filter<'a> = &'a (dyn Fn(&Hit) -> bool + Sync);

/// The options of a query: the first two are part of the question. The switches below them change how much work an
/// answer takes, never the answer; they exist so that the saving of each can be measured.
#[derive(Clone, Copy)]
pub struct Query<'a> {
    /// Which side of triangles can be hit.
    pub culling: Culling,
    /// Which hits count; without a filter, all do.
    pub filter: Option<Filter<'a>>,
    /// End the search at the first hit that nothing nearer can beat (on by default).
    pub early_out: bool,
    /// With [`Culling::Back`], reject back faces by the side of their partition plane where the tree
    /// has one, before the triangle test (on by default).
    pub cull_by_partition: bool,
}

impl Default for Query<'_> {
    fn default() -> Self {
        Query::PLAIN
    }
}

impl Query<'_> {
    /// The most common query: all hits count, and the search may end early.
    pub(crate) const PLAIN: Query<'static> =
        Query { culling: Culling::None, filter: None, early_out: true, cull_by_partition: true };

    /// True for a query that needs no more than [`Query::PLAIN`].
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.filter.is_none() && self.culling == Culling::None && self.early_out
    }

    /// True when the filter accepts a hit.
    #[inline(always)]
    pub(crate) fn accepts(&self, hit: &Hit) -> bool {
        self.filter.is_none_or(|filter| filter(hit))
    }
}

impl fmt::Debug for Query<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Query")
            .field("culling", &self.culling)
            .field("filter", &self.filter.map(|_| "…"))
            .field("early_out", &self.early_out)
            .field("cull_by_partition", &self.cull_by_partition)
            .finish()
    }
}

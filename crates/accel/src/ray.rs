//! Rays, what is asked of them, and what they hit.

use crate::mesh::TriangleMesh;
use bilux_math::glam::DVec3;
use std::fmt;

/// A half-line, or a piece of one: points `origin + t * direction` for `t_min <= t <= t_max`.
///
/// The direction need not be of unit length; `t` counts in its lengths. A ray whose origin or direction
/// is not finite, or whose direction is zero, hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes.
    pub direction: [f32; 3],
    /// Least `t` that counts as a hit.
    pub t_min: f32,
    /// Greatest `t` that counts as a hit; may be infinite.
    pub t_max: f32,
    /// When it is sent, in seconds; asked by moving instances only.
    pub time: f32,
    /// The primitive that it leaves, which it therefore cannot hit: planes do not meet a line twice.
    pub exclude: Primitive,
    /// Which instances it can meet: those that share a bit with it.
    pub mask: u32,
}

impl Ray {
    /// A ray from `origin` that goes on for ever.
    pub const fn new(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        let (exclude, mask) = (Primitive::NONE, u32::MAX);
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, time: 0.0, exclude, mask }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> [f32; 3] {
        std::array::from_fn(|axis| self.origin[axis] + t * self.direction[axis])
    }
}

/// Which triangle of which instance.
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

/// Where a ray meets a triangle.
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

    /// The point that was hit: `ray` is the one that was asked.
    pub fn point(&self, ray: &Ray) -> [f32; 3] {
        ray.at(self.t)
    }

    /// The unit normal of the triangle that was hit, on the side from which its vertices run counter-clockwise, in the
    /// space of its mesh; zero where the triangle has no area. Panics, as slices do, when the hit is of another mesh
    /// that has more triangles.
    pub fn normal(&self, mesh: &TriangleMesh) -> [f32; 3] {
        let [a, b, c] = mesh.triangles()[self.primitive as usize].map(|p| DVec3::from(p.map(f64::from)));
        (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array()
    }

    /// The same hit, without zeros of negative sign.
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

/// Says of a hit whether it counts: false lets the ray pass, as through the holes of a leaf that is drawn on a
/// square. It must answer the same whenever it is asked of the same hit: structures look at hits in any order,
/// some twice, and others not at all.
pub type Filter<'a> = &'a (dyn Fn(&Hit) -> bool + Sync);

/// What is asked of a structure: the first two are part of the question. The switches below them change how much
/// work an answer takes, never the answer; they are there so that what each saves can be measured.
#[derive(Clone, Copy)]
pub struct Query<'a> {
    /// Which side of triangles can be hit.
    pub culling: Culling,
    /// Which hits count; all, where there is none.
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
    /// What most are asked: all hits count, and the search may end early.
    pub(crate) const PLAIN: Query<'static> =
        Query { culling: Culling::None, filter: None, early_out: true, cull_by_partition: true };

    /// True of what asks no more than [`Query::PLAIN`].
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.filter.is_none() && self.culling == Culling::None && self.early_out
    }

    /// True when the filter lets a hit count.
    #[inline(always)]
    pub(crate) fn keeps(&self, hit: &Hit) -> bool {
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

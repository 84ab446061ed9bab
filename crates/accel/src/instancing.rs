//! Two levels: instances of structures, each with its own static or moving transform.
//!
//! A ray is always transformed into an instance's space by the same arithmetic: in f64, by the inverse of the f32
//! matrix, rounded once. Its direction keeps its length there, so `t` is the same in both spaces. An instance whose
//! transform is the identity is queried with the ray unchanged.
//!
//! # Which side is the front
//! The front is the instance's own: a mirrored instance shows the same side of its surface as the original, as in
//! glTF. So culling need not consider mirroring.
//!
//! # How far a box must be padded
//! Let `x` be the point where a ray hits an instance, `M` its matrix and `κ = ‖M‖·‖M⁻¹‖`. In the instance's space the
//! hit lies within `16 · 2⁻²⁴ · far'` of the mesh (the lemma of [`crate::triangle`]), and rounding the ray's origin
//! and direction moves it by `2 · 2⁻²⁴ · far'` more, where `far' ≤ ‖M⁻¹‖ · far` and `far` is the maximum distance
//! from the origin to the instance's box and to the image of the instance's own origin. Back in the world that is at
//! most `18 · 2⁻²⁴ · κ · far`; [`TwoLevel`] pads by 32. The full argument is in `docs/adr/0002-one-answer.md`.

use crate::accelerator::{Accelerator, Traverse, TreeShape};
use crate::bvh::tree::Tree;
use crate::counters::Count;
use crate::ray::{Hit, Primitive, Query, Ray};
use crate::slab::SlabRay;
use bilux_math::glam::{DMat3, DVec3};
use bilux_math::parallel::table;
use bilux_math::{Aabb, Motion, Transform, Vec3};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Number of instances that one thread places at a time.
const TOGETHER: usize = 16;

/// A structure placed in the world. Many instances may share one structure.
#[derive(Clone)]
pub struct Instance {
    /// The structure, in its own space.
    pub accelerator: Arc<dyn Accelerator>,
    /// Transform of the structure into the world, over time.
    pub motion: Motion,
    /// Which rays can hit it: those that share a bit with it.
    pub mask: u32,
}

impl Instance {
    /// An instance that all rays can hit.
    pub fn new(accelerator: Arc<dyn Accelerator>, motion: Motion) -> Instance {
        Instance { accelerator, motion, mask: u32::MAX }
    }
}

/// Method of finding the instances that a ray may hit. The answers are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TopLevel {
    /// All of them, one after the other.
    List,
    /// By a bounding volume hierarchy over their boxes.
    #[default]
    Bvh,
}

/// Instances of structures. Cheap to rebuild when something moves: only the boxes of the instances are read.
pub struct TwoLevel {
    placed: Vec<Placed>,
    shutter: [f32; 2],
    bounds: Aabb,
    top: Top,
}

enum Top {
    List,
    Bvh { tree: Tree, order: Vec<u32>, reach: PadBounds },
}

struct Placed {
    accelerator: Arc<dyn Accelerator>,
    place: InstancePlacement,
    mask: u32,
}

enum InstancePlacement {
    Identity,
    Still(IntoLocal),
    Moving(Motion),
}

impl TwoLevel {
    /// Builds the top level over these instances, for rays at times while the shutter is open (seconds, both ends
    /// included); a ray's time is clamped to that interval. Instance indices in hits are those of the list.
    pub fn new(instances: &[Instance], shutter: [f32; 2], top: TopLevel) -> TwoLevel {
        let boxes: Vec<Aabb> = table(instances.len(), TOGETHER, |i| {
            let instance = &instances[i];
            match instance.motion.is_still_over(shutter) {
                true if instance.motion.at(shutter[0]).is_identity() => instance.accelerator.bounds(),
                _ => instance.motion.bounds_over(&instance.accelerator.bounds(), shutter),
            }
        });
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, bounds| all.union(*bounds));
        let top = match top {
            // A single instance is queried directly: it tests its own box.
            _ if boxes.len() < 2 => Top::List,
            TopLevel::List => Top::List,
            TopLevel::Bvh => {
                let (tree, order) = Tree::over(boxes.len(), |index| boxes[index as usize]);
                Top::Bvh { tree, order, reach: PadBounds::of(instances, &boxes, shutter) }
            }
        };
        drop(boxes);
        let placed = table(instances.len(), TOGETHER, |i| Placed::new(&instances[i], shutter));
        TwoLevel { placed, shutter, bounds, top }
    }

    /// The number of instances.
    pub fn len(&self) -> usize {
        self.placed.len()
    }

    /// True when there are no instances.
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// Calls `visit` with the instances that may be hit, in any order, until it breaks. `visit` returns the `t`
    /// beyond which hits no longer count.
    #[inline(always)]
    fn visit<C: Count>(
        &self,
        ray: &Ray,
        count: &mut C,
        mut visit: impl FnMut(u32, &mut C) -> ControlFlow<(), f32>,
    ) {
        let (tree, order, reach) = match &self.top {
            Top::Bvh { tree, order, reach } => (tree, order, reach),
            Top::List => {
                for index in 0..self.placed.len() as u32 {
                    if visit(index, count).is_break() {
                        return;
                    }
                }
                return;
            }
        };
        let slabs = SlabRay::new(ray.origin, ray.direction, ray.t_min, reach.pad(ray));
        tree.walk(&slabs, slabs.limit(ray.t_max), count, |leaf, count| {
            let mut limit = slabs.limit(ray.t_max);
            for &index in &order[leaf] {
                limit = slabs.limit(visit(index, count)?);
            }
            ControlFlow::Continue(limit)
        });
    }

    fn local_ray(&self, index: u32, ray: &Ray, t_max: f32) -> Ray {
        let (origin, direction) = match &self.placed[index as usize].place {
            InstancePlacement::Identity => (ray.origin, ray.direction),
            InstancePlacement::Still(into) => into.apply(ray),
            InstancePlacement::Moving(motion) => {
                // Written so that a NaN time becomes the opening of the shutter.
                let [open, close] = self.shutter;
                let time = if ray.time > open { ray.time.min(close) } else { open };
                IntoLocal::new(&motion.at(time)).apply(ray)
            }
        };
        let exclude = match ray.exclude {
            Primitive { instance, index: primitive } if instance == index => {
                Primitive { instance: 0, index: primitive }
            }
            _ => Primitive::NONE,
        };
        Ray { origin, direction, t_max, exclude, ..*ray }
    }
}

/// True for rays that can hit nothing, see [`Ray`].
fn is_invalid_ray(ray: &Ray) -> bool {
    let finite = ray.origin.iter().chain(&ray.direction).all(|c| c.is_finite());
    !finite || ray.direction == [0.0; 3] || ray.t_min.is_nan() || ray.t_max.is_nan()
}

impl Traverse for TwoLevel {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        if is_invalid_ray(ray) {
            return None;
        }
        let mut nearest: Option<Hit> = None;
        let mut t_max = ray.t_max;
        self.visit(ray, count, |index, count| {
            let Placed { accelerator, mask, .. } = &self.placed[index as usize];
            if mask & ray.mask == 0 {
                return ControlFlow::Continue(t_max);
            }
            let local = self.local_ray(index, ray, t_max);
            let accepts = |hit: &Hit| query.accepts(&Hit { instance: index, ..*hit });
            let query = &Query { filter: query.filter.and(Some(&accepts)), ..*query };
            let hit = match count.counters() {
                Some(counters) => {
                    uncounted_ray(counters, |c| accelerator.closest_hit_counted(&local, query, c))
                }
                None => accelerator.closest_hit(&local, query),
            };
            if let Some(hit) = hit {
                if nearest.is_none_or(|best| hit.t < best.t || (hit.t == best.t && index < best.instance)) {
                    nearest = Some(Hit { instance: index, ..hit });
                }
                if query.early_out {
                    t_max = hit.t;
                }
            }
            ControlFlow::Continue(t_max)
        });
        nearest
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        if is_invalid_ray(ray) {
            return false;
        }
        let mut found = false;
        self.visit(ray, count, |index, count| {
            let Placed { accelerator, mask, .. } = &self.placed[index as usize];
            if mask & ray.mask == 0 {
                return ControlFlow::Continue(ray.t_max);
            }
            let local = self.local_ray(index, ray, ray.t_max);
            let accepts = |hit: &Hit| query.accepts(&Hit { instance: index, ..*hit });
            let query = &Query { filter: query.filter.and(Some(&accepts)), ..*query };
            found = match count.counters() {
                Some(counters) => uncounted_ray(counters, |c| accelerator.any_hit_counted(&local, query, c)),
                None => accelerator.any_hit(&local, query),
            };
            if found { ControlFlow::Break(()) } else { ControlFlow::Continue(ray.t_max) }
        });
        found
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Structures that instances share are counted once.
    fn memory_bytes(&self) -> usize {
        let mut shared: Vec<_> = self.placed.iter().map(|placed| &placed.accelerator).collect();
        shared.sort_by_key(|accelerator| Arc::as_ptr(accelerator).cast::<()>());
        shared.dedup_by_key(|accelerator| Arc::as_ptr(accelerator).cast::<()>());
        let top = match &self.top {
            Top::List => 0,
            Top::Bvh { tree, order, .. } => tree.memory_bytes() + size_of_val(order.as_slice()),
        };
        let below: usize = shared.iter().map(|accelerator| accelerator.memory_bytes()).sum();
        below + top + size_of_val(self.placed.as_slice())
    }

    /// Statistics of the top level.
    fn shape(&self) -> TreeShape {
        match &self.top {
            Top::List => TreeShape::default(),
            Top::Bvh { tree, .. } => tree.shape(),
        }
    }
}

/// Lets the structure below count, without counting the ray again.
pub(crate) fn uncounted_ray<R>(
    counters: &mut crate::Counters,
    ask: impl FnOnce(&mut crate::Counters) -> R,
) -> R {
    let rays = counters.rays;
    let answer = ask(counters);
    counters.rays = rays;
    answer
}

impl Placed {
    fn new(instance: &Instance, shutter: [f32; 2]) -> Placed {
        let Instance { accelerator, motion, mask } = instance;
        let place = if motion.is_still_over(shutter) {
            let transform = motion.at(shutter[0]);
            if transform.is_identity() {
                InstancePlacement::Identity
            } else {
                InstancePlacement::Still(IntoLocal::new(&transform))
            }
        } else {
            InstancePlacement::Moving(motion.clone())
        };
        Placed { accelerator: accelerator.clone(), place, mask: *mask }
    }
}

/// The transform from the world into an instance's space.
#[derive(Clone, Copy)]
struct IntoLocal {
    linear: DMat3,
    translation: DVec3,
}

impl IntoLocal {
    fn new(transform: &Transform) -> IntoLocal {
        let inverse = transform.matrix().as_dmat4().inverse();
        IntoLocal { linear: DMat3::from_mat4(inverse), translation: inverse.w_axis.truncate() }
    }

    #[inline]
    fn apply(&self, ray: &Ray) -> ([f32; 3], [f32; 3]) {
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let origin = self.linear * wide(ray.origin) + self.translation;
        let direction = self.linear * wide(ray.direction);
        (origin.as_vec3().to_array(), direction.as_vec3().to_array())
    }
}

/// The quantities on which the pad of the top level depends.
struct PadBounds {
    /// Bounds of all boxes and of the images of the instances' own origins.
    hull: Aabb,
    /// The maximum κ of all transforms.
    condition: f64,
    /// The maximum ‖M‖.
    growth: f64,
}

impl PadBounds {
    fn of(instances: &[Instance], boxes: &[Aabb], shutter: [f32; 2]) -> PadBounds {
        let origin = Aabb::of_points([Vec3::ZERO]);
        let mut reach = PadBounds { hull: Aabb::EMPTY, condition: 1.0, growth: 1.0 };
        for (instance, bounds) in instances.iter().zip(boxes) {
            let [grow, shrink] = instance.motion.stretch_over(shutter);
            // In the maximum norm, each is at most √3 times its value in the Euclidean norm.
            reach.condition = reach.condition.max(3.0 * grow * shrink);
            reach.growth = reach.growth.max(2.0 * grow);
            reach.hull = reach.hull.union(*bounds).union(instance.motion.bounds_over(&origin, shutter));
        }
        reach
    }

    fn pad(&self, ray: &Ray) -> f32 {
        let (low, high) = (self.hull.min.to_array(), self.hull.max.to_array());
        let far = (0..3).fold(0f64, |far, axis| {
            let o = f64::from(ray.origin[axis]);
            far.max((f64::from(low[axis]) - o).abs()).max((f64::from(high[axis]) - o).abs())
        });
        // For directions so short that their digits may be lost in an instance's space, all instances are queried.
        let length = ray.direction.iter().fold(0f32, |length, d| length.max(d.abs()));
        if f64::from(length) < self.growth * TOO_SHORT {
            return f32::INFINITY;
        }
        let pad = far * self.condition * PAD + self.growth * f64::from(f32::MIN_POSITIVE);
        pad as f32
    }
}

/// 32 units of f32 rounding.
const PAD: f64 = 32.0 / 16_777_216.0;

/// 2⁻¹⁰⁰, times the growth of lengths: from there on a direction keeps all its 24 digits in an instance's space.
const TOO_SHORT: f64 = 1.0 / (1u128 << 100) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Culling, TriangleMesh};
    use bilux_math::glam::{DMat4, DVec4, Quat};
    use bilux_math::{MotionKey, hash};

    fn number(seed: u64, i: u64) -> f32 {
        hash::unit_f32(hash::hash_words([seed, i]) as u32) * 2.0 - 1.0
    }

    fn triangle() -> Arc<dyn Accelerator> {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Arc::new(crate::Bvh::new(&TriangleMesh::from_corners(vec![corners]).unwrap()))
    }

    fn scaled(x: f64, y: f64, z: f64, at: DVec3) -> Motion {
        let columns = [DVec4::X * x, DVec4::Y * y, DVec4::Z * z, at.extend(1.0)];
        Motion::still(
            Transform::from_matrix(DMat4::from_cols_array_2d(&columns.map(|c| c.to_array()))).unwrap(),
        )
    }

    fn two_levels(motions: Vec<Motion>) -> [TwoLevel; 2] {
        let shape = triangle();
        let instances: Vec<Instance> =
            motions.into_iter().map(|motion| Instance::new(Arc::clone(&shape), motion)).collect();
        [TopLevel::List, TopLevel::Bvh].map(|top| TwoLevel::new(&instances, [0.0, 1.0], top))
    }

    #[test]
    fn distance_keeps_its_unit_and_ties_go_to_the_lowest_instance() {
        let motions = vec![scaled(4.0, 2.0, 8.0, DVec3::ZERO), scaled(2.0, 2.0, 1.0, DVec3::ZERO)];
        for world in two_levels(motions) {
            let hit =
                world.closest_hit(&Ray::new([0.5, 0.25, 6.0], [0.0, 0.0, -2.0]), &Query::default()).unwrap();
            assert_eq!((hit.t, hit.instance, hit.primitive), (3.0, 0, 0));
        }
    }

    #[test]
    fn an_excluded_primitive_is_excluded_in_its_own_instance_only() {
        let motions = vec![scaled(1.0, 1.0, 1.0, DVec3::ZERO); 2];
        for world in two_levels(motions) {
            let exclude = Primitive { instance: 0, index: 0 };
            let ray = Ray { exclude, ..Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]) };
            assert_eq!(world.closest_hit(&ray, &Query::default()).unwrap().instance, 1);
        }
    }

    #[test]
    fn a_mirrored_instance_keeps_its_own_front() {
        let query = Query { culling: Culling::Back, ..Query::default() };
        // Mirrored in z, the side that faced +z faces −z.
        for world in two_levels(vec![scaled(1.0, 1.0, -1.0, DVec3::ZERO)]) {
            assert!(!world.any_hit(&Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]), &query));
            assert!(world.any_hit(&Ray::new([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]), &query));
        }
    }

    #[test]
    fn a_moving_instance_is_where_it_is_at_the_rays_time() {
        let key = |time_seconds: f32, x: f32| MotionKey {
            time_seconds,
            translation: Vec3::new(x, 0.0, 0.0),
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        let motion = Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 10.0)]).unwrap();
        for world in two_levels(vec![motion]) {
            for time in [0.0f32, 0.3, 0.5, 1.0, 7.0] {
                let x = 10.0 * time.min(1.0) + 0.25;
                let ray = Ray { time, ..Ray::new([x, 0.25, 1.0], [0.0, 0.0, -1.0]) };
                assert!(world.any_hit(&ray, &Query::default()), "{time}");
                let later = Ray { time: time + 0.2, ..ray };
                assert_eq!(world.any_hit(&later, &Query::default()), time >= 1.0, "{time}");
            }
        }
    }

    #[test]
    fn both_top_levels_give_the_same_hits() {
        let motions = (0..60u64)
            .map(|seed| {
                let columns = std::array::from_fn(|c| {
                    std::array::from_fn(|r| {
                        f64::from(number(seed, (c * 4 + r) as u64)) * if c == 3 { 5.0 } else { 2.0 }
                    })
                });
                let mut matrix = DMat4::from_cols_array_2d(&columns);
                for column in 0..4 {
                    matrix.col_mut(column).w = f64::from(u8::from(column == 3));
                }
                Motion::still(Transform::from_matrix(matrix).unwrap_or_default())
            })
            .collect();
        let [list, tree] = two_levels(motions);
        let mut hits = 0;
        for seed in 0..20_000 {
            let v = |i: u64| std::array::from_fn(|k| number(seed + 1000, i + k as u64));
            let ray = Ray::new(v(0).map(|x: f32| x * 8.0), v(3));
            let (a, b) =
                (list.closest_hit(&ray, &Query::default()), tree.closest_hit(&ray, &Query::default()));
            assert_eq!(a, b);
            assert_eq!(a.is_some(), list.any_hit(&ray, &Query::default()));
            assert_eq!(a.is_some(), tree.any_hit(&ray, &Query::default()));
            hits += usize::from(a.is_some());
        }
        assert!(hits > 1000, "{hits}");
    }
}

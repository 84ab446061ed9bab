//! Sheets made of two one-sided shells, back to back, so that they are visible from both sides.
//!
//! Where the shells cross or coincide, the shell whose back the camera sees through lies in front of the visible one,
//! and would cast a shadow on it. No light enters between two shells that are so close: for a segment that ends on one
//! shell, the other does not exist. Both ends of a segment are treated alike, so that it is free or blocked whichever
//! end it is traced from. See docs/adr/0023-shells.md.

use super::parts::SceneParts;
use crate::geometry::placed::Placed;
use crate::surface::Surface;
use bilux_accel::{Accelerator, Hit, Primitive, Query, Ray};
use bilux_math::parallel::any;
use bilux_math::{Aabb, Vec3};

/// The maximum distance of a sheet's shells, relative to the extent of the object whose back is seen through,
const PART_OF_OBJECT: f32 = 1.0 / 1024.0;
/// and relative to the triangle that the ray hits: a canopy in a large scene is no shell of the ground below.
const PART_OF_TRIANGLE: f32 = 0.25;
/// Minimum cosine of the angle between the shells.
const PARALLEL: f32 = 0.7;
/// Maximum number of consecutive backs that a ray looks behind; beyond that the first one counts.
const MAX_BACKS: usize = 8;
/// Maximum number of triangles of an object that are tested for a nearby shell.
const MAX_PROBES: usize = 2048;
/// And of all objects together, but at least one of each.
const MAX_PROBES_OF_ALL: usize = 1 << 20;
/// Rays that look for a coincident shell start in front of it by this fraction of the maximum gap.
const BEHIND: f32 = 1.0 / 16.0;

/// The end of a ray on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) p: Vec3,
    /// Unit normal of the surface there: of its front if it is one-sided, otherwise towards the other end.
    pub(super) n: Vec3,
}

/// The maximum gap between the shells of a sheet.
#[derive(Clone)]
pub(super) struct Sheets {
    /// For each object whose back may be seen through; not used for spheres.
    gaps: Vec<f32>,
}

/// A back face that light passes if the other shell is behind it.
struct Back {
    p: Vec3,
    front: Vec3,
    gap: f32,
}

impl Back {
    /// True when a surface at `p`, with a normal in this direction, is its other shell.
    fn is_shell_of(&self, p: Vec3, n: Vec3) -> bool {
        let along = self.front.dot(p - self.p).abs();
        along <= self.gap * self.front.length() && self.front.dot(n) <= -PARALLEL * self.front.length()
    }
}

impl Sheets {
    /// The gaps of a scene; `None` if there are no sheets, so that such scenes cost nothing.
    pub(super) fn find(parts: &SceneParts, accelerator: &dyn Accelerator, time: f32) -> Option<Sheets> {
        if !parts.hides_backs {
            return None;
        }
        let bounds = |o: &Placed| o.motion.at(time).bounds(&o.mesh.bounds());
        let extent = |b: Aabb| if b.is_empty() { 0.0 } else { (b.max - b.min).length() };
        let objects = parts.geometry.objects();
        let sheets = Sheets { gaps: objects.iter().map(|o| PART_OF_OBJECT * extent(bounds(o))).collect() };
        let is_one_sided = |o: u32| parts.is_one_sided_object(o);
        let one_sided: Vec<u32> = (0..objects.len() as u32).filter(|&object| is_one_sided(object)).collect();
        let probes = (MAX_PROBES_OF_ALL / one_sided.len().max(1)).clamp(1, MAX_PROBES);
        let has_shell = |object: &u32| sheets.has_shell(parts, accelerator, *object, probes, time);
        any(&one_sided, has_shell).then_some(sheets)
    }

    /// True when some triangle of an object, of which `probes` are tested, faces the other shell of a sheet.
    fn has_shell(
        &self,
        parts: &SceneParts,
        accelerator: &dyn Accelerator,
        object: u32,
        probes: usize,
        time: f32,
    ) -> bool {
        let first = parts.geometry.first_primitive(object);
        let count = parts.geometry.objects()[object as usize].mesh.triangles.len();
        let step = count.div_ceil(probes).max(1);
        let mut triangles = (0..count as u32).step_by(step);
        first != Primitive::NONE
            && triangles.any(|i| {
                let primitive = Primitive { index: first.index + i, ..first };
                self.faces_shell(parts, accelerator, primitive, object, time)
            })
    }

    fn faces_shell(
        &self,
        parts: &SceneParts,
        accelerator: &dyn Accelerator,
        primitive: Primitive,
        object: u32,
        time: f32,
    ) -> bool {
        let (_, [a, b, c], _) = parts.geometry.in_world(primitive, time);
        let Some(front) = parts.geometry.front(primitive, time) else { return false };
        let (gap, p) = (self.gap(object, front), (a + b + c) / 3.0);
        let Some(n) = front.try_normalize().filter(|n| n.is_finite() && p.is_finite() && gap > 0.0) else {
            return false;
        };
        let from = |origin: Vec3, direction: Vec3| Ray {
            exclude: primitive,
            time,
            ..Ray::new(origin.to_array(), direction.to_array())
        };
        let forwards = Ray { t_max: gap * (1.0 + BEHIND), ..from(p - n * (gap * BEHIND), n) };
        let is_shell = |hit: &Hit| {
            let other = parts.normal_towards(&parts.geometry.surface(&forwards, hit), -n);
            other.dot(n) <= -PARALLEL
        };
        if !accelerator.any_hit(&forwards, &Query { filter: Some(&is_shell), ..Query::default() }) {
            return false;
        }
        // Behind the wall of a solid is its inside: a solid that stands on a floor is no sheet.
        let backwards = Ray { t_min: gap, ..from(p, -n) };
        let behind = accelerator.closest_hit(&backwards, &Query::default());
        behind.is_none_or(|hit| parts.is_back(&backwards, &hit).is_none())
    }

    /// The maximum gap behind a triangle's back; the length of its normal `front` is twice its area.
    fn gap(&self, object: u32, front: Vec3) -> f32 {
        let part = self.gaps.get(object as usize).copied().unwrap_or(0.0);
        part.min(PART_OF_TRIANGLE * front.length().sqrt())
    }
}

impl SceneParts {
    fn is_one_sided_object(&self, object: u32) -> bool {
        self.passes[object as usize].is_one_sided
    }

    /// Along the front normal of a one-sided triangle, if the ray hits its back.
    fn is_back(&self, ray: &Ray, hit: &Hit) -> Option<Vec3> {
        let object = self.geometry.object_of(hit);
        if !self.is_one_sided_object(object) {
            return None;
        }
        let front = self.geometry.front_of(object, hit.primitive(), ray.time)?;
        (front.dot(ray.direction.into()) > 0.0).then_some(front)
    }

    /// The unit normal of the front of a one-sided surface, otherwise the one on the side of a direction.
    pub(super) fn normal_towards(&self, surface: &Surface, direction: Vec3) -> Vec3 {
        let front = || self.geometry.front(surface.primitive, surface.time)?.try_normalize();
        if self.is_one_sided_object(surface.object)
            && let Some(front) = front()
        {
            return front;
        }
        if surface.n_geom.dot(direction) < 0.0 { -surface.n_geom } else { surface.n_geom }
    }

    /// True when a ray that hits a one-sided surface, `front` along its normal, starts or ends on the other shell of
    /// it.
    pub(super) fn is_between_shells(
        &self,
        sheets: &Sheets,
        ray: &Ray,
        hit: &Hit,
        object: u32,
        front: Vec3,
        end: Option<End>,
    ) -> bool {
        let direction = Vec3::from(ray.direction);
        let along = front.dot(direction);
        let enters = along < 0.0;
        if end.is_none() && !enters {
            return false;
        }
        let gap = sheets.gap(object, front);
        let near = enters && hit.t * -along <= gap * front.length();
        let back = |p| Back { p, front, gap };
        if near {
            let Some(begins) = self.geometry.front(ray.exclude, ray.time).and_then(Vec3::try_normalize)
            else {
                return false;
            };
            let one_sided = ray.exclude != Primitive::NONE
                && self.is_one_sided_object(self.geometry.object_of_primitive(ray.exclude));
            let turned = !one_sided && begins.dot(direction) < 0.0;
            let (origin, n) = (Vec3::from(ray.origin), if turned { -begins } else { begins });
            return n.dot(direction) > 0.0 && back(origin + direction * hit.t).is_shell_of(origin, n);
        }
        let Some(end) = end.filter(|end| along > 0.0 && end.n.dot(direction) < 0.0) else { return false };
        back(Vec3::from(ray.origin) + direction * hit.t).is_shell_of(end.p, end.n)
    }

    /// True unless a ray is certainly not [between shells](SceneParts::is_between_shells) wherever it hits a one-sided
    /// surface: at neither end is there a surface parallel to it. `n` is the normal at the ray's end, or zero.
    pub(super) fn may_be_between_shells(&self, ray: &Ray, front: Vec3, n: Vec3) -> bool {
        let faces = |n: Vec3| front.dot(n) <= -PARALLEL * front.length();
        if front.dot(ray.direction.into()) > 0.0 {
            return n != Vec3::ZERO && faces(n);
        }
        let begins = self.geometry.front(ray.exclude, ray.time).and_then(Vec3::try_normalize);
        begins.is_some_and(|n| faces(n) || faces(-n))
    }

    /// The hit on the other shell behind the backs of sheets; `None` if `hit` is on no such back. `next` finds the closest hit
    /// of a ray.
    pub(super) fn behind(
        &self,
        sheets: &Sheets,
        ray: &Ray,
        mut hit: Hit,
        mut next: impl FnMut(&Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        let direction = Vec3::from(ray.direction);
        let at = |hit: &Hit| Vec3::from(ray.origin) + direction * hit.t;
        let (mut backs, mut t_max) = (Vec::new(), ray.t_max);
        while let Some(front) = self.is_back(ray, &hit) {
            let gap = sheets.gap(self.geometry.object_of(&hit), front);
            t_max = t_max.min(hit.t + gap * front.length() / front.dot(direction));
            backs.push(Back { p: at(&hit), front, gap });
            if backs.len() > MAX_BACKS {
                return None;
            }
            hit = next(&Ray { t_min: hit.t, t_max, exclude: hit.primitive(), ..*ray })?;
        }
        if backs.is_empty() {
            return None;
        }
        let surface = self.geometry.surface(ray, &hit);
        let n = self.normal_towards(&surface, -direction);
        backs.iter().all(|back| back.is_shell_of(surface.p, n)).then_some(hit)
    }
}

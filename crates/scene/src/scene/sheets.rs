//! Sheets that are made of two one-sided shells, back to back, so that they are seen from both sides.
//!
//! Where the shells cross or coincide, the one whose back the camera looks through lies before the one that it sees, and
//! would shade it. No light comes between two shells that are so close: for what ends on the one, the other is not there. Both ends of a
//! segment count alike, so that it is free or blocked whichever end it is traced from. See docs/adr/0023-shells.md.

use super::{Scene, SceneParts};
use crate::lights::Sides;
use crate::surface::Surface;
use bilux_accel::{Accelerator, Hit, Primitive, Query, Ray};
use bilux_math::{Aabb, Vec3};

/// The shells of a sheet are no farther apart than this part of the extent of the object whose back is looked through,
const PART_OF_OBJECT: f32 = 1.0 / 1024.0;
/// nor than this part of the triangle that is met: a canopy of a large scene is no shell of the ground below.
const PART_OF_TRIANGLE: f32 = 0.25;
/// Cosine of the angle between the shells, at least.
const PARALLEL: f32 = 0.7;
/// Backs in a row that a ray looks behind; beyond that the first counts.
const MAX_BACKS: usize = 8;
/// Triangles of an object that are tried for a shell close by.
const MAX_PROBES: usize = 2048;
/// Rays that look for a shell in the same place begin this part of the greatest gap before it.
const BEHIND: f32 = 1.0 / 16.0;

/// The end of a ray on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) p: Vec3,
    /// Normal of the surface there, unit, of its front where it is seen from there alone, else towards the other end.
    pub(super) n: Vec3,
}

/// How far apart the shells of a sheet may be.
#[derive(Clone)]
pub(super) struct Sheets {
    /// By the object whose back is looked through; those of spheres are not asked for.
    gaps: Vec<f32>,
}

/// A back that light passes where the other shell is behind it.
struct Back {
    p: Vec3,
    front: Vec3,
    gap: f32,
}

impl Back {
    /// True when a surface at `p`, with a normal that looks this way, is the other shell of it.
    fn is_shell_of(&self, p: Vec3, n: Vec3) -> bool {
        let along = self.front.dot(p - self.p).abs();
        along <= self.gap * self.front.length() && self.front.dot(n) <= -PARALLEL * self.front.length()
    }
}

impl Sheets {
    /// The gaps of a scene; `None` where no sheet is found, so that nobody pays for it.
    pub(super) fn find(parts: &SceneParts, accelerator: &dyn Accelerator, time: f32) -> Option<Sheets> {
        if !parts.hides_backs {
            return None;
        }
        let bounds = |o: &crate::geometry::Placed| o.motion.at(time).bounds(&o.mesh.bounds());
        let extent = |b: Aabb| if b.is_empty() { 0.0 } else { (b.max - b.min).length() };
        let objects = parts.geometry.objects();
        let sheets = Sheets { gaps: objects.iter().map(|o| PART_OF_OBJECT * extent(bounds(o))).collect() };
        let is_one_sided = |o: u32| parts.is_one_sided_object(o);
        let mut one_sided = (0..objects.len() as u32).filter(|&object| is_one_sided(object));
        one_sided.any(|object| sheets.has_shell(parts, accelerator, object, time)).then_some(sheets)
    }

    /// True when some triangle of an object faces another shell of a sheet.
    fn has_shell(&self, parts: &SceneParts, accelerator: &dyn Accelerator, object: u32, time: f32) -> bool {
        let first = parts.geometry.first_primitive(object);
        let count = parts.geometry.objects()[object as usize].mesh.triangles.len();
        let step = count.div_ceil(MAX_PROBES).max(1);
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
        // Behind the wall of a solid is its inside: what stands on a floor is no sheet.
        let backwards = Ray { t_min: gap, ..from(p, -n) };
        let behind = accelerator.closest_hit(&backwards, &Query::default());
        behind.is_none_or(|hit| parts.is_back(&backwards, &hit).is_none())
    }

    /// The greatest gap behind the back of a triangle, `front` along its normal and twice as long as its area.
    fn gap(&self, object: u32, front: Vec3) -> f32 {
        let part = self.gaps.get(object as usize).copied().unwrap_or(0.0);
        part.min(PART_OF_TRIANGLE * front.length().sqrt())
    }
}

impl SceneParts {
    fn is_one_sided_object(&self, object: u32) -> bool {
        self.materials[self.geometry.material_of(object) as usize].visible_sides() == Sides::Front
    }

    /// Along the normal of a triangle's front, where a ray meets the back of what is seen from its front alone.
    fn is_back(&self, ray: &Ray, hit: &Hit) -> Option<Vec3> {
        let object = self.geometry.object_of(hit);
        let front =
            self.geometry.front(hit.primitive(), ray.time).filter(|_| self.is_one_sided_object(object))?;
        (front.dot(ray.direction.into()) > 0.0).then_some(front)
    }

    /// The normal of a surface's front where it is seen from there alone, else the one on the side of a direction; unit.
    pub(super) fn normal_towards(&self, surface: &Surface, direction: Vec3) -> Vec3 {
        let front = || self.geometry.front(surface.primitive, surface.time)?.try_normalize();
        if self.is_one_sided_object(surface.object)
            && let Some(front) = front()
        {
            return front;
        }
        if surface.n_geom.dot(direction) < 0.0 { -surface.n_geom } else { surface.n_geom }
    }

    /// True when a ray that is met by a one-sided surface, `front` along its normal, begins or ends on the other shell of it.
    pub(super) fn is_between_shells(
        &self,
        sheets: &Sheets,
        ray: &Ray,
        hit: &Hit,
        front: Vec3,
        end: Option<End>,
    ) -> bool {
        let direction = Vec3::from(ray.direction);
        let gap = sheets.gap(self.geometry.object_of(hit), front);
        let along = front.dot(direction);
        let near = along < 0.0 && hit.t * -along <= gap * front.length();
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
}

impl Scene {
    /// The end of segments on a surface that come from a direction, for [`super::Tracer::ending_on`].
    pub fn normal_towards(&self, surface: &Surface, direction: Vec3) -> Vec3 {
        self.parts.normal_towards(surface, direction)
    }

    /// What a ray meets behind the backs of sheets: their other shell, where `hit` is the back of one; else `hit`. `next` asks
    /// for what comes first.
    #[inline]
    pub(super) fn behind_shells(&self, ray: &Ray, hit: Hit, next: impl FnMut(&Ray) -> Option<Hit>) -> Hit {
        match &self.sheets {
            Some(sheets) => self.behind(sheets, ray, hit, next).unwrap_or(hit),
            None => hit,
        }
    }

    fn behind(
        &self,
        sheets: &Sheets,
        ray: &Ray,
        mut hit: Hit,
        mut next: impl FnMut(&Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        let (parts, direction) = (&*self.parts, Vec3::from(ray.direction));
        let at = |hit: &Hit| Vec3::from(ray.origin) + direction * hit.t;
        let (mut backs, mut t_max) = (Vec::new(), ray.t_max);
        while let Some(front) = parts.is_back(ray, &hit) {
            let gap = sheets.gap(parts.geometry.object_of(&hit), front);
            t_max = t_max.min(hit.t + gap * front.length() / front.dot(direction));
            backs.push(Back { p: at(&hit), front, gap });
            if backs.len() > MAX_BACKS {
                return None;
            }
            hit = next(&Ray { t_min: hit.t, t_max, exclude: hit.primitive(), ..*ray })?;
        }
        let surface = parts.geometry.surface(ray, &hit);
        let n = parts.normal_towards(&surface, -direction);
        backs.iter().all(|back| back.is_shell_of(surface.p, n)).then_some(hit)
    }
}

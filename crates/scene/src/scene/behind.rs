//! Media behind boundaries, and the boundaries behind which a point is.

use super::open_boundaries::{Behind, OpenBoundary};
use super::parts::SceneParts;
use super::{Scene, Tracer};
use crate::materials::Nested;
use bilux_accel::{Accelerator, Hit, Query, Ray};
use bilux_math::Vec3;

impl Scene {
    /// The medium of an object that takes part in nesting, by its priority or since it touches another.
    #[inline]
    pub fn nested(&self, object: u32) -> Option<Nested> {
        if self.nesting(object) > 0 { self.material_of(object).in_contact() } else { None }
    }

    /// The object that stands for the body which the surface of an object bounds: itself, but for open sheets of one material.
    #[inline]
    pub fn body(&self, object: u32) -> u32 {
        self.parts.open_boundaries.body(object)
    }

    /// Whether the body that an object stands for has an [open boundary](Tracer::behind_open_boundaries).
    pub fn is_open(&self, body: u32) -> bool {
        self.parts.open_boundaries.is_open(body)
    }

    /// True when the boundary of some medium is open.
    #[inline]
    pub fn has_open_boundaries(&self) -> bool {
        !self.parts.open_boundaries.is_empty()
    }
}

impl Tracer<'_> {
    /// The objects that stand for the bodies with an open boundary behind which a point is, at a time in seconds.
    pub fn behind_open_boundaries(&mut self, p: Vec3, time: f32) -> &[u32] {
        let parts = &self.scene.parts;
        let at = [p.x, p.y, p.z, time].map(f32::to_bits);
        if !parts.open_boundaries.is_empty() && self.behind.at != Some(at) {
            let is_behind = |open: &&OpenBoundary| {
                let is_nested = self.scene.nesting(open.object) > 0;
                open.is_before(parts, &*self.scene.accelerator, &self.scene.query, (p, time), is_nested)
            };
            let objects =
                parts.open_boundaries.open.iter().filter(is_behind).map(|open| open.object).collect();
            self.behind = Behind { at: Some(at), objects };
        }
        &self.behind.objects
    }
}

impl OpenBoundary {
    /// Whether most of the points that a point sees, past boundaries of other media, show it their backs. What stands in between does not
    /// count where it hides all of them, if `is_certain` says that what this bounds is more than a pane.
    fn is_before(
        &self,
        parts: &SceneParts,
        accelerator: &dyn Accelerator,
        query: &Query,
        (p, time): (Vec3, f32),
        is_certain: bool,
    ) -> bool {
        let object_of = |hit: &Hit| parts.geometry.object_of(hit);
        let is_mine = |hit: &Hit| parts.open_boundaries.body(object_of(hit)) == self.object;
        let is_boundary = |hit: &Hit| parts.bounds_medium.get(object_of(hit) as usize) == Some(&true);
        let (mut seen, mut hidden) = (0, 0);
        for &(object, point) in &self.points {
            let target = parts.geometry.objects()[object as usize].motion.at(time).point(point);
            let ray = Ray::new(p.to_array(), (target - p).to_array());
            let ray = Ray { t_max: 1.0 + 1e-3, time, ..ray };
            let vote = |counts: &(dyn Fn(&Hit) -> bool + Sync)| {
                let stops = |hit: &Hit| counts(hit) && parts.stops(&ray, hit, None, None);
                let hit = accelerator.closest_hit(&ray, &Query { filter: Some(&stops), ..*query })?;
                let along = parts.geometry.surface(&ray, &hit).n_geom.dot(ray.direction.into());
                is_mine(&hit).then_some(if along > 0.0 { 1 } else { -1 })
            };
            match vote(&|hit| is_mine(hit) || !is_boundary(hit)) {
                Some(side) => seen += side,
                None => hidden += vote(&is_mine).unwrap_or(0),
            }
        }
        if seen == 0 && is_certain { hidden > 0 } else { seen > 0 }
    }
}

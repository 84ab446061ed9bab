//! The media that a path starts in.

use super::Media;
use super::coincident::Coincident;
use super::nested::{NONE, Overlap};
use super::passage::behind;
use bilux_math::Vec3;
use bilux_scene::{Ray, Surface, Tracer};
use std::collections::HashSet;

impl Media {
    /// The media that a path starts in: those that it would leave without having entered them.
    ///
    /// The ray passes everything but boundaries of media, however many there are. Those that are [open](Tracer::behind_open_boundaries) are
    /// asked from where it begins, since it may miss them.
    pub(crate) fn at_start(tracer: &mut Tracer, ray: &Ray) -> Media {
        let (mut media, scene) = (Media::AIR, tracer.scene);
        if scene.has_open_boundaries() {
            for &object in tracer.behind_open_boundaries(Vec3::from(ray.origin), ray.time) {
                match scene.nested(object) {
                    Some(_) => media.overlap.add(object),
                    None => media.inside = object,
                }
            }
        }
        media.with_closed(tracer, ray, |body| !scene.is_open(body))
    }

    /// The media that a path from infinity starts in, where nothing fills the space behind an open boundary.
    pub(crate) fn from_infinity(tracer: &mut Tracer, ray: &Ray) -> Media {
        Media::AIR.with_closed(tracer, ray, |_| true)
    }

    /// These media and, of those that `asks` names by the objects that stand for them, the ones that a path along a ray would leave.
    fn with_closed(mut self, tracer: &mut Tracer, ray: &Ray, asks: impl Fn(u32) -> bool) -> Media {
        let (media, scene) = (&mut self, tracer.scene);
        let t_max = match scene.absorption_distance(ray) {
            _ if scene.has_nested() => ray.t_max,
            Some(t) => t.min(ray.t_max),
            // Outside the bounds of everything that absorbs there is no medium.
            None => return self,
        };
        let (mut ray, mut met, mut innermost) = (Ray { t_max, ..*ray }, Met::default(), None);
        while let Some(closest) = tracer.closest_boundary(&ray) {
            let coincident = Coincident::with(tracer, &ray, &closest);
            for surface in std::iter::once(&closest).chain(&coincident.others) {
                let body = scene.body(surface.object);
                let is_first = met.is_first(body) && asks(body);
                if surface.n_geom.dot(Vec3::from(ray.direction)) <= 0.0 || !is_first {
                    continue;
                }
                let material = scene.material(surface);
                if scene.nested(body).is_some() {
                    media.overlap.add(body);
                } else if material.medium().is_some() && media.overlap == Overlap::NOTHING {
                    // What the ray leaves first is innermost. One without a priority replaces what surrounds it.
                    let inside = *innermost.get_or_insert(surface.object);
                    if !scene.has_nested() {
                        return Media { inside, ..self };
                    }
                }
            }
            ray = behind(&ray, &Surface { t: coincident.t, ..closest });
        }
        media.inside = match (innermost, media.overlap.strongest_object(scene)) {
            (Some(innermost), _) => innermost,
            (None, NONE) => media.inside,
            (None, strongest) => strongest,
        };
        self
    }
}

/// Number of objects that are remembered without memory of their own.
const FEW: usize = 16;

/// Objects that a ray has met.
struct Met {
    few: [u32; FEW],
    count: usize,
    more: HashSet<u32>,
}

impl Default for Met {
    fn default() -> Met {
        Met { few: [NONE; FEW], count: 0, more: HashSet::new() }
    }
}

impl Met {
    /// Whether the ray meets an object for the first time.
    fn is_first(&mut self, object: u32) -> bool {
        let is_known = self.few[..self.count].contains(&object) || self.more.contains(&object);
        if !is_known {
            match self.few.get_mut(self.count) {
                Some(place) => (*place, self.count) = (object, self.count + 1),
                None => _ = self.more.insert(object),
            }
        }
        !is_known
    }
}

//! Ray queries: what rays hit, and what they pass.

use super::open_boundaries::Behind;
use super::sheets::{End, Sheets};
use super::{MayPass, Scene, SceneParts};
use crate::bsdf::OpaqueBaseInputs;
use crate::mesh::sides::Sides;
use crate::surface::Surface;
use bilux_accel::{Accelerator, Counters, Hit, Primitive, Query, Ray};
use bilux_math::Vec3;
use bilux_math::hash::{hash_words, unit_f32};

/// The mask of rays from the camera, which pass back faces that it does not see.
const FROM_CAMERA: u32 = u32::MAX >> 1;

/// The mask of rays that end at the camera.
const TO_CAMERA: u32 = u32::MAX >> 2;

/// The mask of rays for labels: from the camera, and stopped by surfaces of at least this opacity.
const FOR_LABELS: u32 = u32::MAX >> 3;
const LABELLED_OPACITY: f32 = 0.5;

impl Scene {
    /// A ray from the camera: it passes the backs of one-sided surfaces.
    #[inline]
    pub fn from_camera(&self, ray: Ray) -> Ray {
        if self.parts.hides_backs { Ray { mask: FROM_CAMERA, ..ray } } else { ray }
    }

    /// A ray that ends at the camera: it passes the same surfaces as one that starts there.
    #[inline]
    pub fn to_camera(&self, ray: Ray) -> Ray {
        if self.parts.hides_backs { Ray { mask: TO_CAMERA, ..ray } } else { ray }
    }

    /// A ray from the camera that an opacity mask stops where the opacity is at least one half: what it hits is the same for
    /// all rays through one point.
    #[inline]
    pub fn for_labels(&self, ray: Ray) -> Ray {
        let passes = self.parts.has_holes || self.parts.hides_backs;
        if passes { Ray { mask: FOR_LABELS, ..ray } } else { ray }
    }

    /// True when some rays pass surfaces that they hit.
    #[inline]
    fn may_pass_surfaces(&self) -> bool {
        self.parts.has_holes || self.parts.hides_backs || self.sheets.is_some()
    }

    /// Along the normal of a surface's front.
    fn front(&self, surface: &Surface) -> Vec3 {
        self.parts.geometry.front(surface.primitive, surface.time).unwrap_or(surface.n_geom)
    }

    /// True when a camera in the direction `towards` from a surface sees through it.
    #[inline]
    pub fn camera_sees_through(&self, surface: &Surface, towards: Vec3) -> bool {
        let is_back = || {
            self.material(surface).visible_sides() == Sides::Front && self.front(surface).dot(towards) <= 0.0
        };
        self.parts.hides_backs && (self.parts.passes[surface.object as usize].hides_from_camera || is_back())
    }
}

impl SceneParts {
    /// True when some surfaces may let this ray pass.
    #[inline]
    fn may_pass(&self, ray: &Ray) -> bool {
        self.has_holes || ray.mask != u32::MAX
    }

    /// True when the surface stops a ray that hits it.
    ///
    /// It does not where the camera sees through its back, nor where the ray starts or ends on the other shell of a
    /// sheet. With an opacity mask the decision is random per ray, by a hash of the ray and the hit, and of nothing
    /// else, except for labels.
    pub(super) fn stops(&self, ray: &Ray, hit: &Hit, sheets: Option<&Sheets>, end: Option<End>) -> bool {
        let object = self.geometry.object_of(hit);
        let MayPass { has_holes, is_one_sided, hides_from_camera } = self.passes[object as usize];
        if hides_from_camera && ray.mask != u32::MAX {
            return false;
        }
        if is_one_sided && (ray.mask != u32::MAX || sheets.is_some()) {
            let outwards = || self.geometry.surface(ray, hit).n_geom;
            let front = self.geometry.front_of(object, hit.primitive(), ray.time).unwrap_or_else(outwards);
            let along = front.dot(ray.direction.into());
            let towards_camera = if ray.mask == TO_CAMERA { along } else { -along };
            if ray.mask != u32::MAX && towards_camera <= 0.0 {
                return false;
            }
            if sheets.is_some_and(|sheets| self.is_between_shells(sheets, ray, hit, object, front, end)) {
                return false;
            }
        }
        if !has_holes {
            return true;
        }
        let opacity = self.geometry.opacity_at(hit, |material, uv| {
            self.materials[material as usize].opacity().map_or(1.0, |opacity| opacity.at(uv))
        });
        if ray.mask == FOR_LABELS {
            return opacity >= LABELLED_OPACITY;
        }
        let place = u64::from(hit.instance) << 32 | u64::from(hit.primitive);
        let number = hash_words([ray_hash(ray), place, u64::from(hit.t.to_bits())]) as u32;
        unit_f32(number) < opacity
    }
}

impl SceneParts {
    /// True if a surface stops a ray wherever the ray hits it, which [`SceneParts::stops`] then need not decide.
    ///
    /// `n` is the normal at the ray's end, or zero.
    fn surely_stops(&self, ray: &Ray, blocker: Primitive, sheets: &Option<Sheets>, n: Vec3) -> bool {
        let object = self.geometry.object_of_primitive(blocker);
        let MayPass { has_holes, is_one_sided, hides_from_camera } = self.passes[object as usize];
        if hides_from_camera && ray.mask != u32::MAX {
            return false;
        }
        if has_holes || !is_one_sided || (ray.mask == u32::MAX && sheets.is_none()) {
            return !has_holes;
        }
        let front = self.geometry.front_of(object, blocker, ray.time).filter(|_| ray.mask == u32::MAX);
        front.is_some_and(|front| !self.may_be_between_shells(ray, front, n))
    }
}

/// Traces rays on behalf of one thread, and counts.
pub struct Tracer<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// Costs of the rays; only `rays` unless counting is on.
    pub counters: Counters,
    counting: bool,
    /// The surface point on which the current rays end.
    end: Option<End>,
    /// Primitives that the rays of a batch hit.
    blockers: Vec<Option<Primitive>>,
    /// The open boundaries around the last point that asked for them.
    pub(super) behind: Behind,
}

impl<'s> Tracer<'s> {
    /// A tracer; with `counting`, every node and triangle test is counted.
    pub fn new(scene: &'s Scene, counting: bool) -> Tracer<'s> {
        let (counters, behind) = (Counters::default(), Behind::default());
        Tracer { scene, counters, counting, end: None, blockers: Vec::new(), behind }
    }

    /// Traces rays between the origin of `ray` and its point at parameter 1, which is on a surface with the normal `n`.
    ///
    /// `n` is from [`Scene::normal_towards`], or zero without a surface. Without this a ray may be blocked by the shell
    /// in front of the one that it ends on.
    #[inline]
    pub fn ending_on<T>(&mut self, ray: &Ray, n: Vec3, question: impl FnOnce(&mut Self) -> T) -> T {
        if self.scene.sheets.is_none() || n == Vec3::ZERO {
            return question(self);
        }
        self.end = Some(End { p: Vec3::from(ray.origin) + Vec3::from(ray.direction), n });
        let answer = question(self);
        self.end = None;
        answer
    }

    /// Traces a ray, past surfaces that let it through.
    #[inline(always)]
    fn ask<T>(&mut self, ray: &Ray, question: impl FnOnce(&mut Self, &Ray, &Query) -> T) -> T {
        let scene = self.scene;
        if !scene.parts.may_pass(ray) && scene.sheets.is_none() {
            return question(self, ray, &scene.query);
        }
        let (sheets, end) = (scene.sheets.as_ref(), self.end);
        let stops = |hit: &Hit| scene.parts.stops(ray, hit, sheets, end);
        question(self, ray, &Query { filter: Some(&stops), ..scene.query })
    }

    /// The closest hit of a ray.
    #[inline]
    pub fn closest(&mut self, ray: &Ray) -> Option<Surface> {
        let hit = self.hit(ray)?;
        Some(self.surface(ray, &hit))
    }

    /// The closest hit of a ray with the boundary of a medium, past everything else.
    pub fn closest_boundary(&mut self, ray: &Ray) -> Option<Surface> {
        let (scene, end) = (self.scene, self.end);
        let (parts, sheets) = (&scene.parts, scene.sheets.as_ref());
        let may_pass = parts.may_pass(ray) || sheets.is_some();
        let stops = |hit: &Hit| {
            let is_boundary = parts.bounds_medium.get(parts.geometry.object_of(hit) as usize) == Some(&true);
            is_boundary && (!may_pass || parts.stops(ray, hit, sheets, end))
        };
        let hit = self.closest_hit(ray, &Query { filter: Some(&stops), ..scene.query })?;
        Some(self.surface(ray, &hit))
    }

    /// The closest hit of a ray, as [`Tracer::surface`] takes it.
    #[inline]
    pub fn hit(&mut self, ray: &Ray) -> Option<Hit> {
        let hit = self.ask(ray, Tracer::closest_hit)?;
        Some(self.scene.behind_shells(ray, hit, |ray| self.ask(ray, Tracer::closest_hit)))
    }

    /// The closest hits of many rays: the hit of `rays[i]` goes to `hits[i]`.
    ///
    /// They are those of [`Tracer::hit`], bit for bit, and often found sooner than one by one.
    pub fn hits(&mut self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let Some(tree) = self.batch_tree(rays) else {
            rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.hit(ray));
            return;
        };
        self.counters.rays += rays.len() as u64;
        tree.closest_hits(rays, &self.scene.query, hits);
        if !self.scene.may_pass_surfaces() {
            return;
        }
        // The closest of all hits is the closest that stops the ray, unless the ray passes it.
        for (ray, hit) in rays.iter().zip(hits) {
            if let Some(closest) = *hit {
                *hit = if self.is_stopped(ray, &closest) {
                    Some(self.scene.behind_shells(ray, closest, |ray| self.ask(ray, Tracer::closest_hit)))
                } else {
                    // Asked again, and counted once.
                    self.counters.rays -= 1;
                    self.hit(ray)
                };
            }
        }
    }

    /// True when the surface at a hit stops the ray.
    fn is_stopped(&self, ray: &Ray, hit: &Hit) -> bool {
        let (parts, sheets) = (&self.scene.parts, self.scene.sheets.as_ref());
        if !parts.may_pass(ray) && sheets.is_none() {
            return true;
        }
        parts.stops(ray, hit, sheets, self.end)
    }

    /// The tree of the whole scene, if it can be asked in batches.
    fn batch_tree(&self, rays: &[Ray]) -> Option<&'s dyn Accelerator> {
        let scene = self.scene;
        let is_plain = !self.counting && scene.parts.geometry.spheres().is_empty();
        let tree = scene.alone.as_deref().filter(|_| is_plain)?;
        rays.iter().all(|ray| ray.mask != 0).then_some(tree)
    }

    /// All that stops a ray between its ends, nearest first, ties by lowest instance and then lowest primitive. It does not
    /// count as a ray.
    pub fn all_hits(&mut self, ray: &Ray) -> Vec<Hit> {
        self.ask(ray, |tracer, ray, query| tracer.scene.accelerator.all_hits(ray, query))
    }

    /// The surface at a hit of a ray.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let mut surface = self.smooth_surface(ray, hit);
        if surface.tangent != Vec3::ZERO {
            surface.n_shade = self.scene.material(&surface).n_shade(&surface);
        }
        surface
    }

    /// [`Tracer::surface`] with the interpolated normal.
    #[inline]
    fn smooth_surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let scene = self.scene;
        let mut surface = scene.parts.geometry.surface(ray, hit);
        if let Some(view) = &scene.view {
            view.put_on(&mut surface, &scene.parts.geometry);
        }
        surface
    }

    /// The surfaces at many hits, in their order, each with its [`Material::opaque_base`](crate::materials::Material::opaque_base).
    /// Textures of surfaces of one material are looked up together.
    pub fn opaque_bases<'h>(
        &self,
        hits: impl Iterator<Item = (&'h Ray, &'h Hit)>,
        (surfaces, bases): (&mut Vec<Surface>, &mut Vec<Option<OpaqueBaseInputs>>),
    ) {
        surfaces.clear();
        bases.clear();
        surfaces.extend(hits.map(|(ray, hit)| self.smooth_surface(ray, hit)));
        let number = |surface: &Surface| self.scene.parts.geometry.material_of(surface.object);
        let is_one = |a: &Surface, b: &Surface| {
            number(a) == number(b) && (a.tangent != Vec3::ZERO) == (b.tangent != Vec3::ZERO)
        };
        for surfaces in surfaces.chunk_by_mut(is_one) {
            let material = self.scene.material(&surfaces[0]);
            if surfaces[0].tangent != Vec3::ZERO {
                material.set_normals(surfaces);
            }
            material.opaque_bases(surfaces, bases);
        }
    }

    #[inline]
    fn closest_hit(&mut self, ray: &Ray, query: &Query) -> Option<Hit> {
        let accelerator = &self.scene.accelerator;
        if self.counting {
            return accelerator.closest_hit_counted(ray, query, &mut self.counters);
        }
        self.counters.rays += 1;
        match &self.scene.alone {
            Some(tree) if ray.mask != 0 => self.scene.parts.geometry.closest_hit(&**tree, ray, query),
            _ => accelerator.closest_hit(ray, query),
        }
    }

    /// True when anything is between a ray's ends.
    #[inline]
    pub fn occluded(&mut self, ray: &Ray) -> bool {
        self.ask(ray, Tracer::any_hit)
    }

    /// For each ray, whether anything is between its ends: [`Tracer::occluded`] for many rays.
    ///
    /// `n` gives the normal at the end of each, see [`Tracer::ending_on`].
    pub fn all_occluded(&mut self, rays: &[Ray], n: impl Fn(usize) -> Vec3, occluded: &mut [bool]) {
        let scene = self.scene;
        let Some(tree) = self.batch_tree(rays) else {
            for (i, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
                *occluded = self.ending_on(ray, n(i), |tracer| tracer.occluded(ray));
            }
            return;
        };
        self.counters.rays += rays.len() as u64;
        if !scene.may_pass_surfaces() {
            tree.any_hits(rays, &scene.query, occluded);
            return;
        }
        self.blockers.clear();
        self.blockers.resize(rays.len(), None);
        tree.blockers(rays, &scene.query, &mut self.blockers);
        for (i, (ray, occluded)) in rays.iter().zip(occluded).enumerate() {
            let blocker = self.blockers[i];
            *occluded = blocker.is_some();
            if blocker.is_some_and(|blocker| !scene.parts.surely_stops(ray, blocker, &scene.sheets, n(i))) {
                // It may pass what it hits. Asked again, and counted once.
                self.counters.rays -= 1;
                *occluded = self.ending_on(ray, n(i), |tracer| tracer.occluded(ray));
            }
        }
    }

    #[inline]
    fn any_hit(&mut self, ray: &Ray, query: &Query) -> bool {
        let accelerator = &self.scene.accelerator;
        if self.counting {
            return accelerator.any_hit_counted(ray, query, &mut self.counters);
        }
        self.counters.rays += 1;
        match &self.scene.alone {
            Some(tree) if ray.mask != 0 => self.scene.parts.geometry.any_hit(&**tree, ray, query),
            _ => accelerator.any_hit(ray, query),
        }
    }

    /// True when something that emits no light is between a ray's ends.
    ///
    /// In the classic modes the surface of a light casts no shadow.
    pub fn blocked(&mut self, ray: &Ray) -> bool {
        if !self.occluded(ray) {
            return false;
        }
        if !self.scene.has_emissive_surfaces() {
            return true;
        }
        let mut rest = *ray;
        while let Some(surface) = self.closest(&rest) {
            if self.scene.light_of(surface.object).is_none() {
                return true;
            }
            rest.exclude = surface.primitive;
            rest.t_min = surface.t.next_up();
        }
        false
    }
}

/// A number that identifies a ray.
fn ray_hash(ray: &Ray) -> u64 {
    let [x, y, z] = ray.origin.map(|c| u64::from(c.to_bits()));
    let [dx, dy, dz] = ray.direction.map(|c| u64::from(c.to_bits()));
    hash_words([x << 32 | dx, y << 32 | dy, z << 32 | dz])
}

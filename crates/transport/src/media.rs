//! Media between surfaces: nothing, or what absorbs and scatters, such as glass, water and fog, with priorities where they
//! overlap.
//!
//! Where two media overlap, that of higher priority wins. The surface of the other one separates nothing in there: paths
//! pass through it without an event. [Schmidt 2002]
//!
//! Surfaces that coincide, such as those of a glass and of the water that fills it exactly, are crossed together, in
//! whatever order rounding puts them: they are one surface, between the strongest medium in front of all of them and the
//! strongest behind. It has the BSDF of the stronger of the two.
//!
//! Materials without a priority take no part. Their refractive index is relative to whatever surrounds them.

mod coincident;
mod nested;
mod passage;

use crate::interaction::{Interaction, MediumPoint};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, Medium, Ray, Scene, Surface, Tracer, Wavelength};
use coincident::Coincident;
use nested::{NONE, Overlap, strength};
pub(crate) use passage::{Arrival, Passage, Travelled};

/// Maximum number of surfaces that a ray passes to find the media that it starts in.
const MAX_SURFACES: usize = 64;

/// The media that a path is in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Media {
    /// Objects around it that have a priority.
    overlap: Overlap,
    /// The object whose medium the path travels through, as far as it is known.
    inside: u32,
}

impl Media {
    /// No media.
    pub(crate) const AIR: Media = Media { overlap: Overlap::NOTHING, inside: NONE };

    /// The media that a path starts in: those that it would leave without having entered them.
    pub(crate) fn at_start(tracer: &mut Tracer, ray: &Ray) -> Media {
        let (mut media, scene) = (Media::AIR, tracer.scene);
        let t_max = match scene.absorption_distance(ray) {
            _ if scene.has_nested() => ray.t_max,
            Some(t) => t.min(ray.t_max),
            // Outside the bounds of everything that absorbs there is no medium.
            None => return media,
        };
        let (mut ray, mut seen, mut innermost) = (Ray { t_max, ..*ray }, [NONE; MAX_SURFACES], None);
        let mut count = 0;
        while count < MAX_SURFACES {
            let Some(closest) = tracer.closest(&ray) else { break };
            let coincident = Coincident::with(tracer, &ray, &closest);
            for surface in std::iter::once(&closest).chain(&coincident.others).take(MAX_SURFACES - count) {
                let is_first = !seen.contains(&surface.object);
                seen[count] = surface.object;
                count += 1;
                if surface.n_geom.dot(Vec3::from(ray.direction)) <= 0.0 || !is_first {
                    continue;
                }
                let material = scene.material(surface);
                if material.nested().is_some() {
                    media.overlap.add(surface.object);
                } else if material.medium().is_some() && media.overlap == Overlap::NOTHING {
                    // What the ray leaves first is innermost. One without a priority replaces what surrounds it.
                    let inside = *innermost.get_or_insert(surface.object);
                    if !scene.has_nested() {
                        return Media { inside, ..media };
                    }
                }
            }
            ray = behind(&ray, &Surface { t: coincident.t, ..closest });
        }
        media.inside = innermost.unwrap_or_else(|| media.overlap.strongest_object(scene));
        media
    }

    /// What the path travels through, as far as it is known.
    #[inline]
    fn medium(&self, scene: &Scene) -> Medium {
        match self.inside {
            NONE => Medium::VACUUM,
            object => scene.material_of(object).medium().unwrap_or(Medium::VACUUM),
        }
    }

    /// Transmittance of what the path travels through, over a distance in metres.
    #[inline]
    fn transmittance(&self, scene: &Scene, distance: f32) -> Rgb {
        if self.inside == NONE { Rgb::WHITE } else { self.medium(scene).transmittance(distance) }
    }

    /// Follows a ray of unit direction to the next event: of a medium, where the numbers that `draw` gives find one, or at the
    /// first surface that separates two media. `first` is the first surface along the ray. Afterwards these are the media on
    /// the side that the ray comes from.
    ///
    /// Beyond the last surface nothing happens: the boundary of what scatters would have been met.
    #[inline]
    pub(crate) fn travel(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        first: Option<Surface>,
        mut draw: impl FnMut() -> f32,
    ) -> Travelled {
        let scene = tracer.scene;
        let direction = Vec3::from(ray.direction);
        let mut travelled = Travelled::NOWHERE;
        let (mut next, mut begin) = (first, 0.0);
        while let Some(surface) = next {
            let surface = self.arrive(tracer, ray, surface);
            let medium = self.medium(scene);
            let length = surface.t - begin;
            if medium.scatters() {
                let distance = medium.sample_distance(draw(), draw());
                if distance < length {
                    let t = begin + distance;
                    let p = Vec3::from(ray.origin) + direction * t;
                    self.overlap.leave();
                    return travelled.scattered(
                        &medium,
                        distance,
                        MediumPoint { p, t, time: ray.time, phase: medium.phase },
                    );
                }
            }
            travelled = travelled.passed(medium.free_path(length));
            if self.overlap.separates(scene, &surface) {
                return Travelled { arrival: Arrival::Surface(surface), ..travelled };
            }
            self.cross(scene, &surface, direction);
            begin = surface.t;
            next = tracer.closest(&behind(ray, &surface));
        }
        travelled
    }

    /// The first surface along a ray of unit direction that separates two media, and the transmittance up to there, given the
    /// first surface along the ray. Afterwards these are the media on the side that the ray comes from.
    #[inline]
    pub(crate) fn closest_from(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        surface: Surface,
    ) -> Option<(Surface, Rgb)> {
        let scene = tracer.scene;
        let direction = Vec3::from(ray.direction);
        let surface = self.arrive(tracer, ray, surface);
        let passed = self.transmittance(scene, surface.t);
        if self.overlap.separates(scene, &surface) {
            return Some((surface, passed));
        }
        let (mut last, mut passed) = (surface, passed);
        loop {
            self.cross(scene, &last, direction);
            let surface = tracer.closest(&behind(ray, &last))?;
            let surface = self.arrive(tracer, ray, surface);
            passed *= self.transmittance(scene, surface.t - last.t);
            if self.overlap.separates(scene, &surface) {
                return Some((surface, passed));
            }
            last = surface;
        }
    }

    /// The surface, of those that coincide with the closest one along a ray, at which the ray ends, if they separate two media;
    /// otherwise the rest of the ray. Afterwards these are the media on the side that the ray comes from, or in which the
    /// rest begins.
    pub(crate) fn end_or_rest(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        surface: Surface,
    ) -> Result<Surface, Ray> {
        let scene = tracer.scene;
        let surface = self.arrive(tracer, ray, surface);
        if self.overlap.separates(scene, &surface) {
            return Ok(surface);
        }
        self.cross(scene, &surface, Vec3::from(ray.direction));
        Err(behind(ray, &surface))
    }

    /// What lies along a ray that begins in these media and is `distance` metres long; `None` where something blocks it.
    ///
    /// For light from infinity there is no `distance`: beyond the last surface nothing absorbs. `n` is the
    /// [normal](Scene::normal_towards) of the surface that the ray ends on at parameter 1; zero where there is none.
    #[inline]
    pub(crate) fn visible(
        &self,
        tracer: &mut Tracer,
        ray: &Ray,
        distance: Option<f32>,
        n: Vec3,
    ) -> Option<Passage> {
        tracer.ending_on(ray, n, |tracer| self.passed(tracer, ray, distance))
    }

    /// What lies along a ray of this length that nothing blocks, where media have no priorities.
    #[inline]
    pub(crate) fn unoccluded(&self, scene: &Scene, distance: Option<f32>) -> Passage {
        match distance {
            Some(distance) if self.inside != NONE => {
                Passage::CLEAR.then(self.medium(scene).free_path(distance))
            }
            _ => Passage::CLEAR,
        }
    }

    #[inline]
    fn passed(&self, tracer: &mut Tracer, ray: &Ray, distance: Option<f32>) -> Option<Passage> {
        if !tracer.scene.has_nested() {
            return (!tracer.occluded(ray)).then(|| self.unoccluded(tracer.scene, distance));
        }
        let (mut media, mut rest, scene) = (*self, *ray, tracer.scene);
        let direction = Vec3::from(ray.direction);
        let (length, mut begin, mut passed) = (direction.length(), 0.0, Passage::CLEAR);
        while let Some(surface) = tracer.closest(&rest) {
            let surface = media.arrive(tracer, ray, surface);
            if media.overlap.separates(scene, &surface) {
                return None;
            }
            passed = passed.then(media.medium(scene).free_path((surface.t - begin) * length));
            media.cross(scene, &surface, direction);
            (begin, rest) = (surface.t, behind(&rest, &surface));
        }
        let rest =
            distance.filter(|_| media.inside != NONE).map(|distance| (distance - begin * length).max(0.0));
        Some(rest.map_or(passed, |rest| passed.then(media.medium(scene).free_path(rest))))
    }

    /// The BSDF at a wavelength of a surface that separates these media from others; its normal bends towards viewers.
    #[inline]
    pub(crate) fn bsdf(&self, scene: &Scene, surface: &Surface, wavelength: &Wavelength) -> Bsdf {
        let mut bsdf = scene.material(surface).bsdf(surface);
        bsdf.bend();
        if !scene.has_nested() && !scene.disperses() {
            return bsdf;
        }
        let is_nested = scene.has_nested() && scene.material(surface).nested().is_some();
        // On the far side of a surface that the path would leave through, those that coincide with it are crossed.
        let is_left = || self.overlap.contains(surface.object);
        let outside = if is_left() { self.overlap.with_all_together() } else { self.overlap };
        let around = if is_nested { outside.without(surface.object).strongest(scene) } else { None };
        match around {
            Some((_, outside)) => {
                let bsdf = bsdf.refracting(wavelength, outside.index(wavelength));
                bsdf.splitting(outside.dispersion != 0.0)
            }
            None if scene.disperses() => bsdf.refracting(wavelength, 1.0),
            None => bsdf,
        }
    }

    /// How light scatters, at a wavelength, where a path through these media has arrived; `None` where it escapes.
    #[inline]
    pub(crate) fn interaction(
        &self,
        scene: &Scene,
        arrival: &Arrival,
        wavelength: &Wavelength,
    ) -> Option<Interaction> {
        match arrival {
            Arrival::Surface(surface) => {
                Some(Interaction::Surface(*surface, self.bsdf(scene, surface, wavelength)))
            }
            Arrival::Medium(point) => Some(Interaction::Medium(*point)),
            Arrival::Escape => None,
        }
    }

    /// The media in which a path continues from where it came along `wo`.
    #[inline]
    pub(crate) fn towards(&self, scene: &Scene, at: &Interaction, wo: Vec3, direction: Vec3) -> Media {
        at.surface().map_or(*self, |surface| self.beyond(scene, surface, wo, direction))
    }

    /// The same for a surface.
    #[inline]
    pub(crate) fn beyond(&self, scene: &Scene, surface: &Surface, wo: Vec3, direction: Vec3) -> Media {
        let mut media = *self;
        if wo.dot(surface.n_geom) * direction.dot(surface.n_geom) < 0.0 {
            media.cross(scene, surface, direction);
        }
        media.overlap.leave();
        media
    }

    /// On arrival at the closest surface along a ray. Returns the one, of those that coincide with it, that separates two
    /// media if any does.
    #[inline]
    fn arrive(&mut self, tracer: &mut Tracer, ray: &Ray, surface: Surface) -> Surface {
        self.meet(tracer.scene, &surface, Vec3::from(ray.direction));
        if tracer.scene.has_nested() { self.arrive_at_all(tracer, ray, surface) } else { surface }
    }

    /// The same for all that coincide with it.
    fn arrive_at_all(&mut self, tracer: &mut Tracer, ray: &Ray, surface: Surface) -> Surface {
        self.overlap.leave();
        let Coincident { others, t } = Coincident::with(tracer, ray, &surface);
        if others.is_empty() {
            return surface;
        }
        let scene = tracer.scene;
        others.iter().for_each(|other| self.meet(scene, other, Vec3::from(ray.direction)));
        let all = || std::iter::once(&surface).chain(&others);
        let behind = all().fold(self.overlap, |overlap, face| overlap.changed(face.object));
        let strongest = [self.overlap.strongest(scene), behind.strongest(scene)];
        let strongest =
            strongest.into_iter().flatten().max_by_key(|(object, nested)| strength(*object, nested));
        // The stronger one is left or entered here, unless it is the same in front and behind.
        let separating = all().find(|face| strongest.is_some_and(|(object, _)| object == face.object));
        let surface = *separating.unwrap_or(&surface);
        let rest = all().map(|face| face.object).filter(|object| *object != surface.object);
        self.overlap.cross_together(rest);
        Surface { t, ..surface }
    }

    /// On meeting a surface: a medium that the ray leaves is around, whether the path entered it or began there; one that
    /// it enters is not.
    #[inline]
    fn meet(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
        let leaves = surface.n_geom.dot(direction) > 0.0;
        if scene.has_nested() && scene.material(surface).nested().is_some() {
            let object = surface.object;
            if leaves != self.overlap.contains(object) {
                self.overlap = if leaves { self.overlap.with(object) } else { self.overlap.without(object) };
                self.inside = self.overlap.strongest_object(scene);
            }
        } else if leaves && scene.material(surface).medium().is_some() {
            self.inside = surface.object;
        }
    }

    /// On crossing a surface.
    #[inline]
    fn cross(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
        let enters = direction.dot(surface.n_geom) < 0.0;
        if scene.has_nested() && scene.material(surface).nested().is_some() {
            let all = self.overlap.with_all_together();
            self.overlap = if enters { all.with(surface.object) } else { all.without(surface.object) };
            self.overlap.leave();
            self.inside = self.overlap.strongest_object(scene);
        } else if scene.material(surface).medium().is_some() {
            self.inside = if enters { surface.object } else { self.overlap.strongest_object(scene) };
        }
    }
}

/// The same ray, from behind a surface that it has hit.
fn behind(ray: &Ray, surface: &Surface) -> Ray {
    Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..*ray }
}

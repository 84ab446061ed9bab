//! Media between surfaces: nothing, or absorbing glass and water, which have priorities where they overlap.
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

use bilux_math::transcendental::exp;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, Nested, Ray, Scene, Surface, Tracer, Wavelength};
use coincident::{Coincident, MAX_COINCIDENT};

/// Maximum number of nested media; further ones are ignored.
const MAX_NESTED: usize = 4;

/// No object.
const NONE: u32 = u32::MAX;

/// Maximum number of surfaces that a ray passes to find the media that it starts in.
const MAX_SURFACES: usize = 64;

/// The media that a path is in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Media {
    /// Surrounding objects that have a priority.
    around: [u32; MAX_NESTED],
    /// Objects whose surfaces coincide with the one that the path has reached: they are crossed together with it.
    together: [u32; MAX_COINCIDENT],
    /// Absorption of the medium that the path travels through, as far as it is known.
    sigma_a: Rgb,
}

impl Media {
    /// No media.
    pub(crate) const AIR: Media =
        Media { around: [NONE; MAX_NESTED], together: [NONE; MAX_COINCIDENT], sigma_a: Rgb::BLACK };

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
                    media.add(surface.object);
                } else if !material.sigma_a().is_black() && media.around == Media::AIR.around {
                    // What the ray leaves first is innermost. One without a priority replaces what surrounds it.
                    let sigma_a = *innermost.get_or_insert(material.sigma_a());
                    if !scene.has_nested() {
                        return Media { sigma_a, ..media };
                    }
                }
            }
            ray = behind(&ray, &Surface { t: coincident.t, ..closest });
        }
        media.sigma_a = innermost.unwrap_or_else(|| media.sigma_of_strongest(scene));
        media
    }

    /// The first surface along a ray of unit direction that separates two media, and the transmittance up to there.
    /// Afterwards these are the media on the side that the ray comes from.
    #[inline]
    pub(crate) fn closest(&mut self, tracer: &mut Tracer, ray: &Ray) -> Option<(Surface, Rgb)> {
        let surface = tracer.closest(ray)?;
        self.closest_from(tracer, ray, surface)
    }

    /// The same where the first surface along the ray is known.
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
        let passed = transmittance(self.sigma_a, surface.t);
        if self.separates(scene, &surface) {
            return Some((surface, passed));
        }
        let (mut last, mut passed) = (surface, passed);
        loop {
            self.cross(scene, &last, direction);
            let surface = tracer.closest(&behind(ray, &last))?;
            let surface = self.arrive(tracer, ray, surface);
            passed *= transmittance(self.sigma_a, surface.t - last.t);
            if self.separates(scene, &surface) {
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
        if self.separates(scene, &surface) {
            return Ok(surface);
        }
        self.cross(scene, &surface, Vec3::from(ray.direction));
        Err(behind(ray, &surface))
    }

    /// The transmittance of a ray that begins in these media and is `distance` metres long; `None` where something
    /// blocks it.
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
    ) -> Option<Rgb> {
        tracer.ending_on(ray, n, |tracer| self.passed(tracer, ray, distance))
    }

    /// The transmittance of a ray of this length that nothing blocks, where media have no priorities.
    #[inline]
    pub(crate) fn unoccluded(&self, distance: Option<f32>) -> Rgb {
        distance.map_or(Rgb::WHITE, |distance| transmittance(self.sigma_a, distance))
    }

    #[inline]
    fn passed(&self, tracer: &mut Tracer, ray: &Ray, distance: Option<f32>) -> Option<Rgb> {
        if !tracer.scene.has_nested() {
            return (!tracer.occluded(ray)).then(|| self.unoccluded(distance));
        }
        let (mut media, mut rest, scene) = (*self, *ray, tracer.scene);
        let direction = Vec3::from(ray.direction);
        let (length, mut begin, mut passed) = (direction.length(), 0.0, Rgb::WHITE);
        while let Some(surface) = tracer.closest(&rest) {
            let surface = media.arrive(tracer, ray, surface);
            if media.separates(scene, &surface) {
                return None;
            }
            passed *= transmittance(media.sigma_a, (surface.t - begin) * length);
            media.cross(scene, &surface, direction);
            (begin, rest) = (surface.t, behind(&rest, &surface));
        }
        let rest = distance.map(|distance| (distance - begin * length).max(0.0));
        Some(passed * media.unoccluded(rest))
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
        let is_left = || self.around.contains(&surface.object);
        let outside = if is_left() { self.with_all_together() } else { *self };
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

    /// The media in which a path continues from a surface that it reached along `wo`.
    #[inline]
    pub(crate) fn towards(&self, scene: &Scene, surface: &Surface, wo: Vec3, direction: Vec3) -> Media {
        let mut media = *self;
        if wo.dot(surface.n_geom) * direction.dot(surface.n_geom) < 0.0 {
            media.cross(scene, surface, direction);
        }
        media.together = [NONE; MAX_COINCIDENT];
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
        self.together = [NONE; MAX_COINCIDENT];
        let Coincident { others, t } = Coincident::with(tracer, ray, &surface);
        if others.is_empty() {
            return surface;
        }
        let scene = tracer.scene;
        others.iter().for_each(|other| self.meet(scene, other, Vec3::from(ray.direction)));
        let all = || std::iter::once(&surface).chain(&others);
        let behind = all().fold(*self, |media, face| media.changed(face.object));
        let strongest = [self.strongest(scene), behind.strongest(scene)];
        let strongest =
            strongest.into_iter().flatten().max_by_key(|(object, nested)| strength(*object, nested));
        // The stronger one is left or entered here, unless it is the same in front and behind.
        let separating = all().find(|face| strongest.is_some_and(|(object, _)| object == face.object));
        let surface = *separating.unwrap_or(&surface);
        let rest = all().map(|face| face.object).filter(|object| *object != surface.object);
        self.together.iter_mut().zip(rest).for_each(|(slot, object)| *slot = object);
        Surface { t, ..surface }
    }

    /// On meeting a surface: a medium that the ray leaves is around, whether the path entered it or began there; one that
    /// it enters is not.
    #[inline]
    fn meet(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
        let leaves = surface.n_geom.dot(direction) > 0.0;
        if scene.has_nested() && scene.material(surface).nested().is_some() {
            let object = surface.object;
            if leaves != self.around.contains(&object) {
                *self = if leaves { self.with(object) } else { self.without(object) };
                self.sigma_a = self.sigma_of_strongest(scene);
            }
        } else if leaves {
            self.sigma_a = scene.material(surface).sigma_a();
        }
    }

    /// On crossing a surface.
    #[inline]
    fn cross(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
        let enters = direction.dot(surface.n_geom) < 0.0;
        if scene.has_nested() {
            if scene.material(surface).nested().is_some() {
                let all = self.with_all_together();
                *self = if enters { all.with(surface.object) } else { all.without(surface.object) };
                self.together = [NONE; MAX_COINCIDENT];
                self.sigma_a = self.sigma_of_strongest(scene);
                return;
            }
            self.sigma_a = self.sigma_of_strongest(scene);
        } else {
            self.sigma_a = Rgb::BLACK;
        }
        if enters {
            self.sigma_a = scene.material(surface).sigma_a();
        }
    }

    /// False for the surface of a medium inside one of higher priority. Of equal priorities the object that comes first
    /// in the scene wins, so that the result is the same from both ends of a path.
    #[inline]
    fn separates(&self, scene: &Scene, surface: &Surface) -> bool {
        if !scene.has_nested() {
            return true;
        }
        let Some(own) = scene.material(surface).nested() else { return true };
        let separates = |media: &Media| match media.without(surface.object).strongest(scene) {
            Some((object, other)) => strength(surface.object, &own) > strength(object, &other),
            None => true,
        };
        separates(self) && (self.together[0] == NONE || separates(&self.with_all_together()))
    }

    /// The medium of highest priority.
    fn strongest(&self, scene: &Scene) -> Option<(u32, Nested)> {
        let media = self.around.iter().filter(|&&object| object != NONE);
        let media = media.filter_map(|&object| Some((object, scene.material_of(object).nested()?)));
        media.max_by_key(|(object, nested)| strength(*object, nested))
    }

    fn sigma_of_strongest(&self, scene: &Scene) -> Rgb {
        self.strongest(scene).map_or(Rgb::BLACK, |(object, _)| scene.material_of(object).sigma_a())
    }

    /// These media on the other side of the surfaces that are crossed together.
    fn with_all_together(&self) -> Media {
        self.together
            .iter()
            .filter(|&&object| object != NONE)
            .fold(*self, |media, &object| media.changed(object))
    }

    /// The media on the other side of an object's surface.
    fn changed(self, object: u32) -> Media {
        if self.around.contains(&object) { self.without(object) } else { self.with(object) }
    }

    fn with(mut self, object: u32) -> Media {
        self.add(object);
        self
    }

    fn add(&mut self, object: u32) {
        if !self.around.contains(&object)
            && let Some(free) = self.around.iter_mut().find(|slot| **slot == NONE)
        {
            *free = object;
        }
    }

    fn without(mut self, object: u32) -> Media {
        self.around.iter_mut().filter(|slot| **slot == object).for_each(|slot| *slot = NONE);
        self
    }
}

/// Greater for the medium that wins where two overlap: by priority, and of equal ones for the object that comes first.
fn strength(object: u32, nested: &Nested) -> (u32, std::cmp::Reverse<u32>) {
    (nested.priority, std::cmp::Reverse(object))
}

/// The same ray, from behind a surface that it has hit.
fn behind(ray: &Ray, surface: &Surface) -> Ray {
    Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..*ray }
}

/// Transmittance over a distance in metres, by Beer's law.
#[inline]
pub(crate) fn transmittance(sigma_a: Rgb, distance: f32) -> Rgb {
    if sigma_a.is_black() { Rgb::WHITE } else { sigma_a.map(|sigma| exp(-sigma * distance)) }
}

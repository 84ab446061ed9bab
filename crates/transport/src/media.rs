//! Media between surfaces: nothing, or absorbing glass and water, which have priorities where they overlap.
//!
//! The surfaces of glass and of the water in it never coincide exactly: one is modelled to reach a little into the
//! other, and where the two overlap, the medium of higher priority wins. The surface of the other one separates nothing
//! in there: paths pass through it without an event. [Schmidt 2002]
//!
//! Materials without a priority take no part. Their refractive index is relative to whatever surrounds them.

use bilux_math::transcendental::exp;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Bsdf, Nested, Ray, Scene, Surface, Tracer, Wavelength};

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
    /// Absorption of the medium that the path travels through, as far as it is known.
    sigma_a: Rgb,
}

impl Media {
    /// No media.
    pub(crate) const AIR: Media = Media { around: [NONE; MAX_NESTED], sigma_a: Rgb::BLACK };

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
        for i in 0..MAX_SURFACES {
            let Some(surface) = tracer.closest(&ray) else { break };
            let leaves = surface.n_geom.dot(Vec3::from(ray.direction)) > 0.0;
            let is_first = !seen.contains(&surface.object);
            if leaves && is_first {
                let material = scene.material(&surface);
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
            seen[i] = surface.object;
            ray = beyond(&ray, &surface);
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
        self.arrive(scene, &surface, direction);
        let passed = transmittance(self.sigma_a, surface.t);
        if self.separates(scene, &surface) {
            return Some((surface, passed));
        }
        let (mut last, mut passed) = (surface, passed);
        loop {
            self.cross(scene, &last, direction);
            let surface = tracer.closest(&beyond(ray, &last))?;
            self.arrive(scene, &surface, direction);
            passed *= transmittance(self.sigma_a, surface.t - last.t);
            if self.separates(scene, &surface) {
                return Some((surface, passed));
            }
            last = surface;
        }
    }

    /// The transmittance of a ray that begins in these media and is `distance` metres long; `None` where something
    /// blocks it.
    ///
    /// For light from infinity `distance` is 0: beyond the last surface nothing absorbs. `n` is the
    /// [normal](Scene::normal_towards) of the surface that the ray ends on at parameter 1; zero where there is none.
    #[inline]
    pub(crate) fn visible(&self, tracer: &mut Tracer, ray: &Ray, distance: f32, n: Vec3) -> Option<Rgb> {
        tracer.ending_on(ray, n, |tracer| self.passed(tracer, ray, distance))
    }

    /// The transmittance of a ray of this length that nothing blocks, where media have no priorities.
    #[inline]
    pub(crate) fn unoccluded(&self, distance: f32) -> Rgb {
        transmittance(self.sigma_a, distance)
    }

    #[inline]
    fn passed(&self, tracer: &mut Tracer, ray: &Ray, distance: f32) -> Option<Rgb> {
        if !tracer.scene.has_nested() {
            return (!tracer.occluded(ray)).then(|| self.unoccluded(distance));
        }
        let (mut media, mut rest, scene) = (*self, *ray, tracer.scene);
        let direction = Vec3::from(ray.direction);
        let (length, mut begin, mut passed) = (direction.length(), 0.0, Rgb::WHITE);
        while let Some(surface) = tracer.closest(&rest) {
            media.arrive(scene, &surface, direction);
            if media.separates(scene, &surface) {
                return None;
            }
            passed *= transmittance(media.sigma_a, (surface.t - begin) * length);
            media.cross(scene, &surface, direction);
            (begin, rest) = (surface.t, beyond(&rest, &surface));
        }
        Some(passed * transmittance(media.sigma_a, (distance - begin * length).max(0.0)))
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
        let around = if is_nested { self.without(surface.object).strongest(scene) } else { None };
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
        media
    }

    /// On arrival: a medium that the ray leaves is around, whether the path entered it or began there; one that it
    /// enters is not.
    #[inline]
    fn arrive(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
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
                *self = if enters { self.with(surface.object) } else { self.without(surface.object) };
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
        match self.without(surface.object).strongest(scene) {
            Some((object, other)) => {
                (own.priority, other_first(surface.object)) > (other.priority, other_first(object))
            }
            None => true,
        }
    }

    /// The medium of highest priority.
    fn strongest(&self, scene: &Scene) -> Option<(u32, Nested)> {
        let media = self.around.iter().filter(|&&object| object != NONE);
        let media = media.filter_map(|&object| Some((object, scene.material_of(object).nested()?)));
        media.max_by_key(|(object, nested)| (nested.priority, other_first(*object)))
    }

    fn sigma_of_strongest(&self, scene: &Scene) -> Rgb {
        self.strongest(scene).map_or(Rgb::BLACK, |(object, _)| scene.material_of(object).sigma_a())
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

/// Greater for the object that comes first.
fn other_first(object: u32) -> std::cmp::Reverse<u32> {
    std::cmp::Reverse(object)
}

/// The same ray, from behind a surface that it has hit.
fn beyond(ray: &Ray, surface: &Surface) -> Ray {
    Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..*ray }
}

/// Transmittance over a distance in metres, by Beer's law.
#[inline]
pub(crate) fn transmittance(sigma_a: Rgb, distance: f32) -> Rgb {
    if sigma_a.is_black() { Rgb::WHITE } else { sigma_a.map(|sigma| exp(-sigma * distance)) }
}

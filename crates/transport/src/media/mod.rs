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

pub(crate) mod ball;
mod balls;
mod between;
pub(crate) mod camera_segment;
mod coincident;
mod enclosed;
pub(crate) mod equiangular;
mod fog;
pub(crate) mod interaction;
mod nested;
mod passage;
mod start;

use crate::media::interaction::Interaction;
use bilux_math::{Rgb, Vec3};
use bilux_scene::media::{Draws, Flight, FreePath, MediumEvent, MediumLine, WalkChannel};
use bilux_scene::{Bsdf, Medium, Ray, Scene, Surface, Tracer, Wavelength};
use coincident::Coincident;
use nested::{NONE, Overlap};
pub(crate) use passage::{Arrival, MediumPart, Passage, Travelled, behind, draws_along};

/// The media that a path is in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Media {
    /// Objects around it that have a priority.
    overlap: Overlap,
    /// The object whose medium the path travels through, as far as it is known.
    inside: u32,
    /// The channel whose distances walks have here.
    pub(crate) channel: u8,
}

impl Media {
    /// No media.
    pub(crate) const AIR: Media = Media { overlap: Overlap::NOTHING, inside: NONE, channel: 0 };

    /// Medium that the path travels through, as far as it is known.
    #[inline]
    fn medium<'s>(&self, scene: &'s Scene) -> Medium<'s> {
        match self.inside {
            NONE => Medium::VACUUM,
            object => scene.material_of(object).medium().unwrap_or(Medium::VACUUM),
        }
    }

    /// The object whose inside scatters light here, and the scattering coefficient there, per metre; `None` where none does.
    pub(crate) fn scattering(&self, scene: &Scene) -> Option<(u32, Rgb)> {
        (self.inside != NONE).then(|| (self.inside, self.medium(scene).sigma_s))
    }

    /// Free path along a part of a ray, from here up to there in metres, for light that passes.
    #[inline]
    fn passed_between(
        &self,
        scene: &Scene,
        ray: &Ray,
        [begin, end]: [f32; 2],
        draws: &mut Draws,
    ) -> FreePath {
        if self.inside == NONE {
            return FreePath::CLEAR;
        }
        let medium = self.medium(scene);
        let line = scene.medium_line(self.inside, &medium, ray, begin);
        medium.passed(line.as_ref(), end - begin, usize::from(self.channel), || draws.next_1d())
    }

    /// Follows a ray of unit direction to the next event: of a medium, where the numbers that `draw` gives find one, or at the first surface
    /// that separates two media. `first` is the first surface along the ray, or along the part of it up to the event of the flight `ahead`. Afterwards
    /// these are the media on the side that the ray comes from. `odds` are those of walks in each channel so far. `visit` is told of each
    /// medium that scatters, on the way.
    ///
    /// Beyond the last surface nothing happens: the boundary of what scatters would have been met.
    #[inline]
    pub(crate) fn travel(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        (first, ahead): (Option<Surface>, Option<Flight>),
        odds: Rgb,
        mut draw: impl FnMut() -> f32,
        mut visit: impl FnMut(MediumPart),
    ) -> Travelled {
        let scene = tracer.scene;
        let direction = Vec3::from(ray.direction);
        let mut travelled = Travelled::NOWHERE;
        let (mut next, mut begin) = (first, 0.0);
        if let (None, Some(flight)) = (first, ahead) {
            return self.fly(scene, ray, [0.0; 2], &flight, travelled, &mut visit);
        }
        while let Some(surface) = next {
            let surface = self.arrive(tracer, ray, surface);
            let medium = self.medium(scene);
            let line = scene.medium_line(self.inside, &medium, ray, begin);
            let channel = WalkChannel { index: usize::from(self.channel), odds: odds * travelled.odds };
            let flight = medium.walk(line.as_ref(), surface.t - begin, channel, &mut draw);
            travelled = self.fly(scene, ray, [begin, surface.t], &flight, travelled, &mut visit);
            if flight.event.is_some() {
                return travelled;
            }
            if self.overlap.separates(scene, &surface) {
                return Travelled { arrival: Arrival::Surface(surface), ..travelled };
            }
            self.cross(scene, &surface, direction);
            begin = surface.t;
            next = tracer.closest(&behind(ray, &surface));
        }
        travelled
    }

    /// To the end of a flight through the medium around, between these distances along a ray unless an event ends it.
    #[inline]
    fn fly(
        &mut self,
        scene: &Scene,
        ray: &Ray,
        [begin, end]: [f32; 2],
        flight: &Flight,
        travelled: Travelled,
        visit: &mut impl FnMut(MediumPart),
    ) -> Travelled {
        let medium = self.medium(scene);
        let travelled = travelled.lit(flight.emitted);
        if medium.scatters() {
            let end = flight.event.map_or(end, |event| begin + event.distance);
            visit(MediumPart { object: self.inside, medium, ends: [begin, end], before: &travelled });
        }
        let Some(MediumEvent { distance, sigma_s, sigma_t }) = flight.event else {
            return travelled.passed(flight.path);
        };
        let point = self.point(scene, &medium, ray, begin + distance);
        self.overlap.leave();
        travelled.scattered(flight.path, [sigma_s, sigma_t], point)
    }

    /// The first surface along a ray of unit direction that separates two media, if there is one, and the transmittance up to there or
    /// beyond all media, given the first surface along the ray: of media that vary an estimate, by random numbers of this seed. Afterwards these are the media on
    /// the side that the ray comes from.
    #[inline]
    pub(crate) fn closest_from(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        surface: Surface,
        seed: u64,
    ) -> (Option<Surface>, Rgb) {
        let scene = tracer.scene;
        let direction = Vec3::from(ray.direction);
        let surface = self.arrive(tracer, ray, surface);
        let mut draws = draws_along(ray, seed);
        let passed = self.passed_between(scene, ray, [0.0, surface.t], &mut draws).transmittance;
        if self.overlap.separates(scene, &surface) {
            return (Some(surface), passed);
        }
        let (mut last, mut passed) = (surface, passed);
        loop {
            self.cross(scene, &last, direction);
            let Some(surface) = tracer.closest(&behind(ray, &last)) else { return (None, passed) };
            let surface = self.arrive(tracer, ray, surface);
            passed *= self.passed_between(scene, ray, [last.t, surface.t], &mut draws).transmittance;
            if self.overlap.separates(scene, &surface) {
                return (Some(surface), passed);
            }
            last = surface;
        }
    }

    /// Visits the media along a ray of unit direction up to the first surface that separates two, which it returns: the object of each, its
    /// line through grids, and its ends in metres. `first` is the first surface of all. Afterwards these are the media before that surface.
    pub(crate) fn each_along(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        first: Option<Surface>,
        mut visit: impl FnMut(u32, &Medium, Option<MediumLine>, [f32; 2]),
    ) -> Option<Surface> {
        let (scene, mut next, mut begin) = (tracer.scene, first, 0.0);
        while let Some(surface) = next {
            let surface = self.arrive(tracer, ray, surface);
            let medium = self.medium(scene);
            if !medium.is_clear() {
                visit(
                    self.inside,
                    &medium,
                    scene.medium_line(self.inside, &medium, ray, begin),
                    [begin, surface.t],
                );
            }
            if self.overlap.separates(scene, &surface) {
                return Some(surface);
            }
            self.cross(scene, &surface, Vec3::from(ray.direction));
            (begin, next) = (surface.t, tracer.closest(&behind(ray, &surface)));
        }
        None
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

    /// The BSDF at a wavelength of a surface that separates these media from others; its normal bends towards viewers.
    #[inline]
    pub(crate) fn bsdf(&self, scene: &Scene, surface: &Surface, wavelength: &Wavelength) -> Bsdf {
        let mut bsdf = scene.material(surface).bsdf(surface);
        bsdf.bend();
        if !scene.has_nested() && !scene.disperses() {
            return bsdf;
        }
        let is_nested = scene.has_nested() && scene.nested(surface.object).is_some();
        match is_nested.then(|| self.overlap.outside(scene, surface.object)).flatten() {
            Some(outside) => {
                let bsdf = bsdf.refracting(wavelength, outside.index(wavelength));
                bsdf.splitting(outside.dispersion != 0.0)
            }
            None if scene.disperses() => bsdf.refracting(wavelength, 1.0),
            None => bsdf,
        }
    }

    /// Interaction, at a wavelength, where a path through these media has arrived; `None` where it escapes.
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

    /// The media in which a path continues from a surface where it came along `wo`.
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

    /// Arrives, as [`Media::arrive`] does, at all surfaces that coincide with this one.
    fn arrive_at_all(&mut self, tracer: &mut Tracer, ray: &Ray, surface: Surface) -> Surface {
        self.overlap.leave();
        let Coincident { others, t } = Coincident::with(tracer, ray, &surface);
        if others.is_empty() {
            return surface;
        }
        let scene = tracer.scene;
        others.iter().for_each(|other| self.meet(scene, other, Vec3::from(ray.direction)));
        let all = || std::iter::once(&surface).chain(&others);
        let behind = all().fold(self.overlap, |overlap, face| overlap.changed(scene.body(face.object)));
        let strongest = [self.overlap, behind].map(|overlap| overlap.strongest_object(scene));
        let strongest = strongest.into_iter().filter(|&object| object != NONE);
        let strongest = strongest.max_by_key(|&object| scene.nesting(object));
        // The stronger one is left or entered here, unless it is the same in front and behind.
        let separating = all().find(|face| strongest == Some(scene.body(face.object)));
        let surface = *separating.unwrap_or(&surface);
        let rest = all().filter(|face| face.object != surface.object).map(|face| scene.body(face.object));
        self.overlap.cross_together(rest);
        Surface { t, ..surface }
    }

    /// On meeting a surface: a medium that the ray leaves is around, whether the path entered it or began there; one that
    /// it enters is not.
    #[inline]
    fn meet(&mut self, scene: &Scene, surface: &Surface, direction: Vec3) {
        let leaves = surface.n_geom.dot(direction) > 0.0;
        if scene.has_nested() && scene.nested(surface.object).is_some() {
            let object = scene.body(surface.object);
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
        if scene.has_nested() && scene.nested(surface.object).is_some() {
            let (all, object) = (self.overlap.with_all_together(), scene.body(surface.object));
            self.overlap = if enters { all.with(object) } else { all.without(object) };
            self.overlap.leave();
            self.inside = self.overlap.strongest_object(scene);
        } else if scene.material(surface).medium().is_some() {
            self.inside = if enters { surface.object } else { self.overlap.strongest_object(scene) };
        }
    }
}

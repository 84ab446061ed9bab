//! Beams: the rays of subpaths through media that are the same everywhere, and how those of a camera subpath and of a light
//! subpath are merged where they come close.
//!
//! A beam ends at the event that its walk has found. So it comes as far as some point with the probability that light does, and
//! stands for all walks that have an event there: whatever a weight knows of the density of an event, it knows of a beam too,
//! up to the extinction. Two beams that cross under an angle find a point as often as light subpaths times the width of
//! merging, times the sine of the angle, over the square of the extinction. This depends on the point alone, as the area of merging does on
//! surfaces, so the recursive sums of [`Partial`] stay as they are.
//! [Křivánek 2014, estimator B-B1D with short beams]

use crate::film::limits::Events;
use crate::light::emission::Start;
use crate::media::{Passage, Travelled};
use crate::techniques::mis::{Edge, Partial};
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::{Rgb, Vec3};
use bilux_scene::media::mean;
use bilux_scene::{Camera, Medium, Ray, Scene};

/// A line that begins at a point and is `length` metres long along a unit vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) length: f32,
}

/// Two lines are parallel if the square of the sine between them is less.
const PARALLEL: f32 = 1e-10;

/// A part of a subpath's ray, in one medium.
#[derive(Clone, Copy)]
pub(crate) struct Beam<const N: usize = 1> {
    pub(crate) line: Line,
    /// The object whose inside is the medium.
    pub(crate) object: u32,
    /// From the last vertex to where it begins: metres, and what lies between.
    before: f32,
    passage: Passage,
    /// The subpath: as it left the last vertex, but for throughput and odds, which are those where the beam begins.
    pub(crate) subpath: Leaving<N>,
}

/// A subpath as it leaves a vertex.
#[derive(Clone, Copy)]
pub(crate) struct Leaving<const N: usize = 1> {
    /// The cell in which it began, if that was at a light: [`crate::light::emission::Start::cell`].
    pub(crate) origin: u16,
    /// The channel of its sample's distances.
    pub(crate) channel: u8,
    /// Whether it carries a single wavelength.
    pub(crate) is_split: bool,
    /// The vertex is a point of a medium; it is infinitely far away.
    pub(crate) leaves_medium: bool,
    pub(crate) by_area: bool,
    pub(crate) beta: Rgb,
    pub(crate) odds: Rgb,
    pub(crate) partial: Partial<N>,
    /// The light, if the vertex is on one.
    pub(crate) start: Option<Start>,
    /// Events so far: all, and as far as they limit paths.
    pub(crate) depth: u32,
    pub(crate) events: Events,
}

/// State of a beam's subpath at one of its points.
pub(crate) struct Crossing<const N: usize> {
    pub(crate) beta: Rgb,
    pub(crate) odds: Rgb,
    pub(crate) partial: Partial<N>,
    /// The distance from the last vertex, in metres, and the density per metre with which a walk has an event there.
    pub(crate) distance: f32,
    pub(crate) by_walk: f32,
}

impl<const N: usize> Leaving<N> {
    /// The part of its ray that lies between two distances, inside an object, beyond what the walk has `travelled`.
    pub(crate) fn beam(
        &self,
        ray: &Ray,
        object: u32,
        [begin, end]: [f32; 2],
        travelled: &Travelled,
    ) -> Beam<N> {
        let direction = Vec3::from(ray.direction);
        let origin = Vec3::from(ray.origin) + direction * begin;
        let odds = self.odds * travelled.odds;
        let all = mean(odds);
        let (beta, odds) = (self.beta * travelled.weight / all, odds / all);
        Beam {
            line: Line { origin, direction, length: end - begin },
            object,
            before: begin,
            passage: travelled.passage,
            subpath: Leaving { beta, odds, ..*self },
        }
    }
}

#[cfg(test)]
impl Beam {
    /// One in no medium, of a line alone.
    pub(crate) fn of_line(line: Line, origin: u16) -> Beam {
        let subpath = Leaving {
            origin,
            channel: 0,
            is_split: false,
            leaves_medium: false,
            by_area: false,
            partial: Partial::START,
            start: None,
            depth: 0,
            events: Events::default(),
            beta: Rgb::WHITE,
            odds: Rgb::WHITE,
        };
        let ray = Ray::new(line.origin.to_array(), line.direction.to_array());
        subpath.beam(&ray, 0, [0.0, line.length], &Travelled::NOWHERE)
    }
}

impl<const N: usize> Beam<N> {
    /// Along this distance, in its medium, as an event there would find it. `eye` is the camera's ray, if it comes straight from there.
    pub(crate) fn at(
        &self,
        scene: &Scene,
        medium: &Medium,
        along: f32,
        eye: Option<(&dyn Camera, &Ray)>,
        techniques: &TechniqueCounts<N>,
    ) -> Crossing<N> {
        let Leaving { channel, leaves_medium, by_area, start, mut partial, .. } = self.subpath;
        let free = medium.free_path(along, usize::from(channel));
        let travelled = Travelled { passage: self.passage, ..Travelled::NOWHERE }.passed(free);
        let (odds, passage) = (self.subpath.odds * travelled.odds, travelled.passage);
        let all = mean(odds);
        let edge = Edge { forward: passage.arriving(None), back: passage.returning(leaves_medium) };
        let distance = self.before + along;
        if let Some((camera, ray)) = eye {
            let density = camera.density(ray, distance);
            partial = Partial::of_camera(density * edge.forward, techniques, PerSet::ZERO);
        } else {
            let distance2 = if by_area { 1.0 } else { distance * distance };
            let ratio = start.map_or(1.0, |start| start.light_sampling_ratio(scene, self.line.at(along)));
            let connections = if start.is_some() { PerSet::ONE } else { techniques.connections };
            partial.arrive(distance2 * ratio, edge, connections, PerSet::ZERO);
        }
        let beta = self.subpath.beta * travelled.weight / all;
        Crossing { beta, odds: odds / all, partial, distance, by_walk: edge.forward }
    }
}

/// The medium inside an object, and whether that is behind a surface.
pub(crate) fn medium_of(scene: &Scene, object: u32) -> Option<(Medium<'_>, bool)> {
    let material = scene.material_of(object);
    Some((material.medium()?, !material.is_interface()))
}

impl Line {
    #[inline]
    pub(crate) fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    pub(crate) fn end(&self) -> Vec3 {
        self.at(self.length)
    }

    /// The distances along both lines to where they are closest, if they are no more than `radius` apart there.
    #[inline(always)]
    pub(crate) fn closest(&self, other: &Line, radius: f32) -> Option<[f32; 2]> {
        let between = other.origin - self.origin;
        let across = self.direction.cross(other.direction);
        let sine2 = across.length_squared();
        let apart = between.dot(across);
        if apart * apart > radius * radius * sine2 || sine2 < PARALLEL {
            return None;
        }
        let t = between.cross(other.direction).dot(across) / sine2;
        let along = between.cross(self.direction).dot(across) / sine2;
        let is_on = 0.0 <= t && t <= self.length && 0.0 <= along && along <= other.length;
        is_on.then_some([t, along])
    }
}

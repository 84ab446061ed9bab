//! The vertices that the light subpaths of one iteration leave in the scene, for camera subpaths to merge with: on surfaces and in
//! dense media, and their rays through thin ones. [Jensen 1996; Georgiev 2012; Křivánek 2014]

pub(crate) mod beam;
pub(crate) mod beams;
pub(crate) mod grid;

use crate::film::limits::Events;
use crate::photons::beam::Beam;
use crate::photons::beams::PhotonBeams;
use crate::photons::grid::{PhotonGrid, PhotonPosition};
use crate::techniques::mis::Partial;
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Scene;

/// Merging of camera subpaths and light subpaths.
#[derive(Clone, Copy, Debug)]
pub struct Merging {
    /// The maximum distance between merged vertices in the first iteration, as a fraction of the scene's radius.
    pub radius: f32,
    /// Exponent of shrinking, 0..1: that distance falls by the power (alpha - 1) / 2 of the iteration's number.
    pub alpha: f32,
    /// Maximum number of light subpaths per iteration whose vertices are stored.
    pub max_light_paths: u32,
    /// The fraction of the light subpaths, one per pixel, that are traced: 0..=1.
    pub part: f32,
    /// When Russian roulette begins on the light subpaths.
    pub roulette_depth: u32,
    /// The largest extinction of media in which beams are merged, per metre; `None`: as the radius allows.
    pub(crate) densest: Option<f32>,
    /// The techniques that are used as well as merging.
    pub(crate) techniques: TechniqueCounts,
}

/// Counts with which the photons and beams of an iteration are merged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MergeCounts {
    /// Light subpaths times the area of the disc that they are merged over, in square metres: η of [Georgiev 2012].
    pub(crate) eta: f32,
    /// Light subpaths whose beams are kept, times the width that beams are merged over, in metres.
    pub(crate) beams: f32,
    /// The largest extinction of media that have beams, per metre.
    pub(crate) densest: f32,
    /// Light subpaths whose points in denser media are kept.
    pub(crate) points: f32,
    /// The merging radius, in metres.
    pub(crate) radius: f32,
    /// Light subpaths per pixel.
    pub(crate) light_paths: f32,
}

impl MergeCounts {
    /// No merging.
    pub(crate) const NONE: MergeCounts =
        MergeCounts { eta: 0.0, beams: 0.0, densest: 0.0, points: 0.0, radius: 0.0, light_paths: 1.0 };
}

/// Of the mean free path of media with beams, the merging radius is at most this fraction.
const THICKEST: f32 = 0.05;

/// The number of light subpaths whose beams are kept: at most, and over the merging radius as a fraction of the scene's radius. The smaller the
/// radius, the fewer beams a ray meets: some dozens, in a room that is full of fog.
const MAX_BEAM_PATHS: f32 = 16384.0;
const BEAM_PATHS: f32 = 4.0;

/// The maximum number of light subpaths whose points in dense media are kept: each may have some hundreds.
const MAX_POINT_PATHS: f32 = 16384.0;

/// Numbers of light subpaths, by what they leave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonPaths {
    /// Photons on surfaces.
    pub(crate) all: f32,
    pub(crate) with_beams: f32,
    pub(crate) with_points: f32,
}

impl Merging {
    /// Counts with which an iteration merges so many light subpaths, in a film of so many `pixels`.
    pub(crate) fn counts(
        &self,
        scene: &Scene,
        iteration: u32,
        paths: PhotonPaths,
        pixels: f32,
    ) -> MergeCounts {
        let in_media = if scene.scatters() { 1.0 } else { 0.0 };
        let radius = self.radius(scene, iteration);
        // A camera subpath is merged with the light subpaths of its channel, one in three.
        let share = if scene.has_coloured_distances() { 1.0 / 3.0 } else { 1.0 };
        MergeCounts {
            eta: std::f32::consts::PI * radius * radius * (paths.all * share),
            beams: 2.0 * radius * (paths.with_beams * share) * in_media,
            densest: self.densest.unwrap_or(THICKEST / radius),
            points: paths.with_points * share * in_media,
            radius,
            light_paths: paths.all / pixels,
        }
    }

    /// Of so many light subpaths, the beams of every `n`th are kept.
    pub(crate) fn beam_step(&self, scene: &Scene, iteration: u32, light_paths: f32) -> f32 {
        let relative = self.radius(scene, iteration) / scene.bounds().radius();
        (light_paths / (BEAM_PATHS / relative).min(MAX_BEAM_PATHS)).ceil().max(1.0)
    }

    /// Of so many light subpaths, the points of every `n`th are kept.
    pub(crate) fn point_step(light_paths: f32) -> f32 {
        (light_paths / MAX_POINT_PATHS).ceil().max(1.0)
    }

    /// All techniques of an iteration that merges so often.
    pub(crate) fn techniques(&self, counts: &MergeCounts) -> TechniqueCounts {
        let MergeCounts { eta, beams, densest, points, radius, light_paths } = *counts;
        let splats =
            if self.splats_photons() { self.techniques.splats * light_paths } else { self.techniques.splats };
        let [eta, beams, points] = [eta, beams, points].map(|count| PerSet([count]));
        TechniqueCounts { eta, beams, densest, points, radius, splats, ..self.techniques }
    }

    /// True where light subpaths are connected with the camera but not with camera subpaths: the photons' light
    /// subpaths then serve both purposes.
    pub(crate) fn splats_photons(&self) -> bool {
        self.radius > 0.0
            && self.techniques.splats != PerSet::ZERO
            && self.techniques.connections == PerSet::ZERO
    }

    /// The merging radius of an iteration, in metres: it depends only on the iteration's number. [Knaus 2011, eq. 20]
    pub(crate) fn radius(&self, scene: &Scene, iteration: u32) -> f32 {
        let shrunk = bilux_math::transcendental::powf(iteration as f32 + 1.0, 0.5 * (self.alpha - 1.0));
        scene.bounds().radius() * self.radius * shrunk
    }
}

/// A vertex of a light subpath.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Photon<const N: usize = 1> {
    /// The direction that it came from.
    pub(crate) wo: Vec3,
    pub(crate) n_geom: Vec3,
    pub(crate) beta: Rgb,
    /// Terms of the MIS weights of [`crate::bidirectional`] at the vertex.
    pub(crate) connected: PerSet<N>,
    pub(crate) d_vc: PerSet<N>,
}

/// A vertex of a light subpath in a dense medium that is the same everywhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MediumPhoton<const N: usize = 1> {
    /// The direction that it came from.
    pub(crate) wo: Vec3,
    pub(crate) beta: Rgb,
    pub(crate) partial: Partial<N>,
    /// Events up to and including this one, as far as they limit paths.
    pub(crate) events: Events,
    /// The object whose inside is the medium.
    pub(crate) object: u32,
    /// The light that it comes straight from, if it does.
    pub(crate) straight_from: Option<u32>,
    pub(crate) walk: PhotonWalk,
    /// The radius in which it is merged, in metres.
    pub(crate) radius: f32,
}

/// Channel of a photon's distances in media, and the odds of all channels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonWalk {
    /// [`crate::walk::Walk::odds`].
    pub(crate) odds: Rgb,
    /// The channel of its sample's distances. It is merged with camera subpaths of the same channel.
    pub(crate) channel: u8,
}

/// Photons and beams that the light subpaths of an iteration leave for camera subpaths to merge with.
pub struct Photons<const N: usize = 1> {
    /// With the number of light subpaths times the area that they are merged over: η of [Georgiev 2012].
    techniques: TechniqueCounts<N>,
    surfaces: PhotonGrid<Photon<N>>,
    /// Channel and odds of each photon, where distances in media are not the same in all channels.
    walks: Vec<PhotonWalk>,
    /// Their points in dense media.
    points: PhotonGrid<MediumPhoton<N>>,
    /// Their rays through thin ones.
    beams: PhotonBeams<N>,
    /// The number of light subpaths, and that of all that there would have been, if time ended their iteration.
    pub(crate) part: Option<[usize; 2]>,
}

/// Photons in the order in which they were traced.
pub(crate) struct TracedPhotons<const N: usize = 1> {
    pub(crate) surfaces: Vec<(PhotonPosition, Photon<N>)>,
    /// Walks of the photons on surfaces, or none at all.
    pub(crate) walks: Vec<PhotonWalk>,
    pub(crate) points: Vec<(PhotonPosition, MediumPhoton<N>)>,
    pub(crate) beams: Vec<Beam<N>>,
}

impl<const N: usize> TracedPhotons<N> {
    pub(crate) const NONE: TracedPhotons<N> =
        TracedPhotons { surfaces: Vec::new(), walks: Vec::new(), points: Vec::new(), beams: Vec::new() };

    /// Multiplies the throughput of all of them.
    pub(crate) fn scale(&mut self, factor: f32) {
        self.surfaces.iter_mut().for_each(|(_, photon)| photon.beta *= factor);
        self.points.iter_mut().for_each(|(_, photon)| photon.beta *= factor);
        self.beams.iter_mut().for_each(|beam| beam.subpath.beta *= factor);
    }

    /// Adds those of later light subpaths.
    pub(crate) fn append(&mut self, mut others: TracedPhotons<N>) {
        self.surfaces.append(&mut others.surfaces);
        self.walks.append(&mut others.walks);
        self.points.append(&mut others.points);
        self.beams.append(&mut others.beams);
    }
}

impl<const N: usize> Photons<N> {
    /// Sorts photons by place.
    pub(crate) fn new(traced: TracedPhotons<N>, radius: f32, techniques: TechniqueCounts<N>) -> Photons<N> {
        let TracedPhotons { surfaces, walks, points, beams } = traced;
        let (surfaces, order) = PhotonGrid::new(surfaces, radius);
        let walks =
            if walks.is_empty() { Vec::new() } else { order.iter().map(|&i| walks[i as usize]).collect() };
        let widest = points.iter().fold(0.0, |widest: f32, (_, point)| widest.max(point.radius));
        let (points, _) = PhotonGrid::new(points, widest);
        Photons { techniques, surfaces, walks, points, beams: PhotonBeams::new(beams, radius), part: None }
    }

    /// All techniques of this iteration.
    pub(crate) fn techniques(&self) -> &TechniqueCounts<N> {
        &self.techniques
    }

    /// The rays of their light subpaths through thin media.
    pub(crate) fn beams(&self) -> &PhotonBeams<N> {
        &self.beams
    }

    /// The points of their light subpaths in dense media.
    pub(crate) fn points(&self) -> &PhotonGrid<MediumPhoton<N>> {
        &self.points
    }

    /// Calls `visit` with every photon on a surface within the radius of a point, and its walk, if photons have any.
    #[inline]
    pub(crate) fn around(
        &self,
        p: Vec3,
        mut visit: impl FnMut(&PhotonPosition, &Photon<N>, Option<&PhotonWalk>),
    ) {
        let radius = self.surfaces.radius();
        self.surfaces.around(p, radius, |i, position, photon| visit(position, photon, self.walks.get(i)));
    }
}

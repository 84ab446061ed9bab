//! Data that an integrator works with: what all samples of a render share, and what belongs to one of them.

use crate::film::exposure::Exposure;
use crate::film::splat_bounds::SplatBounds;
use crate::light::choice::LightChoice;
use crate::light::emission::Emission;
use crate::sampling::sampler::PixelSampler;
use crate::techniques::optical_path::{OpticalPath, PathPoint};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Camera, Scene, Tracer, TransportMode, Wavelength};
use std::sync::Arc;

/// Data that all samples of a render share.
pub struct Context<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The camera.
    pub camera: &'a dyn Camera,
    /// Part of the film's plane where light subpaths are connected with the camera.
    pub(crate) splat_bounds: SplatBounds,
    /// When.
    pub(crate) exposure: Exposure,
    /// Chooses lights by what they bring.
    pub lights: Arc<LightChoice>,
    /// Starts light subpaths.
    pub emission: Emission,
    /// Maximum number of scattering events on surfaces after the camera; 0 is emission only.
    pub max_depth: u32,
}

/// State of one sample.
#[derive(Clone, Debug)]
pub struct SampleState {
    /// Random numbers of the sample.
    pub sampler: PixelSampler,
    /// The wavelength of its paths, wherever they begin.
    pub wavelength: Wavelength,
    /// The channel whose distances its paths have in media, wherever they begin.
    pub(crate) channel: u8,
    /// Vertices that its paths have reached so far. Queues do not count them.
    pub vertices: u32,
    /// Record of the sample, if anything is recorded.
    pub record: Option<Box<Record>>,
}

/// Record of a sample.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Events along its paths, if these are wanted.
    pub events: Option<Vec<Event>>,
    /// The light that it finds, light by light, if that is wanted.
    pub found: Option<Vec<FoundLight>>,
    /// The direction in which a path that [receives](bilux_scene::Camera::receives) leaves its point.
    pub(crate) first: Option<Vec3>,
    /// Number of the lights found that the point itself samples: their light comes straight, or through panes.
    pub(crate) straight: usize,
    /// The path from the camera, if the lengths of those that find light are wanted.
    pub(crate) way: Option<OpticalPath>,
}

/// The tools of one sample.
pub struct Task<'t, 'a> {
    /// Data that the sample shares with all others.
    pub context: &'t Context<'a>,
    /// Traces rays, and counts them.
    pub tracer: &'t mut Tracer<'a>,
    /// State of its own.
    pub sample: &'t mut SampleState,
}

/// Light that a sample has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundLight {
    /// Edges of its path, one more than the scattering events.
    pub edges: u32,
    /// The index of the light in [`Scene::lights`]; `None` for surfaces that shine without being one of these.
    pub light: Option<usize>,
    /// The direction of the path's last edge, from the camera's end towards the light; of any length.
    pub towards: Vec3,
    /// Radiance that it adds to the sample.
    pub radiance: Rgb,
    /// The optical length of its path, in metres, if that is recorded; infinite if it comes from infinity.
    pub length: f64,
}

/// An event along the path of a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Scattering events before it.
    pub depth: u32,
    /// A description for people.
    pub what: String,
    /// Vertex of the path at which it happened, if there is one.
    pub vertex: Option<PathVertex>,
}

/// A vertex of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathVertex {
    /// Kind of the vertex.
    pub kind: VertexKind,
    /// The point in the scene; for what is infinitely far away, the unit direction to it.
    pub at: Vec3,
    /// Light that it adds to the sample.
    pub light: Rgb,
}

impl PathVertex {
    /// A vertex that adds no light by itself.
    pub fn new(kind: VertexKind, at: Vec3) -> PathVertex {
        PathVertex { kind, at, light: Rgb::BLACK }
    }
}

/// Kind of a vertex: what happens there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// A surface of the camera's path, whatever happens there.
    Surface,
    /// A surface reflects the path.
    Reflection,
    /// A surface lets the path through.
    Transmission,
    /// A surface absorbs the path.
    Absorption,
    /// A medium scatters the path.
    Medium,
    /// The path hits a surface that emits light.
    Emitter,
    /// The path leaves the scene.
    Escape,
    /// A point of a light that the vertex before it is connected with.
    LightSample,
    /// A light that is infinitely far away, with which the vertex before is connected.
    DistantLight,
    /// A surface of the light's path.
    LightPath,
}

/// Random number streams of what happens to paths between surfaces begin here: to those from the camera, then to those from
/// lights.
const MEDIUM_STREAM: u64 = 3 << 32;

/// And those for equiangular points.
const EQUIANGULAR_STREAM: u64 = 5 << 32;

impl SampleState {
    /// A sample that has drawn nothing yet.
    pub fn new(sampler: PixelSampler, wavelength: Wavelength) -> SampleState {
        SampleState { sampler, wavelength, channel: 0, vertices: 0, record: None }
    }

    /// The light of a whole path as the colour channels see it: once a surface has [split](bilux_scene::Bsdf::splits)
    /// the path, it carries a single wavelength.
    #[inline]
    pub fn seen(&self, light: Rgb, is_split: bool) -> Rgb {
        if is_split { light * self.wavelength.weight } else { light }
    }

    /// Enters the stream of random numbers for what happens on the way to the vertex after `depth` events.
    #[inline]
    pub(crate) fn enter_medium(&mut self, depth: u32, mode: TransportMode) {
        let from_light = if mode == TransportMode::Importance { 1 << 32 } else { 0 };
        self.sampler.enter(MEDIUM_STREAM + from_light + u64::from(depth));
    }

    /// Enters the stream of random numbers for the [equiangular points](crate::media::equiangular) on the way to the vertex after `depth` events.
    #[inline]
    pub(crate) fn enter_equiangular(&mut self, depth: u32) {
        self.sampler.enter(EQUIANGULAR_STREAM + u64::from(depth));
    }

    /// A seed of further random numbers, which draws none.
    #[inline]
    pub(crate) fn seed(&self) -> u64 {
        self.sampler.seed()
    }

    /// Records light, if that is recorded at all; `length` gives the length of its path, given that so far.
    #[inline]
    pub(crate) fn find(
        &mut self,
        edges: u32,
        light: Option<usize>,
        towards: [f32; 3],
        radiance: Rgb,
        length: impl FnOnce(&OpticalPath) -> f64,
    ) {
        let Some(Record { found: Some(found), way, .. }) = self.record.as_deref_mut() else { return };
        let length = way.as_ref().map_or(f64::INFINITY, length);
        found.push(FoundLight { edges, light, towards: Vec3::from(towards), radiance, length });
    }

    /// Records that the path from the camera has come to a vertex, if its length is recorded.
    #[inline]
    pub(crate) fn reach(&mut self, place: impl FnOnce() -> PathPoint) {
        if let Some(way) = self.record.as_mut().and_then(|record| record.way.as_mut()) {
            way.reach(place());
        }
    }

    fn events(&mut self) -> Option<&mut Vec<Event>> {
        self.record.as_mut()?.events.as_mut()
    }

    /// Records an event; if events are not recorded, `what` is not called.
    #[inline]
    pub fn note(&mut self, depth: u32, what: impl FnOnce() -> String) {
        if let Some(events) = self.events() {
            events.push(Event { depth, what: what(), vertex: None });
        }
    }

    /// Records an event at a vertex of a path; if events are not recorded, `what` is not called.
    #[inline]
    pub fn note_vertex(&mut self, depth: u32, what: impl FnOnce() -> (PathVertex, String)) {
        if let Some(events) = self.events() {
            let (vertex, what) = what();
            events.push(Event { depth, what, vertex: Some(vertex) });
        }
    }
}

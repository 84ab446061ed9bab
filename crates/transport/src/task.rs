//! What an integrator works with while it looks at one sample.

use crate::bidirectional::Photons;
use crate::emission::Emission;
use crate::light_choice::LightChoice;
use crate::sampler::PixelSampler;
use bilux_math::Rgb;
use bilux_scene::{Camera, Scene, Tracer, Wavelength};

/// One sample's tools: whom to ask for hits, where random numbers come from, how long paths may be.
pub struct Task<'a, 's> {
    /// Answers rays, and counts them.
    pub tracer: &'a mut Tracer<'s>,
    /// The random numbers of this sample.
    pub sampler: PixelSampler,
    /// That of this sample's paths, wherever they begin.
    pub wavelength: Wavelength,
    /// Greatest number of scattering events after the camera; 0 is emission only.
    pub max_depth: u32,
    /// Where rays come from.
    pub camera: &'a dyn Camera,
    /// Picks lights by what they give.
    pub lights: &'a LightChoice,
    /// Where light paths begin.
    pub emission: &'a Emission,
    /// What the light paths of this iteration have left, where paths are merged.
    pub photons: Option<&'a Photons>,
    /// What happened on the way, if anybody wants to know.
    pub events: Option<Vec<Event>>,
}

/// Something that happened to a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Scattering events before it.
    pub depth: u32,
    /// What happened, for people.
    pub what: String,
}

impl<'s> Task<'_, 's> {
    /// The scene.
    pub fn scene(&self) -> &'s Scene {
        self.tracer.scene
    }

    /// What the channels see of light that a whole path brings: once a surface has [split](bilux_scene::Bsdf::splits) it,
    /// it is of one wavelength.
    #[inline]
    pub fn seen(&self, light: Rgb, is_split: bool) -> Rgb {
        if is_split { light * self.wavelength.weight } else { light }
    }

    /// Notes what happens, if anybody wants to know; else nothing is made.
    #[inline]
    pub fn note(&mut self, depth: u32, what: impl FnOnce() -> String) {
        if let Some(events) = &mut self.events {
            events.push(Event { depth, what: what() });
        }
    }
}

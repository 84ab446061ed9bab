//! Settings of a render: everything apart from scene, camera and integrator.

use crate::film::error::RenderError;
use crate::film::exposure::Exposure;
use crate::film::filters::Filter;
use crate::film::limits::{DEFAULT_MAX_DEPTH, MAX_DEPTH, MAX_SAMPLES};
use crate::film::splat_bounds::SplatBounds;
use crate::film::window::Window;
use bilux_math::Vec2;
use bilux_math::parallel::{self, ThreadPool};
use bilux_scene::Scene;
use std::ops::Range;
use std::time::Duration;

/// Enough for ray trees as deep as [`MAX_DEPTH`].
const STACK_BYTES: usize = 16 << 20;

/// Settings of a render, apart from scene, camera and integrator.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// Width of the whole film in pixels.
    pub width: u32,
    /// Height of the whole film in pixels.
    pub height: u32,
    /// Total number of samples per pixel.
    pub spp: u32,
    /// The range of them to take now.
    pub samples: Range<u32>,
    /// The pixels to render; `None` for all.
    pub crop: Option<Window>,
    /// A different seed gives different noise.
    pub seed: u64,
    /// Number of threads; 0 for one per core.
    pub threads: usize,
    /// Maximum number of scattering events after the camera; those inside skin, milk and the like do not count. 0 is emission only.
    pub max_depth: u32,
    /// Point of a pixel where its central sample lies.
    pub pixel_anchor: PixelAnchor,
    /// Spread of samples around the pixel's centre.
    pub filter: Filter,
    /// Count nodes and triangle tests, not only rays.
    pub count_work: bool,
    /// Conditions that may end the picture before all samples are taken.
    pub stop: Stop,
    /// Take samples in independent replicates, which show how far their mean may be off ([`crate::Rendered::interval`]). These
    /// are different samples, a little less evenly distributed.
    pub interval: bool,
    /// Estimate the variance of each pixel ([`crate::Rendered::batch_means`]), which denoisers need.
    pub batch_means: bool,
    /// Delay of the last row of pixels after the first, in seconds. The shutter of the scene is open while any row is
    /// exposed, and longer than that.
    pub readout: f32,
}

/// The point that represents a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelAnchor {
    /// Centre of the pixel.
    #[default]
    Centre,
    /// Upper left corner of the pixel, at integer coordinates, as in older renderers.
    Corner,
}

impl PixelAnchor {
    /// Distance of the point from the pixel's left and upper edge, in pixels.
    #[inline]
    pub(crate) fn offset(self) -> f32 {
        match self {
            PixelAnchor::Centre => 0.5,
            PixelAnchor::Corner => 0.0,
        }
    }
}

impl RenderSettings {
    /// All samples of a film of this size.
    pub fn new(width: u32, height: u32, spp: u32) -> RenderSettings {
        RenderSettings {
            width,
            height,
            spp,
            samples: 0..spp,
            crop: None,
            seed: 0,
            threads: 0,
            max_depth: DEFAULT_MAX_DEPTH,
            pixel_anchor: PixelAnchor::Centre,
            filter: Filter::default(),
            count_work: false,
            stop: Stop::default(),
            interval: false,
            batch_means: false,
            readout: 0.0,
        }
    }

    pub(crate) fn window(&self) -> Window {
        self.crop.unwrap_or(Window::whole(self.width, self.height))
    }

    /// Times at which the film's rows are exposed.
    pub(crate) fn exposure(&self, scene: &Scene) -> Exposure {
        Exposure::new(scene.shutter(), self.readout, self.height)
    }

    /// Bounds of splats on the whole film.
    pub(crate) fn splat_bounds(&self) -> SplatBounds {
        let (size, anchor) = (Vec2::new(self.width as f32, self.height as f32), self.pixel_anchor.offset());
        let radius = Vec2::splat(self.filter.radius());
        let [first, last] = [Vec2::splat(anchor), size - Vec2::ONE + Vec2::splat(anchor)];
        SplatBounds { min: (first - radius) / size, max: (last + radius) / size }
    }

    /// The settings that choosing integrators see: the choice is the same with an interval and without, and with a limit of noise or time.
    pub(crate) fn for_planning(&self) -> RenderSettings {
        RenderSettings { interval: false, batch_means: false, stop: Stop::default(), ..self.clone() }
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let Range { start, end } = self.samples;
        let spp = self.spp;
        if start >= end || end > spp || spp > MAX_SAMPLES {
            return Err(RenderError::Samples { start, end, spp });
        }
        if self.stop.is_any() && (self.crop.is_some() || self.samples != (0..spp)) {
            return Err(RenderError::StopOfPart);
        }
        if self.max_depth > MAX_DEPTH {
            return Err(RenderError::Depth { depth: self.max_depth });
        }
        Ok(())
    }
}

/// Conditions that end a picture before all of its samples are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// The noise that is low enough: see [`crate::schedule::stop::Reached::noise`].
    pub noise: Option<f32>,
    /// The time that may pass.
    pub time_limit: Option<Duration>,
}

impl Stop {
    /// True when anything may end the picture early.
    pub fn is_any(&self) -> bool {
        *self != Stop::default()
    }
}

/// A pool of the requested number of threads.
pub(crate) fn threads(settings: &RenderSettings) -> Result<ThreadPool, RenderError> {
    parallel::pool(settings.threads, Some(STACK_BYTES))
        .map_err(|e| RenderError::Threads { threads: settings.threads, reason: e.to_string() })
}

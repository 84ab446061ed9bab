//! The tile loop: every sample of every pixel, on all cores, into one film.

use crate::bidirectional::Photons;
use crate::camera_rays::CameraRays;
use crate::error::RenderError;
use crate::film::{Film, MAX_SAMPLES, scale_exponent};
use crate::filters::Filter;
use crate::batch_means::BatchMeans;
use crate::integrators::PixelIntegrator;
use crate::interval::Interval;
use crate::passes::{all_passes, passes};
use crate::plan::{Choice, Plan};
use crate::splats::IterationSplats;
use crate::stop::{Reached, Stop, StopMonitor};
use crate::window::Window;
use bilux_accel::Counters;
use bilux_scene::{Camera, Scene};
use std::ops::Range;
use std::time::Instant;

/// Scattering events after the camera where nothing else is said.
pub const DEFAULT_MAX_DEPTH: u32 = 16;

/// The greatest depth that may be asked for.
pub const MAX_DEPTH: u32 = 1000;

/// Side of a tile, in pixels.
pub(crate) const TILE: u32 = 16;

/// Enough for trees of rays as deep as [`MAX_DEPTH`].
const STACK_BYTES: usize = 16 << 20;

/// What is to be rendered, apart from scene, camera and integrator.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// Pixels across the whole film.
    pub width: u32,
    /// Pixels down the whole film.
    pub height: u32,
    /// Samples of each pixel in all.
    pub spp: u32,
    /// Which of them are to be taken now.
    pub samples: Range<u32>,
    /// Which pixels; `None` for all.
    pub crop: Option<Window>,
    /// Another seed gives other noise.
    pub seed: u64,
    /// How many threads; 0 for one each core.
    pub threads: usize,
    /// Greatest number of scattering events after the camera; 0 is emission only.
    pub max_depth: u32,
    /// Where in a pixel its middle sample lies.
    pub pixel_anchor: PixelAnchor,
    /// How samples spread around the pixel's middle.
    pub filter: Filter,
    /// Count nodes and triangle tests, not only rays.
    pub count_work: bool,
    /// What may end it before all samples are taken.
    pub stop: Stop,
    /// Take samples in independent replicates, which tell how far their mean may be off ([`Rendered::interval`]). These are
    /// other samples, a little less evenly spread.
    pub interval: bool,
    /// Estimate the variance of each pixel ([`Rendered::batch_means`]), which denoisers need.
    pub batch_means: bool,
}

/// Which point stands for a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelAnchor {
    /// Its middle.
    #[default]
    Centre,
    /// Its upper left corner, at integer coordinates, as older renderers have it.
    Corner,
}

impl RenderSettings {
    /// Every sample of a film of this size.
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
        }
    }

    pub(crate) fn window(&self) -> Window {
        self.crop.unwrap_or(Window::whole(self.width, self.height))
    }

    /// How many samples an integrator takes: of those that follow light from its sources, all that the whole film has,
    /// whatever part of it is wanted, since the light of any may land there.
    pub fn sample_count(&self, integrator: &dyn PixelIntegrator) -> u64 {
        self.walked(integrator).pixels() as u64 * self.samples.len() as u64
    }

    /// The pixels whose samples are taken.
    fn walked(&self, integrator: &dyn PixelIntegrator) -> Window {
        if integrator.splats() { Window::whole(self.width, self.height) } else { self.window() }
    }

    /// As integrators that choose see them: the choice is the same with an interval and without.
    pub(crate) fn as_planned(&self) -> RenderSettings {
        RenderSettings { interval: false, batch_means: false, ..self.clone() }
    }

    /// The samples to be taken, cut into batches where their variance is to be estimated.
    fn batches(&self) -> Vec<Range<u32>> {
        let Range { start, end } = self.samples;
        if !self.batch_means {
            return vec![start..end];
        }
        let ends = (start + 1..end).filter(|&sample| BatchMeans::ends_at(sample - start)).chain([end]);
        ends.scan(start, |first, end| Some(std::mem::replace(first, end)..end)).collect()
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

/// Whom to tell how far it is, and who may stop it. Called from many threads, about once for each tile.
pub trait Progress: Sync {
    /// So many samples and rays more.
    fn advance(&self, samples: u64, rays: u64);
    /// So many samples are going to be taken.
    fn begin(&self, _samples: u64) {}
    /// True when the work is to stop; what is finished is kept.
    fn is_cancelled(&self) -> bool;
}

/// Nobody to tell, and nobody to stop it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn advance(&self, _samples: u64, _rays: u64) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The film; [`Film::trouble`] tells of samples that went wrong.
    pub film: Film,
    /// What the rays took; only `rays` unless [`RenderSettings::count_work`] was on.
    pub counters: Counters,
    /// True when it was stopped. Then [`Film::coverage`] tells which samples are in; each is there whole.
    pub cancelled: bool,
    /// What an integrator that chooses has chosen.
    pub choice: Option<Choice>,
    /// How far it came, where it could end early ([`RenderSettings::stop`]).
    pub reached: Option<Reached>,
    /// Between which bounds pixels lie, where it was asked for ([`RenderSettings::interval`]): of whole iterations, also
    /// where it was stopped.
    pub interval: Option<Interval>,
    /// Batches of samples, which give the variance of each pixel, where it was asked for ([`RenderSettings::batch_means`]).
    pub batch_means: Option<BatchMeans>,
}

/// Renders the samples asked for.
///
/// # Errors
/// When the size, crop, range of samples or depth makes no sense, or the machine gives no room or threads.
pub fn render(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Rendered, RenderError> {
    settings.check()?;
    let begun = Instant::now();
    let scale = scale_exponent(scene);
    let film = Film::windowed(settings.width, settings.height, settings.window(), scale)?;
    let pool = threads(settings)?;
    let plan = pool.install(|| integrator.plan(scene, camera, &settings.as_planned()));
    let (choice, planned, counters) = match plan {
        Some(Plan { choice, integrator, counters }) => (Some(choice), Some(integrator), counters),
        None => (None, None, Counters::default()),
    };
    let integrator = planned.as_deref().unwrap_or(integrator);
    if settings.interval && !integrator.is_random() {
        return Err(RenderError::IntervalOfPattern);
    }
    progress.begin(settings.sample_count(integrator));
    let run = Run { scene, camera, integrator, settings, progress, pool, scale };
    let mut interval = settings.interval.then(|| Interval::new(settings.window())).transpose()?;
    let mut take = |samples: &Range<u32>, rendered| match &mut interval {
        Some(interval) => run.take_each(samples, interval, rendered),
        None => run.take(samples, rendered),
    };
    let mut rendered = Rendered {
        film,
        counters,
        cancelled: false,
        choice,
        reached: None,
        interval: None,
        batch_means: None,
    };
    let mut batches = settings.batch_means.then(BatchMeans::default);
    if settings.stop.is_any() {
        let mut watch = StopMonitor::new(settings, begun.elapsed());
        while !rendered.cancelled
            && let Some(samples) = watch.next()
        {
            rendered = take(&samples, rendered)?;
            if !rendered.cancelled {
                watch.look(&rendered.film, &samples);
                if let Some(batches) = batches.as_mut().filter(|_| BatchMeans::ends_at(watch.done)) {
                    batches.close(&rendered.film, watch.done);
                }
                progress.begin(settings.walked(integrator).pixels() as u64 * u64::from(watch.expected()));
            }
        }
        rendered.reached = watch.reached;
        if let Some(batches) = batches.as_mut().filter(|_| !rendered.cancelled) {
            batches.close(&rendered.film, watch.done);
        }
    } else {
        for samples in settings.batches() {
            rendered = take(&samples, rendered)?;
            if rendered.cancelled {
                break;
            }
            if let Some(batches) = &mut batches {
                batches.close(&rendered.film, samples.end - settings.samples.start);
            }
        }
    }
    Ok(Rendered { interval, batch_means: batches, ..rendered })
}

/// All that stays the same while a picture is rendered.
struct Run<'a> {
    scene: &'a Scene,
    camera: &'a dyn Camera,
    integrator: &'a dyn PixelIntegrator,
    settings: &'a RenderSettings,
    progress: &'a dyn Progress,
    pool: rayon::ThreadPool,
    scale: i32,
}

impl<'a> Run<'a> {
    fn eye(&self) -> CameraRays<'a> {
        CameraRays::new(self.scene, self.camera, self.integrator, self.settings)
    }

    /// Adds some samples of every pixel.
    fn take(&self, samples: &Range<u32>, mut rendered: Rendered) -> Result<Rendered, RenderError> {
        let (pool, settings) = (&self.pool, self.settings);
        let tiles = settings.walked(self.integrator).tiles(TILE);
        let Some(merging) = self.integrator.merging() else {
            return all_passes(pool, self.eye(), tiles, passes(samples), self.progress, rendered);
        };
        let whole = Window::whole(settings.width, settings.height).tiles(TILE);
        for iteration in samples.clone() {
            let mut eye = self.eye();
            let shown =
                merging.shows_photons().then(|| IterationSplats::new(settings, self.scale, whole.len()));
            let shown = shown.transpose()?;
            let techniques = |eta, light_paths| merging.techniques(eta, light_paths);
            let (photons, counters) =
                pool.install(|| Photons::trace(&eye, merging, &whole, iteration, techniques, shown.as_ref()));
            rendered.counters += counters;
            eye.photons = Some(&photons);
            let pass = passes(&(iteration..iteration + 1));
            rendered = all_passes(pool, eye, tiles.clone(), pass, self.progress, rendered)?;
            if rendered.cancelled {
                break;
            }
            if let Some(shown) = shown {
                rendered.film.add_iterations(&shown.into_iterations(), 1)?;
            }
        }
        Ok(rendered)
    }

    /// The same, one sample after the other, so that each gets into its replicate.
    fn take_each(
        &self,
        samples: &Range<u32>,
        interval: &mut Interval,
        mut rendered: Rendered,
    ) -> Result<Rendered, RenderError> {
        for sample in samples.clone() {
            let (settings, window) = (self.settings, self.settings.window());
            let empty = Film::windowed(settings.width, settings.height, window, self.scale)?;
            let before = std::mem::replace(&mut rendered.film, empty);
            rendered = self.take(&(sample..sample + 1), rendered)?;
            let one = std::mem::replace(&mut rendered.film, before);
            rendered.film.merge(&one)?;
            if rendered.cancelled {
                break;
            }
            interval.add(sample, &one);
        }
        Ok(rendered)
    }
}

/// As many as are wanted.
pub(crate) fn threads(settings: &RenderSettings) -> Result<rayon::ThreadPool, RenderError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|e| RenderError::Threads { threads: settings.threads, reason: e.to_string() })
}

//! How the light along a camera ray is estimated. One integrator per file; the table is [`INTEGRATORS`].

mod auto;
mod bdpt;
mod cast;
mod cook;
mod light;
mod merging;
mod occlusion;
pub(crate) mod path;
mod sppm;
mod vcm;
mod whitted;

use crate::bidirectional::{BothEnds, Merging, Photons};
use crate::emission::Guide;
use crate::plan::Plan;
use crate::settings::RenderSettings;
use crate::splats::{Splats, Sum};
use crate::strategies::Layers;
use crate::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{Camera, Ray, Reader, Scene, SceneError, Spec};
use path::Path;
use std::sync::Arc;

/// Estimates the light along camera rays; [`crate::render()`] handles pixels, tiles and threads.
pub trait PixelIntegrator: Send + Sync {
    /// Radiance (in the classic modes: intensity) that arrives along a camera ray, as far as the integrator finds it
    /// from the camera.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb;

    /// True when it also traces light subpaths, which may contribute anywhere on the film.
    fn splats(&self) -> bool {
        false
    }

    /// How it merges camera subpaths with light subpaths. Each sample of all pixels is then an iteration, which begins
    /// with the light subpaths of all pixels ([`Task::photons`]).
    fn merging(&self) -> Option<&Merging> {
        None
    }

    /// The guide that aims its light subpaths, if there is one.
    fn guide(&self) -> Option<Arc<Guide>> {
        None
    }

    /// When Russian roulette begins on the light subpaths of an iteration.
    fn roulette_depth(&self) -> u32 {
        0
    }

    /// The integrator that renders in its place, if this one chooses: by scene, camera and the film's settings,
    /// whatever samples and pixels are requested.
    fn plan(&self, _scene: &Scene, _camera: &dyn Camera, _film: &RenderSettings) -> Option<Plan> {
        None
    }

    /// Takes a sample of a pixel: [`PixelIntegrator::radiance`] where it `is_wanted` (pixels outside the crop trace
    /// only their light subpaths), and all splats.
    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        match self.both_ends(task.photons) {
            Some(both_ends) => {
                let mut sum = Sum { here: Rgb::BLACK, splats };
                both_ends.sample(ray, is_wanted, task, &mut sum);
                sum.here
            }
            None if is_wanted => self.radiance(ray, task),
            None => Rgb::BLACK,
        }
    }

    /// True when it has techniques that can be rendered separately ([`crate::strategies()`]).
    fn has_strategies(&self) -> bool {
        self.both_ends(None).is_some()
    }

    /// The same sample as [`PixelIntegrator::sample`], technique by technique.
    fn sample_strategies(&self, ray: &Ray, is_wanted: bool, task: &mut Task, layers: &mut Layers) {
        if let Some(both_ends) = self.both_ends(task.photons) {
            both_ends.showing().sample(ray, is_wanted, task, layers);
        }
    }

    /// The subpaths from both ends that its samples consist of, if they do. Many of them can be followed at once.
    #[doc(hidden)]
    fn both_ends<'a>(&self, _photons: Option<&'a Photons>) -> Option<BothEnds<'a>> {
        None
    }

    /// The path tracer that this integrator is, which can follow many paths at once.
    #[doc(hidden)]
    fn as_path(&self) -> Option<&Path> {
        None
    }

    /// True when its samples can be taken in independent replicates ([`RenderSettings::interval`]).
    fn is_random(&self) -> bool {
        self.camera_spread().pixel > 0.0
    }

    /// How far samples spread over pixel, lens and shutter.
    fn camera_spread(&self) -> CameraSpread {
        CameraSpread::FULL
    }
}

/// How far samples spread, each 0..=1 of what filter, aperture and shutter allow. With 0, pixels are sampled in a
/// regular pattern that begins at the centre, and lens and shutter in their middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSpread {
    /// Over the pixel's filter.
    pub pixel: f32,
    /// Over the lens.
    pub lens: f32,
    /// Over the time that the shutter is open.
    pub shutter: f32,
}

impl CameraSpread {
    /// Full spread.
    pub const FULL: CameraSpread = CameraSpread { pixel: 1.0, lens: 1.0, shutter: 1.0 };
    /// No spread.
    pub const NONE: CameraSpread = CameraSpread { pixel: 0.0, lens: 0.0, shutter: 0.0 };
}

/// A row of [`INTEGRATORS`].
#[derive(Clone, Copy, Debug)]
pub struct IntegratorEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// The paths from light (L) to eye (E) that it finds, in the notation of [Heckbert 1990]: D for diffuse, G for
    /// glossy and S for specular scattering.
    pub covers: &'static str,
    /// True for Equations 1 and 2, whose intensities have no units; false for radiometry.
    pub classic: bool,
    /// Default number of samples per pixel.
    pub default_spp: u32,
    /// Builds an integrator from its parameters.
    pub build: fn(&Reader) -> Result<Box<dyn PixelIntegrator>, SceneError>,
}

/// When Russian roulette begins, for all integrators that use it.
const ROULETTE_DEPTH: Parameter = Parameter {
    name: "roulette_depth",
    summary: "number of scattering events before Russian roulette starts",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: 1000 },
    default: "4",
};

/// All integrators.
pub const INTEGRATORS: &[IntegratorEntry] = &[
    auto::ENTRY,
    cast::ENTRY,
    whitted::ENTRY,
    cook::ENTRY,
    path::ENTRY,
    light::ENTRY,
    bdpt::ENTRY,
    sppm::ENTRY,
    vcm::ENTRY,
    occlusion::ENTRY,
];

/// The row with this name.
///
/// # Errors
/// When there is none.
pub fn find(name: &str) -> Result<&'static IntegratorEntry, SceneError> {
    find_at(name, &Default::default())
}

/// Builds the integrator that a spec describes.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn build(spec: &Spec) -> Result<Box<dyn PixelIntegrator>, SceneError> {
    let row = find_at(&spec.kind, &spec.span)?;
    (row.build)(&Reader::new(spec, &row.entry)?)
}

/// Names of the integrators whose techniques can be rendered separately.
pub fn with_strategies() -> impl Iterator<Item = &'static str> {
    let has_them = |name: &&str| build(&Spec::new("", name)).is_ok_and(|one| one.has_strategies());
    INTEGRATORS.iter().map(|row| row.entry.name).filter(has_them)
}

fn find_at(name: &str, span: &bilux_scene::parameters::Span) -> Result<&'static IntegratorEntry, SceneError> {
    let names = INTEGRATORS.iter().map(|row| row.entry.name);
    INTEGRATORS
        .iter()
        .find(|row| row.entry.name == name)
        .ok_or_else(|| SceneError::unknown("integrator", name, names, span))
}

//! Light transport: samplers, the film, tiles, and one file per integrator.
//!
//! An integrator ([`INTEGRATORS`]) estimates the radiance along a ray; [`render()`] calls it for every sample of every
//! pixel and accumulates the [`Film`]. With a fixed number of samples the film is a pure function of scene, settings
//! and seed: the bytes are the same for any number of threads, any crop, and any split into sample ranges.

mod bidirectional;
#[cfg(test)]
extern crate self as bilux_transport;
pub mod checkpoint;
mod classic;
pub mod daylight;
pub mod film;
pub mod integrators;
pub mod labels;
pub mod lidar;
mod light;
mod media;
mod passes;
mod path_tracing;
mod photons;
mod queue;
mod sampling;
mod schedule;
#[cfg(test)]
#[path = "../tests/suite/common/mod.rs"]
mod shapes;
mod techniques;
mod walk;

pub use checkpoint::{Checkpoint, Observer, Standing, Unobserved};
pub use daylight::{DaylightCoefficients, PartOfSky, SkyPatches, daylight_coefficients, sunlight};
pub use film::batch_means::{BatchMeans, push_variance};
pub use film::error::{FilmError, RenderError};
pub use film::failures::{SampleFailures, SamplePlace};
pub use film::filters::{FILTERS, Filter, FilterEntry};
pub use film::interval::{Estimate, Interval, REPLICATES};
pub use film::limits::{DEFAULT_MAX_DEPTH, MAX_DEPTH};
pub use film::merged_layers::MergedLayers;
pub use film::window::{Coverage, Window};
pub use film::{Film, scale_exponent};
pub use film::{aovs, filters};
pub use integrators::pixel_integrator::{Chooser, LightSubpaths, PixelIntegrator, Plan};
pub use integrators::{INTEGRATORS, IntegratorEntry};
pub use labels::labels;
pub use light::choice::LightChoice;
pub use light::emission::{Emission, Guide};
pub use passes::completion::Completion;
pub use passes::features::{FEATURE_SAMPLES, Features, coverage, features};
pub use passes::illumination::{Illumination, illumination};
pub use passes::layers::Strategy;
pub use passes::light_parts::{LightDivision, LightParts, light_parts};
pub use passes::mattes::mattes;
pub use passes::receiving::{Received, received};
pub use passes::render::{plan, render, render_from};
pub use passes::replay::{Contributed, Replay, replay};
pub use passes::shadow_catcher::{ShadowCatcher, shadow_alpha, shadow_alpha_time};
pub use passes::strategies::{Strategies, StrategyPicture, strategies};
pub use passes::work::{Work, work};
pub use passes::{mattes, strategies};
pub use photons::{Merging, Photons};
pub use sampling::camera_rays::CameraSpread;
pub use sampling::sampler::PixelSampler;
pub use sampling::splats::Splats;
pub use sampling::task::{Context, Event, FoundLight, PathVertex, Record, SampleState, Task, VertexKind};
pub use schedule::gathering::{Division, Gathering, Part};
pub use schedule::plan::{Candidate, Choice};
pub use schedule::progress::{Progress, Silent};
pub use schedule::rendered::Rendered;
pub use schedule::settings::{PixelAnchor, RenderSettings, Stop};
pub use schedule::stop::{NoiseMeter, Reached};
pub use techniques::optical_path::LengthBins;

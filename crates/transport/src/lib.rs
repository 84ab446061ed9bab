//! Light transport: samplers, the film, tiles, and one file per integrator.
//!
//! An integrator ([`INTEGRATORS`]) estimates the radiance along a ray; [`render()`] calls it for every sample of every
//! pixel and accumulates the [`Film`]. With a fixed number of samples the film is a pure function of scene, settings
//! and seed: the bytes are the same for any number of threads, any crop, and any split into sample ranges.

pub mod aovs;
mod ball;
mod batch_means;
mod beam;
mod bidirectional;
mod bytes;
#[cfg(test)]
extern crate self as bilux_transport;
mod camera_rays;
pub mod checkpoint;
mod classic;
pub mod emission;
mod equiangular;
mod error;
mod failures;
pub mod features;
pub mod film;
mod film_bytes;
pub mod filters;
pub mod gathering;
pub mod illumination;
pub mod integrators;
mod interaction;
pub mod interval;
mod labels;
mod layers;
mod light_choice;
pub mod light_parts;
pub mod limits;
mod media;
mod merged_layers;
mod mis;
pub mod partial;
mod passes;
mod path_tracing;
mod photon_beams;
mod photon_grid;
mod photon_tracing;
mod photons;
mod pixel_integrator;
pub mod plan;
mod progress;
mod queue;
pub mod render;
mod rendered;
pub mod replay;
mod sample_queue;
pub mod sampler;
mod schedule;
mod segment;
pub mod settings;
pub mod shadow_catcher;
mod shadow_rays;
#[cfg(test)]
#[path = "../tests/suite/common/mod.rs"]
mod shapes;
mod sight;
mod splats;
pub mod stop;
pub mod strategies;
mod task;
mod techniques;
mod through;
pub mod visible;
mod walk;
pub mod window;
pub mod work;

pub use batch_means::{BatchMeans, push_variance};
pub use camera_rays::CameraSpread;
pub use checkpoint::{Checkpoint, Observer, Standing, Unobserved};
pub use emission::{Emission, Guide};
pub use error::{FilmError, RenderError};
pub use failures::{SampleFailures, SamplePlace};
pub use features::{FEATURE_SAMPLES, Features, coverage, features};
pub use film::{Film, scale_exponent};
pub use filters::{FILTERS, Filter, FilterEntry};
pub use gathering::{Division, Gathering, Part};
pub use illumination::{Illumination, illumination};
pub use integrators::{INTEGRATORS, IntegratorEntry};
pub use interval::{Estimate, Interval, REPLICATES};
pub use layers::Strategy;
pub use light_choice::LightChoice;
pub use light_parts::{LightDivision, LightParts, light_parts};
pub use limits::{DEFAULT_MAX_DEPTH, MAX_DEPTH};
pub use merged_layers::MergedLayers;
pub use photons::{Merging, Photons};
pub use pixel_integrator::{Chooser, LightSubpaths, PixelIntegrator, Plan};
pub use plan::{Candidate, Choice};
pub use progress::{Progress, Silent};
pub use render::{plan, render, render_from};
pub use rendered::Rendered;
pub use replay::{Contributed, Replay, replay};
pub use sampler::PixelSampler;
pub use settings::{PixelAnchor, RenderSettings, Stop};
pub use shadow_catcher::{ShadowCatcher, shadow_alpha, shadow_alpha_time};
pub use splats::Splats;
pub use stop::{NoiseMeter, Reached};
pub use strategies::{Strategies, StrategyPicture, strategies};
pub use task::{Context, Event, FoundLight, PathVertex, Record, SampleState, Task, VertexKind};
pub use visible::{Visible, visible};
pub use window::{Coverage, Window};
pub use work::{Work, work};

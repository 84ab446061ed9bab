//! A picture rendered in parts, by several processes or machines, that is the same to the bit as one rendered at once.
//!
//! One process, the driver, has a [`Gathering`], which says what is to be rendered next. Others have a [`Job`] of the same
//! scene and settings, and render those parts. What `auto` chooses, it chooses for each job anew, and always the same.
//!
//! ```
//! use bilux::parts;
//! use bilux::prelude::*;
//! use bilux::transport::Division;
//!
//! let scene = bilux::generate(&Spec::new("", "cornell"))?;
//! let job = Job::new(&scene, JobRequest::new().size(16, 16).spp(8))?;
//! let division = Division { workers: 2, threads: 1, may_crop: parts::may_crop(&job)? };
//! let mut gathering = parts::gathering(&job, division)?;
//! while let Some(part) = gathering.next_part() {
//!     let done = parts::render(&job, &part, &Quiet)?;
//!     gathering.add(&part, done.film, done.rays)?;
//! }
//! let outcome = parts::gathered(&job, gathering, &Quiet)?;
//! assert_eq!(outcome.picture()?, job.render(&Quiet)?.picture()?);
//! # Ok::<(), bilux::Error>(())
//! ```

use crate::{Error, Job, Outcome};
use bilux_transport::{
    Division, Film, Gathering, Part, PixelIntegrator, Progress, RenderSettings, Stop, scale_exponent,
};
use std::time::Instant;

/// A part of a picture.
pub struct PartOutcome {
    /// The film of its samples, with the fingerprint of the picture.
    pub film: Film,
    /// The rays that they took.
    pub rays: u64,
    /// Whether it was stopped: then it holds only some of its samples.
    pub cancelled: bool,
}

/// Whether parts may be windows of the picture. Integrators that trace light subpaths take all of them for each window.
///
/// # Errors
/// If there are no threads.
pub fn may_crop(job: &Job) -> Result<bool, Error> {
    let integrator = planned(job)?;
    Ok(!integrator.splats() && integrator.merging().is_none())
}

/// Renders a part of the picture, without regard to limits of noise and time.
///
/// # Errors
/// If the part is not within the picture, or memory is short.
pub fn render(job: &Job, part: &Part, progress: &dyn Progress) -> Result<PartOutcome, Error> {
    let settings = RenderSettings {
        samples: part.samples.clone(),
        crop: Some(part.window),
        stop: Stop::default(),
        batch_means: false,
        ..job.render.clone()
    };
    let rendered = bilux_transport::render(job.scene(), job.camera(), planned(job)?, &settings, progress)?;
    let mut film = rendered.film;
    job.fingerprint().clone_into(&mut film.fingerprint);
    Ok(PartOutcome { film, rays: rendered.counters.rays, cancelled: rendered.cancelled })
}

/// Begins to gather a picture from its parts.
///
/// # Errors
/// If the job is a crop or has an interval.
pub fn gathering(job: &Job, division: Division) -> Result<Gathering, Error> {
    let aside = job.time_aside(Instant::now())?;
    Ok(Gathering::new(&job.render, scale_exponent(job.scene()), job.fingerprint(), division, aside)?)
}

/// The gathered picture, with its layers, as [`Job::render`] gives it. If it is not done, it has all samples so far, and
/// counts as cancelled.
///
/// # Errors
/// If memory is short.
pub fn gathered(job: &Job, gathering: Gathering, progress: &dyn Progress) -> Result<Outcome, Error> {
    let surfaces = job.surfaces_within(job.render.stop.time_limit, progress)?;
    job.completed(gathering.finish()?, surfaces)
}

/// The integrator that renders, once one that chooses has chosen.
fn planned(job: &Job) -> Result<&dyn PixelIntegrator, Error> {
    job.plan()?;
    Ok(job.renders())
}

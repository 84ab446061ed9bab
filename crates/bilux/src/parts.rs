//! A picture rendered in parts, by several processes or machines, that is the same to the bit as one rendered at once.
//!
//! One process, the driver, has a [`Gathering`], which says what is to be rendered next. Others have a [`Job`] of the same
//! scene and settings, and render those parts. What `auto` chooses, it chooses for each job anew, and always the same.
//!
//! ```
//! use bilux::prelude::*;
//! use bilux::transport::Division;
//!
//! let scene = bilux::generate(&Spec::new("", "cornell"))?;
//! let job = Job::new(&scene, JobRequest::new().size(16, 16).spp(8))?;
//! let division = Division { workers: 2, threads: 1, may_crop: job.may_crop_parts()? };
//! let mut gathering = job.gathering(division)?;
//! while let Some(part) = gathering.next_part() {
//!     let done = job.part(&part, &Quiet)?;
//!     gathering.add(&part, done.film, done.rays)?;
//! }
//! let outcome = job.gathered(gathering, &Quiet)?;
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
    /// Its samples, with the fingerprint of the picture.
    pub film: Film,
    /// The rays that they took.
    pub rays: u64,
    /// Whether it was stopped: then it holds only some of its samples.
    pub cancelled: bool,
}

impl Job {
    /// The integrator that renders, once one that chooses has chosen.
    fn planned(&self) -> Result<&dyn PixelIntegrator, Error> {
        Ok(self.plan()?.map_or(self.integrator(), |plan| &*plan.integrator))
    }

    /// What was chosen, as text, if the integrator is one that chooses.
    ///
    /// # Errors
    /// If there are no threads.
    pub fn choice(&self) -> Result<Option<String>, Error> {
        Ok(self.plan()?.map(|plan| plan.choice.to_string()))
    }

    /// Whether parts may be windows of the picture. Integrators that trace light subpaths take all of them for each
    /// window.
    ///
    /// # Errors
    /// If there are no threads.
    pub fn may_crop_parts(&self) -> Result<bool, Error> {
        let integrator = self.planned()?;
        Ok(!integrator.splats() && integrator.merging().is_none())
    }

    /// Renders a part of the picture, without regard to limits of noise and time.
    ///
    /// # Errors
    /// If the part is not within the picture, or memory is short.
    pub fn part(&self, part: &Part, progress: &dyn Progress) -> Result<PartOutcome, Error> {
        let settings = RenderSettings {
            samples: part.samples.clone(),
            crop: Some(part.window),
            stop: Stop::default(),
            batch_means: false,
            ..self.render.clone()
        };
        let integrator = self.planned()?;
        let rendered = bilux_transport::render(self.scene(), self.camera(), integrator, &settings, progress)?;
        let mut film = rendered.film;
        self.fingerprint().clone_into(&mut film.fingerprint);
        Ok(PartOutcome { film, rays: rendered.counters.rays, cancelled: rendered.cancelled })
    }

    /// Begins to gather the picture from its parts.
    ///
    /// # Errors
    /// If the job is a crop or has an interval.
    pub fn gathering(&self, division: Division) -> Result<Gathering, Error> {
        let scale = scale_exponent(self.scene());
        let aside = self.time_aside(Instant::now())?;
        Ok(Gathering::new(&self.render, scale, self.fingerprint(), division, aside)?)
    }

    /// The gathered picture, with its layers, as [`Job::render`] gives it. If it is not done, it has all samples so far,
    /// and counts as cancelled.
    ///
    /// # Errors
    /// If memory is short.
    pub fn gathered(&self, gathering: Gathering, progress: &dyn Progress) -> Result<Outcome, Error> {
        let limit = self.render.stop.time_limit;
        let features = self.features_within(limit, progress)?;
        self.completed(gathering.finish()?, features)
    }
}

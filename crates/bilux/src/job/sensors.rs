//! Light that points of a job's scene receive, instead of its picture.

use super::Job;
use crate::Error;
use bilux_math::Vec3;
use bilux_scene::cameras::SensorPoints;
use bilux_transport::{
    DaylightCoefficients, Filter, PartOfSky, Progress, Received, RenderSettings, SkyPatches,
};

/// Bytes that a point takes while its light is measured.
const POINT: u64 = 1024;

/// Bytes that a coefficient takes, with those that do not come straight.
const PATCH: u64 = 4 * size_of::<PartOfSky>() as u64;

impl Job {
    /// [`bilux_transport::received`] by points of its scene: by the job's settings, and not by its camera. `None` if it was stopped
    /// before there was anything.
    ///
    /// # Errors
    /// If the job's integrator does not measure, or memory is short.
    pub fn received(
        &self,
        points: &SensorPoints,
        progress: &dyn Progress,
    ) -> Result<Option<Received>, Error> {
        let settings = self.settings_of(points, POINT)?;
        Ok(bilux_transport::received(self.scene(), points, self.integrator(), &settings, progress)?)
    }

    /// [`bilux_transport::daylight_coefficients`] of points, one row after the other. `None` if it was stopped.
    ///
    /// # Errors
    /// As for [`Job::received`].
    pub fn daylight_coefficients(
        &self,
        points: &SensorPoints,
        patches: &SkyPatches,
        progress: &dyn Progress,
    ) -> Result<Option<DaylightCoefficients>, Error> {
        let settings = self.settings_of(points, PATCH * patches.count() as u64)?;
        let (scene, plan) = (self.scene(), self.integrator().chooser());
        let plan = plan.map(|chooser| chooser.plan(scene, points, &settings));
        let integrator = plan.as_ref().map_or(self.integrator(), |plan| &*plan.integrator);
        Ok(bilux_transport::daylight_coefficients(scene, points, integrator, &settings, patches, progress)?)
    }

    /// [`bilux_transport::sunlight`] that reaches points from each direction, one row after the other. `None` if it was stopped.
    ///
    /// # Errors
    /// If memory is short.
    pub fn sunlight(
        &self,
        points: &SensorPoints,
        directions: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<f32>>, Error> {
        let settings = self.settings_of(points, size_of::<f32>() as u64 * directions.len() as u64)?;
        Ok(bilux_transport::sunlight(self.scene(), points, directions, &settings, progress)?)
    }

    /// Settings by which points are measured; `bytes` is the memory for one.
    fn settings_of(&self, points: &SensorPoints, bytes: u64) -> Result<RenderSettings, Error> {
        let count = points.points().len() as u64;
        let most = self.request.max_memory.unwrap_or(u64::MAX);
        if count.saturating_mul(bytes) > most {
            return Err(Error::Settings(format!(
                "{count} points would take {} MB of memory, and {} MB are allowed: measure fewer at a time",
                count.saturating_mul(bytes) >> 20,
                most >> 20
            )));
        }
        let [width, height] = points.size();
        let settings =
            RenderSettings { width, height, crop: None, filter: Filter::default(), ..self.render.clone() };
        Ok(RenderSettings { batch_means: false, ..settings })
    }
}

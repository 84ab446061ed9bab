//! Light by the time that it takes: a picture for each interval of the optical length of paths. [Jarabo 2014]

use crate::{Error, Job};
use bilux_math::Rgb;
use bilux_transport::{Film, LengthBins, LightDivision, Progress, RenderSettings, Stop, Window, light_parts};

/// A picture in intervals of length.
pub struct Transient {
    /// The pixels that it covers.
    pub window: Window,
    /// The light of each interval of each pixel, one pixel after the other in rows from the top.
    pub light: Vec<Rgb>,
    /// The light of each pixel that belongs to none: its paths are shorter or longer, or come from infinity.
    pub rest: Vec<Rgb>,
}

/// Bytes that a pixel of an interval takes, in films and in the result, and where light subpaths reach it.
const BYTES: u64 = Film::memory_bytes(1) + size_of::<Rgb>() as u64;
const SPLAT_BYTES: u64 = 3 * Film::memory_bytes(1);

impl Job {
    /// Renders the picture in intervals of the optical length of paths, in metres from where the camera's ray begins, with the same samples as
    /// [`Job::render`]: they and the rest add up to its picture. Light takes 1 s for 299,792,458 m. It takes the first `samples` of
    /// each pixel, by default all. `None` if it was stopped.
    ///
    /// # Errors
    /// If the integrator finds light whose paths have no length, the intervals make no sense, they take too much memory, or as
    /// [`Job::render`].
    pub fn transient(
        &self,
        bins: LengthBins,
        samples: Option<u32>,
        progress: &dyn Progress,
    ) -> Result<Option<Transient>, Error> {
        self.check_lengths(&bins)?;
        let mut settings = RenderSettings { stop: Stop::default(), ..self.render.clone() };
        if let Some(samples) = samples {
            (settings.spp, settings.samples) = (samples, 0..samples);
        }
        let division = LightDivision { by_length: Some(bins), ..LightDivision::default() };
        let (scene, camera) = (self.scene(), self.camera());
        let parts = light_parts(scene, camera, self.renders(), &settings, &division, progress)?;
        let Some(parts) = parts else { return Ok(None) };
        let Some((rest, intervals)) = parts.by_length.split_last() else { return Ok(None) };
        let window = rest.window();
        let places = || (0..window.pixels()).map(|i| window.position(i));
        let light = places().flat_map(|(x, y)| intervals.iter().map(move |film| film.pixel(x, y)));
        let rest = places().map(|(x, y)| rest.pixel(x, y)).collect();
        Ok(Some(Transient { window, light: light.collect(), rest }))
    }

    /// Checks, before any work, that the picture can be divided so.
    ///
    /// # Errors
    /// As [`Job::transient`].
    pub fn check_lengths(&self, bins: &LengthBins) -> Result<(), Error> {
        let name = self.settings.integrator.entry.name;
        let renders = self.renders();
        let what = if !renders.has_light_parts() || renders.merging().is_some() {
            format!("integrator: '{name}' finds light whose paths have no length here: choose path or bdpt")
        } else if !(bins.width > 0.0 && bins.width.is_finite() && bins.begin.is_finite()) {
            format!(
                "bin_width: intervals of {} m from {} m on are none: give a width above 0",
                bins.width, bins.begin
            )
        } else if bins.count == 0 {
            "bins: there is none: give at least 1".to_owned()
        } else {
            let each = if renders.splats() { BYTES + SPLAT_BYTES } else { BYTES };
            let RenderSettings { width, height, crop, .. } = self.render;
            let pixels = crop.unwrap_or(Window::whole(width, height)).pixels() as u64;
            let needed = pixels.saturating_mul(u64::from(bins.count) + 1).saturating_mul(each);
            let most = self.request.max_memory.unwrap_or(u64::MAX);
            if needed <= most {
                return Ok(());
            }
            format!(
                "bins: {} intervals of {pixels} pixels take about {} MB of memory, but only {} MB are allowed: take fewer, or \
                 a smaller picture",
                bins.count,
                needed / 1_000_000,
                most / 1_000_000
            )
        };
        Err(Error::Settings(what))
    }
}

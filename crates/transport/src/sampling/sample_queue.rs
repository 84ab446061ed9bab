//! Many samples at a time.

use crate::film::Film;
use crate::film::failures::SamplePlace;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::Splats;
use crate::schedule::progress::Progress;
use bilux_math::Rgb;
use bilux_scene::Tracer;

/// Takes many samples at a time, whose rays are traced in batches. Each finds the same light as on its own, bit for bit.
pub trait SampleQueue {
    /// Takes samples, and gives the sink what they find; false when that was cancelled on the way.
    fn take<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        places: &[SamplePlace],
        sink: &mut SampleSink,
    ) -> bool;
}

/// Receiver of the light of samples.
pub struct SampleSink<'t, 's> {
    film: &'t mut Film,
    splats: &'t mut Splats<'s>,
    progress: &'t dyn Progress,
    /// The sample whose splats come now.
    current: Option<SamplePlace>,
}

impl<'t, 's> SampleSink<'t, 's> {
    /// Light goes to a part of the film, and splats to a list of their own.
    pub(crate) fn new(
        film: &'t mut Film,
        splats: &'t mut Splats<'s>,
        progress: &'t dyn Progress,
    ) -> SampleSink<'t, 's> {
        SampleSink { film, splats, progress, current: None }
    }

    /// True when no more samples are wanted.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }

    /// False where only a light subpath is wanted, since the pixel is outside the crop.
    pub(crate) fn is_wanted(&self, SamplePlace { x, y, .. }: SamplePlace) -> bool {
        self.film.window().index(x, y).is_some()
    }

    /// Takes the light that a sample finds in its own pixel.
    #[inline]
    pub(crate) fn add(&mut self, SamplePlace { x, y, sample }: SamplePlace, light: Rgb) {
        self.film.add(x, y, sample, light);
    }

    /// Receives the splats of a sample. Those of one sample come one after the other.
    #[inline]
    pub(crate) fn splats(&mut self, place: SamplePlace) -> &mut Splats<'s> {
        if self.current != Some(place) {
            let SamplePlace { x, y, sample } = place;
            self.splats.begin(x, y, sample);
            self.current = Some(place);
        }
        self.splats
    }
}

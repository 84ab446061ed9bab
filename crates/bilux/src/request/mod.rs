//! Request for a job: its settings as Rust types, and what the settings of files cannot say.

/// Generates a method for each setting.
macro_rules! settings {
    ($($(#[$what:meta])* $key:ident: $value:ty,)*) => {
        use super::{IntoSetting, JobRequest};

impl JobRequest {
            $(
                $(#[$what])*
                #[must_use]
                pub fn $key(self, value: $value) -> JobRequest {
                    self.set(stringify!($key), value.into_setting())
                }
            )*
        }
    };
}

mod settings;

use crate::limits::memory::Memory;
use crate::settings::Settings;
use crate::{Error, Series};
use bilux_math::Vec3;
use bilux_scene::{Parameters, SceneBuilder, Value};
use bilux_transport::Window;
use bilux_transport::aovs::Aov;
use std::ops::Range;
use std::time::Instant;

/// The value of the setting `denoise` that lets the kind of picture decide.
const FOR_DISPLAY: &str = "display";

/// Request for a [`Job`](crate::Job). Settings that are left out are those of the scene, or else the defaults.
///
/// ```
/// use bilux::prelude::*;
///
/// let scene = bilux::generate(&Spec::new("", "cornell"))?;
/// let asked = JobRequest::new().size(16, 16).integrator("path").spp(4).set("roulette_depth", 3);
/// let picture = Job::new(&scene, asked)?.render(&Quiet)?.picture()?;
/// assert_eq!((picture.width(), picture.height()), (16, 16));
/// # Ok::<(), bilux::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct JobRequest {
    /// Settings that take precedence over those of the scene.
    pub(crate) settings: Parameters,
    /// Properties that the picture has in common with others.
    pub(crate) series: Series,
    /// The maximum number of bytes of memory; `None` for any.
    pub(crate) max_memory: Option<u64>,
    /// The samples of each pixel that are taken; `None` for all.
    pub(crate) samples: Option<Range<u32>>,
    /// The window that is rendered; `None` for the whole picture.
    pub(crate) crop: Option<Window>,
    /// The layers that are kept while samples are taken.
    pub(crate) layers: Vec<Aov>,
    /// Whether node visits and triangle tests are counted.
    pub(crate) counts_work: bool,
    /// When the picture is denoised.
    pub(crate) denoised: Denoised,
    /// When its time limit starts; `None` means when rendering starts.
    pub(crate) begun: Option<Instant>,
    /// Whether loading third-party libraries is forbidden.
    pub(crate) sandboxed: bool,
}

/// When a picture is denoised. A fixed number of samples always gives the same bytes, unless denoising is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Denoised {
    /// Never.
    #[default]
    No,
    /// If the setting `denoise` names a denoiser.
    IfAsked,
    /// Also if the setting leaves it open, and noise or time ends the picture: it is made for a display.
    ForDisplay,
}

impl JobRequest {
    /// A picture of a scene as its settings have it.
    pub fn new() -> JobRequest {
        JobRequest::default()
    }

    /// Width and height of the picture, in pixels; default 512 and 512.
    #[must_use]
    pub fn size(self, width: u32, height: u32) -> JobRequest {
        self.set("size", format!("{width}x{height}"))
    }

    /// Any setting of [`RENDER`](crate::settings::RENDER) or of the integrator, by its name. [`Job::new`](crate::Job::new)
    /// checks it.
    #[must_use]
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> JobRequest {
        self.settings.set(key, value);
        self
    }

    /// Makes the picture one of a series.
    #[must_use]
    pub fn in_series(self, series: Series) -> JobRequest {
        JobRequest { series, ..self }
    }

    /// Refuses a picture that needs more memory, in bytes, before anything is built.
    #[must_use]
    pub fn max_memory(self, bytes: u64) -> JobRequest {
        JobRequest { max_memory: Some(bytes), ..self }
    }

    /// Takes only these samples of each pixel, for a partial film.
    #[must_use]
    pub fn samples(self, samples: Range<u32>) -> JobRequest {
        JobRequest { samples: Some(samples), ..self }
    }

    /// Renders only a window of the picture.
    #[must_use]
    pub fn crop(self, window: Window) -> JobRequest {
        JobRequest { crop: Some(window), ..self }
    }

    /// Keeps these layers: albedo, normals, depth, ids, guides and variance ([`Outcome::layered`](crate::Outcome::layered)), which
    /// changes no sample; and each pixel's confidence interval ([`Rendered::interval`](bilux_transport::Rendered::interval)), which
    /// takes other samples, so that parts of such a picture do not merge with parts of an ordinary one.
    #[must_use]
    pub fn layers(self, wanted: &[Aov]) -> JobRequest {
        JobRequest { layers: wanted.to_vec(), ..self }
    }

    /// Counts every node visit and triangle test, which is slower.
    #[must_use]
    pub fn counting_work(self) -> JobRequest {
        JobRequest { counts_work: true, ..self }
    }

    /// Chooses a denoiser ([`Job::denoiser`](crate::Job::denoiser)), and keeps the layers that guide it.
    #[must_use]
    pub fn denoised(self, when: Denoised) -> JobRequest {
        JobRequest { denoised: when, ..self }
    }

    /// Starts the clock of the time limit at `begun`, for example when the file was opened, instead of at the first
    /// sample.
    #[must_use]
    pub fn begun_at(self, begun: Instant) -> JobRequest {
        JobRequest { begun: Some(begun), ..self }
    }

    /// Loads no third-party library and looks for no file that might be one. A library that
    /// [`preload`](bilux_pictures::denoise::preload) has already loaded is still used.
    #[must_use]
    pub fn sandboxed(self) -> JobRequest {
        JobRequest { sandboxed: true, ..self }
    }

    /// The denoiser that the picture is to have, if any: the one that the setting `denoise` names, or, if the setting leaves
    /// it open, the best one for pictures for a display that noise or time ends.
    pub(crate) fn denoiser_name<'a>(&self, settings: &'a Settings) -> Option<&'a str> {
        let is_open = settings.denoise == FOR_DISPLAY;
        match self.denoised {
            Denoised::No => None,
            _ if settings.denoise == "off" => None,
            Denoised::ForDisplay if is_open => settings.stop.is_any().then_some("auto"),
            Denoised::IfAsked if is_open => None,
            Denoised::IfAsked | Denoised::ForDisplay => Some(&settings.denoise),
        }
    }

    /// The settings of a picture of this scene.
    ///
    /// # Errors
    /// If a setting is wrong, or the picture needs more memory than is allowed.
    pub(crate) fn settings_for(&self, scene: &SceneBuilder) -> Result<Settings, Error> {
        let mut settings = Settings::of(scene, &self.settings)?;
        let (needed, most) = (Memory::of(scene, &settings), self.max_memory.unwrap_or(u64::MAX));
        if needed.total() > most {
            return Err(Error::TooLarge { needed, most });
        }
        (settings.studio.turn, settings.own_light) = (self.series.turn, self.series.own_light);
        Ok(settings)
    }
}

/// Settings as text has them: a command line, a file, keywords.
impl From<&Parameters> for JobRequest {
    fn from(settings: &Parameters) -> JobRequest {
        JobRequest { settings: settings.clone(), ..JobRequest::default() }
    }
}

/// Conversion of a Rust type to the value that files and command lines write.
trait IntoSetting {
    fn into_setting(self) -> Value;
}

impl IntoSetting for &str {
    fn into_setting(self) -> Value {
        self.into()
    }
}

impl IntoSetting for bool {
    fn into_setting(self) -> Value {
        self.into()
    }
}

impl IntoSetting for f32 {
    fn into_setting(self) -> Value {
        self.into()
    }
}

impl IntoSetting for u32 {
    fn into_setting(self) -> Value {
        Value::Integer(self.into())
    }
}

impl IntoSetting for u64 {
    fn into_setting(self) -> Value {
        // What is too large is refused as text, with its digits.
        i64::try_from(self).map_or_else(|_| Value::Text(self.to_string()), Value::Integer)
    }
}

impl IntoSetting for Vec3 {
    fn into_setting(self) -> Value {
        self.into()
    }
}

impl IntoSetting for [f32; 2] {
    fn into_setting(self) -> Value {
        Value::List(self.map(Value::from).to_vec())
    }
}

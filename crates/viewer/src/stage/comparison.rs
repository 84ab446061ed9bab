//! The picture that the picture is compared with.

use crate::frame::Facts;
use crate::message::Other;
use bilux::Session;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::transport::NoiseMeter;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// The other picture.
pub(super) struct Comparison {
    pub(super) other: Other,
    /// Show where the two differ.
    pub(super) differences: bool,
    pub(super) session: Option<Session>,
    /// What denoises it.
    pub(super) denoiser: Option<DenoiserChoice>,
    /// Whether its session is that of the scene and the settings that are shown.
    pub(super) is_current: bool,
    /// Whether its scene has to be built anew.
    pub(super) is_other_scene: bool,
    pub(super) meter: NoiseMeter,
    pub(super) facts: Facts,
    pub(super) worked: Duration,
    pub(super) last_shown: Instant,
    pub(super) is_shown: bool,
    /// Whether it is to be shown at once, as it is: something else of it is asked for.
    pub(super) is_due: bool,
}

impl Comparison {
    /// A comparison with something, which is not rendered yet.
    pub(super) fn with(other: Other) -> Comparison {
        Comparison {
            other,
            differences: false,
            session: None,
            denoiser: None,
            is_current: false,
            is_other_scene: true,
            meter: NoiseMeter::default(),
            facts: Facts { side: "other", ..Facts::default() },
            worked: Duration::ZERO,
            last_shown: Instant::now(),
            is_shown: false,
            is_due: false,
        }
    }

    /// What is compared, for the page.
    pub(super) fn state(&self) -> Value {
        match &self.other {
            Other::Setting(key, value) => {
                let value = super::json::value_json(value);
                json!({ "with": "setting", "key": key, "value": value, "differences": self.differences })
            }
            Other::Unedited => json!({ "with": "unedited", "differences": self.differences }),
        }
    }

    /// True if there is something to be done for it.
    pub(super) fn goes_on(&self) -> bool {
        let is_done = self.session.as_ref().is_some_and(Session::is_done);
        !(self.is_current && is_done && self.is_shown)
    }
}

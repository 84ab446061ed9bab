//! When a picture is taken.

use super::Settings;

/// When the shutter opens and closes, in seconds.
pub(crate) fn shutter_of(settings: &Settings) -> [f32; 2] {
    [settings.time, settings.time + settings.shutter]
}

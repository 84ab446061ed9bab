//! When a picture is taken.

use super::Settings;

/// When the shutter opens and closes, in seconds: that of a rolling shutter opens for the first row, and closes for the last.
pub(crate) fn shutter_of(settings: &Settings) -> [f32; 2] {
    // A row of a rolling shutter is exposed for some time: light that finds the camera finds one that is.
    let row = settings.shutter.max(settings.readout / 1024.0);
    [settings.time, settings.time + row + settings.readout]
}

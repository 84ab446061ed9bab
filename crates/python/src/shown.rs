//! How pictures are prepared for a display.

use crate::errors::of_picture;
use bilux::math::Rgb;
use bilux::pictures::{Picture, ToneMapEntry, WriteOptions, auto_exposure, tone_map};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// How a picture is prepared for a display, unless a call says otherwise.
#[derive(Clone, Copy)]
pub(crate) struct Shown {
    /// Whether the picture is also exposed automatically.
    pub(crate) auto_exposure: bool,
    /// Exposure in stops.
    pub(crate) exposure: f32,
    /// The tone curve.
    pub(crate) curve: &'static ToneMapEntry,
    /// The colour behind transparent pixels.
    pub(crate) behind: Option<Rgb>,
}

impl Default for Shown {
    fn default() -> Shown {
        let WriteOptions { exposure, tone_map, behind, .. } = WriteOptions::default();
        Shown { auto_exposure: false, exposure, curve: tone_map, behind }
    }
}

impl Shown {
    /// The same with what a call says.
    pub(crate) fn with(self, exposure: Option<&Bound<'_, PyAny>>, curve: Option<&str>) -> PyResult<Shown> {
        let mut shown = self;
        if let Some(name) = curve {
            shown.curve = tone_map(name).map_err(of_picture)?;
        }
        if let Some(exposure) = exposure {
            let is_auto = exposure.extract::<String>().is_ok_and(|text| text == "auto");
            shown.auto_exposure = is_auto;
            shown.exposure = if is_auto { 0.0 } else { stops(exposure)? };
        }
        Ok(shown)
    }

    /// The exposure of this picture, in stops.
    pub(crate) fn exposure_of(&self, picture: &Picture) -> f32 {
        self.exposure + if self.auto_exposure { auto_exposure(picture) } else { 0.0 }
    }

    /// The options for writing a picture.
    pub(crate) fn options(&self, picture: &Picture) -> WriteOptions {
        let exposure = self.exposure_of(picture);
        WriteOptions { exposure, tone_map: self.curve, behind: self.behind, ..WriteOptions::default() }
    }
}

fn stops(exposure: &Bound<'_, PyAny>) -> PyResult<f32> {
    let wrong = |_| PyTypeError::new_err("exposure: this is a number of stops (powers of two), or 'auto'");
    match exposure.extract::<f32>().map_err(wrong)? {
        stops if stops.abs() <= 64.0 => Ok(stops),
        stops => Err(PyValueError::new_err(format!("exposure: {stops} is not from -64 to 64 stops"))),
    }
}

//! Display options of a picture, as plain Python values, for `pickle` and `copy`.

use bilux::Display;
use bilux::math::Rgb;
use bilux::pictures::{ColourSpace, tone_map};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The form of pickles; another number is refused.
pub(crate) const FORM: u32 = 2;

/// Everything that a picture holds: the form, its layers, how it is shown, its colour space, its metadata, and its info.
pub(crate) type PictureValues =
    (u32, Vec<(String, Vec<String>, Py<PyAny>)>, ShownValues, SpaceValue, Py<PyDict>, Py<PyDict>);

/// Exposure in stops, whether it is automatic too, the name of the tone curve, and the colour behind the picture.
pub(crate) type ShownValues = (f32, bool, String, Option<[f32; 3]>);

/// Linear light, sRGB as a power of 0, or a power.
pub(crate) type SpaceValue = Option<f32>;

pub(crate) fn shown_values(shown: &Display) -> ShownValues {
    let Display { exposure, auto_exposure, tone_map, behind, .. } = shown;
    (*exposure, *auto_exposure, tone_map.entry.name.to_owned(), behind.map(Rgb::to_array))
}

/// # Errors
/// If the values come from another version.
pub(crate) fn shown_of((exposure, auto_exposure, curve, behind): ShownValues) -> PyResult<Display> {
    let tone_map = tone_map(&curve).map_err(|_| other_version())?;
    let behind = behind.map(Rgb::from_array);
    Ok(Display { exposure, auto_exposure, tone_map, behind, ..Display::default() })
}

pub(crate) fn space_value(space: ColourSpace) -> SpaceValue {
    match space {
        ColourSpace::LinearRec709 => None,
        ColourSpace::Srgb => Some(0.0),
        ColourSpace::Gamma(power) => Some(power),
    }
}

pub(crate) fn space_of(value: SpaceValue) -> ColourSpace {
    match value {
        None => ColourSpace::LinearRec709,
        Some(0.0) => ColourSpace::Srgb,
        Some(power) => ColourSpace::Gamma(power),
    }
}

/// The error for values that come from another version.
pub(crate) fn other_version() -> PyErr {
    PyValueError::new_err("this picture was pickled by another version of bilux: save it as an .exr")
}

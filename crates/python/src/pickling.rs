//! Pictures and structures as plain Python values, for `pickle` and `copy`.

use crate::layer::Layer;
use crate::picture::Picture;
use bilux::Display;
use bilux::math::Rgb;
use bilux::pictures::{ColourSpace, tone_map};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The form of pickles; another number is refused.
const FORM: u32 = 2;

/// Exposure in stops, whether it is automatic too, the name of the tone curve, and the colour behind the picture.
type ShownValues = (f32, bool, String, Option<[f32; 3]>);

/// Everything that a picture holds.
pub(crate) type PictureValues =
    (u32, Vec<(String, Vec<String>, Py<PyAny>)>, ShownValues, Option<f32>, Py<PyDict>, Py<PyDict>);

/// A picture as plain values.
pub(crate) fn values_of(py: Python<'_>, picture: &Picture) -> PictureValues {
    let layers = picture.layers.iter();
    let layers = layers.map(|l| (l.name.clone(), l.channels.clone(), l.pixels.clone_ref(py))).collect();
    let Display { exposure, auto_exposure, tone_map, behind, .. } = picture.shown;
    let shown = (exposure, auto_exposure, tone_map.entry.name.to_owned(), behind.map(Rgb::to_array));
    // Linear light, sRGB as a power of 0, or a power.
    let space = match picture.colour_space {
        ColourSpace::LinearRec709 => None,
        ColourSpace::Srgb => Some(0.0),
        ColourSpace::Gamma(power) => Some(power),
    };
    (FORM, layers, shown, space, picture.metadata.clone_ref(py), picture.info.clone_ref(py))
}

/// The picture of these values.
///
/// # Errors
/// If they come from another version.
pub(crate) fn picture_of(py: Python<'_>, values: PictureValues) -> PyResult<Picture> {
    let (form, layers, (exposure, auto_exposure, curve, behind), space, metadata, info) = values;
    let other =
        || PyValueError::new_err("this picture was pickled by another version of bilux: save it as an .exr");
    if form != FORM || layers.is_empty() {
        return Err(other());
    }
    let layers: Vec<Layer> =
        layers.into_iter().map(|(name, channels, pixels)| Layer { name, channels, pixels }).collect();
    let tone_map = tone_map(&curve).map_err(|_| other())?;
    let behind = behind.map(Rgb::from_array);
    let shown = Display { exposure, auto_exposure, tone_map, behind, ..Display::default() };
    let colour_space = match space {
        None => ColourSpace::LinearRec709,
        Some(0.0) => ColourSpace::Srgb,
        Some(power) => ColourSpace::Gamma(power),
    };
    let size = layers[0].size(py)?;
    Ok(Picture { size, layers, shown, colour_space, metadata, info })
}

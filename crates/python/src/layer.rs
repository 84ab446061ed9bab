//! One layer of a picture: an array, and the names of its channels.

use crate::errors::of_picture;
use crate::{arrays, layer_names};
use bilux::pictures::{Alpha, ColourSpace, Picture, component_rank};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of pixels with names for its channels.
pub(crate) struct Layer {
    /// Empty for the main picture.
    pub(crate) name: String,
    /// The names of its channels in a file, such as albedo.R, albedo.G and albedo.B.
    pub(crate) channels: Vec<String>,
    /// An array (height, width) or (height, width, channels) of float32, or of uint32 for numbers of objects.
    pub(crate) pixels: Py<PyAny>,
}

impl Layer {
    /// A layer of an array, which is not copied if it already is of 32-bit numbers in rows.
    ///
    /// # Errors
    /// If it is no array of pixels.
    pub(crate) fn of_array(name: &str, pixels: &Bound<'_, PyAny>) -> PyResult<Layer> {
        let argument = if name.is_empty() { "pixels" } else { name };
        let array = arrays::numbers(argument, pixels)?;
        let dtype = array.dtype().getattr("str")?.extract::<String>()?;
        let most = if layer_names::is_matte(name) { usize::MAX } else { 4 };
        let channels = match *array.shape() {
            [height, width] if height > 0 && width > 0 => 1,
            [height, width, channels] if height > 0 && width > 0 && (1..=most).contains(&channels) => {
                channels
            }
            _ => {
                let shape = arrays::shape_of(&array);
                return Err(PyValueError::new_err(format!(
                    "{argument}: its shape is {shape}, but must be (height, width) or (height, width, channels), \
                     with 1 to 4 channels"
                )));
            }
        };
        let wanted = if dtype == "<u4" && !name.is_empty() { "uint32" } else { "float32" };
        let pixels = array.call_method1("astype", (wanted, "C", "unsafe", false, false))?.unbind();
        Ok(Layer { name: name.to_owned(), channels: layer_names::channels(name, channels), pixels })
    }

    /// The main layer of an array of bytes, which are colours as a screen shows them (sRGB, with straight alpha); `None` for
    /// other arrays.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn of_bytes(pixels: &Bound<'_, PyAny>) -> PyResult<Option<Layer>> {
        let Ok(array) = pixels.extract::<PyReadonlyArrayDyn<'_, u8>>() else { return Ok(None) };
        let array = array.as_array();
        let (height, width, count) = match *array.shape() {
            [height, width] => (height, width, 1),
            [height, width, count @ 1..=4] => (height, width, count),
            _ => return Ok(None),
        };
        if height == 0 || width == 0 {
            return Ok(None);
        }
        let mut picture = Picture::new(width, height).map_err(of_picture)?;
        (picture.colour_space, picture.alpha) = (ColourSpace::Srgb, Alpha::Straight);
        for (c, name) in layer_names::channels("", count).into_iter().enumerate() {
            let samples = array.iter().skip(c).step_by(count).map(|&byte| f32::from(byte) / 255.0);
            picture.push_channel(name, samples.collect()).map_err(of_picture)?;
        }
        Ok(layers_of(pixels.py(), &picture.into_linear())?.into_iter().next())
    }

    /// Height and width.
    pub(crate) fn size(&self, py: Python<'_>) -> PyResult<[usize; 2]> {
        match *self.pixels.bind(py).cast::<PyUntypedArray>()?.shape() {
            [height, width, ..] => Ok([height, width]),
            _ => Err(PyValueError::new_err(format!("the array of layer '{}' has lost its shape", self.name))),
        }
    }

    /// Adds the channels to a picture.
    ///
    /// # Errors
    /// If somebody has changed the shape of the array.
    pub(crate) fn push_to(&self, py: Python<'_>, picture: &mut Picture) -> PyResult<()> {
        let count = self.channels.len();
        let pixels = self.pixels.bind(py);
        for (c, name) in self.channels.iter().cloned().enumerate() {
            let pushed = match pixels.extract::<PyReadonlyArrayDyn<'_, u32>>() {
                Ok(numbers) => {
                    let samples = numbers.as_array().iter().copied().skip(c).step_by(count).collect();
                    picture.push_integer_plane(name, samples)
                }
                Err(_) => {
                    let numbers = pixels.extract::<PyReadonlyArrayDyn<'_, f32>>()?;
                    let view = numbers.as_array();
                    let samples = match view.as_slice() {
                        Some(slice) => slice.iter().copied().skip(c).step_by(count).collect(),
                        None => view.iter().copied().skip(c).step_by(count).collect(),
                    };
                    picture.push_channel(name, samples)
                }
            };
            pushed.map_err(of_picture)?;
        }
        Ok(())
    }
}

/// The layers of a picture, the main one first.
pub(crate) fn layers_of(py: Python<'_>, picture: &Picture) -> PyResult<Vec<Layer>> {
    let mut layers = Vec::new();
    let floats = picture.channels().iter().map(|channel| (&*channel.name, &*channel.samples));
    for (name, planes) in grouped(floats.collect(), &["R", "G", "B", "Y", "A"]) {
        layers.push(layer(py, picture, name, planes)?);
    }
    let integers = picture.integer_planes().iter().map(|plane| (&*plane.name, &*plane.samples));
    for (name, planes) in grouped(integers.collect(), &[]) {
        layers.push(layer(py, picture, name, planes)?);
    }
    layers.sort_by_key(|layer| !layer.name.is_empty());
    Ok(layers)
}

/// The parts of a channel's name before and after its last dot; some channels are of the main picture.
fn placed<'n>(channel: &'n str, main: &[&str]) -> (&'n str, &'n str) {
    match channel.rsplit_once('.') {
        Some(place) => place,
        None if main.contains(&channel) => ("", channel),
        None => (channel, ""),
    }
}

/// Channels by their names.
type Planes<'p, T> = Vec<(&'p str, &'p [T])>;

/// Channels of the same layer together, in order of appearance.
fn grouped<'p, T>(planes: Planes<'p, T>, main: &[&str]) -> Vec<(&'p str, Planes<'p, T>)> {
    let mut groups: Vec<(&str, Planes<'_, T>)> = Vec::new();
    for (channel, samples) in planes {
        let layer = layer_names::layer_of(placed(channel, main).0);
        match groups.iter_mut().find(|(name, _)| *name == layer) {
            Some((_, group)) => group.push((channel, samples)),
            None => groups.push((layer, vec![(channel, samples)])),
        }
    }
    groups
}

fn layer<T: numpy::Element + Copy>(
    py: Python<'_>,
    picture: &Picture,
    name: &str,
    mut planes: Planes<'_, T>,
) -> PyResult<Layer> {
    planes.sort_by_key(|(channel, _)| {
        let (prefix, component) = channel.rsplit_once('.').unwrap_or(("", channel));
        (prefix, component_rank(component))
    });
    let (height, width, channels) = (picture.height(), picture.width(), planes.len());
    let mut samples = Vec::with_capacity(height * width * channels);
    for i in 0..height * width {
        samples.extend(planes.iter().map(|(_, plane)| plane[i]));
    }
    let array = PyArray1::from_vec(py, samples);
    let pixels = match channels {
        1 => array.reshape([height, width])?.into_any().unbind(),
        _ => array.reshape([height, width, channels])?.into_any().unbind(),
    };
    let channels = planes.iter().map(|(channel, _)| (*channel).to_owned()).collect();
    Ok(Layer { name: name.to_owned(), channels, pixels })
}

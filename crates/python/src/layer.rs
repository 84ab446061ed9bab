//! One layer of a picture: an array, and the names of its channels.

use crate::arrays;
use crate::errors::of_picture;
use bilux::pictures::Picture;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of pixels with names for its channels.
pub(crate) struct Layer {
    /// Empty for the main picture.
    pub(crate) name: String,
    /// Such as R, G and B.
    pub(crate) components: Vec<String>,
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
        let channels = match *array.shape() {
            [height, width] if height > 0 && width > 0 => 1,
            [height, width, channels @ 1..=4] if height > 0 && width > 0 => channels,
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
        Ok(Layer { name: name.to_owned(), components: components(name, channels), pixels })
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
        let count = self.components.len();
        let pixels = self.pixels.bind(py);
        for (c, component) in self.components.iter().enumerate() {
            let name = match (&*self.name, &**component) {
                ("", component) => component.to_owned(),
                (layer, "") => layer.to_owned(),
                (layer, component) => format!("{layer}.{component}"),
            };
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

/// The usual names of so many channels.
fn components(layer: &str, channels: usize) -> Vec<String> {
    let names: &[&str] = match (layer, channels) {
        ("", 1) => &["Y"],
        ("", 2) => &["Y", "A"],
        ("id", 2) => &["object", "material"],
        ("depth", 1) => &["Z"],
        (_, 1) => &[""],
        ("normal", 3) => &["X", "Y", "Z"],
        (_, 2) => &["X", "Y"],
        (_, 3) => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    names.iter().map(|&name| name.to_owned()).collect()
}

/// The layers of a picture, the main one first.
pub(crate) fn layers_of(py: Python<'_>, picture: &Picture) -> PyResult<Vec<Layer>> {
    let main = ["R", "G", "B", "Y", "A"];
    let mut layers = Vec::new();
    let floats = picture.channels().iter().map(|channel| (&*channel.name, &*channel.samples));
    for (name, planes) in grouped(floats.map(|(name, samples)| (placed(name, &main), samples)).collect()) {
        layers.push(layer(py, picture, name, planes)?);
    }
    let integers = picture.integer_planes().iter().map(|plane| (&*plane.name, &*plane.samples));
    for (name, planes) in grouped(integers.map(|(name, samples)| (placed(name, &[]), samples)).collect()) {
        layers.push(layer(py, picture, name, planes)?);
    }
    layers.sort_by_key(|layer| !layer.name.is_empty());
    Ok(layers)
}

/// The layer and the component of a channel.
fn placed<'n>(channel: &'n str, main: &[&str]) -> (&'n str, &'n str) {
    match channel.rsplit_once('.') {
        Some(place) => place,
        None if main.contains(&channel) => ("", channel),
        None => (channel, ""),
    }
}

type Planes<'p, T> = Vec<(&'p str, &'p [T])>;

/// Channels with the same layer together, in order of appearance.
fn grouped<'p, T>(planes: Vec<((&'p str, &'p str), &'p [T])>) -> Vec<(&'p str, Planes<'p, T>)> {
    let mut groups: Vec<(&str, Planes<'_, T>)> = Vec::new();
    for ((layer, component), samples) in planes {
        match groups.iter_mut().find(|(name, _)| *name == layer) {
            Some((_, group)) => group.push((component, samples)),
            None => groups.push((layer, vec![(component, samples)])),
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
    // Files list channels by the alphabet.
    const ORDER: [&str; 7] = ["R", "G", "B", "X", "Y", "Z", "A"];
    planes.sort_by_key(|(component, _)| ORDER.iter().position(|known| known == component));
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
    let components = planes.iter().map(|(component, _)| (*component).to_owned()).collect();
    Ok(Layer { name: name.to_owned(), components, pixels })
}

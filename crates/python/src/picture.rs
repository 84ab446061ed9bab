//! Pictures whose layers are numpy arrays.

use crate::ending::without_gil;
use crate::errors::{exception, of_picture, warn};
use crate::layer::{Layer, layers_of};
use crate::layer_names::{Meaning, meaning};
use crate::pickling::{self, PictureValues, shown_of, shown_values, space_of, space_value};
use crate::sensor::sensed;
use crate::shown;
use crate::source::Sink;
use bilux::Display;
use bilux::pictures::denoise::{Task, denoise, denoiser};
use bilux::pictures::formats::BitDepth;
use bilux::pictures::{ColourSpace, to_display};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

/// A picture: an array of pixels, and other layers of the same size.
///
/// Numbers are 32-bit floats, proportional to light (linear Rec. 709), the top row first; colours are premultiplied by
/// alpha. The arrays are those of the picture itself, not copies: what you change in them is saved.
///
/// Args:
///     pixels: an array (height, width) for a grey picture, (height, width, 3) for colours, or (height, width, 4) with
///         alpha. Of uint8, it holds colours as a screen shows them (sRGB, with straight alpha); all other numbers are
///         linear.
///     layers: more arrays of the same height and width, by name.
///     metadata: texts to store with the picture, in formats that can.
///
/// Example:
///     >>> picture = bilux.generate("cornell").render(size=(64, 64), spp=4, aov=["depth"])
///     >>> picture.pixels.shape, picture["depth"].shape
///     ((64, 64, 3), (64, 64))
#[pyclass(frozen, module = "bilux")]
pub(crate) struct Picture {
    pub(crate) size: [usize; 2],
    /// The main picture first, whose name is empty.
    pub(crate) layers: Vec<Layer>,
    pub(crate) shown: Display,
    pub(crate) colour_space: ColourSpace,
    pub(crate) metadata: Py<PyDict>,
    pub(crate) info: Py<PyDict>,
}

#[pymethods]
impl Picture {
    #[new]
    #[pyo3(signature = (pixels, *, layers = None, metadata = None))]
    pub(crate) fn new(
        py: Python<'_>,
        pixels: &Bound<'_, PyAny>,
        layers: Option<&Bound<'_, PyDict>>,
        metadata: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Picture> {
        let main = Layer::of_bytes(pixels)?.map_or_else(|| Layer::of_array("", pixels), Ok)?;
        let size = main.size(py)?;
        let mut all = vec![main];
        for (name, pixels) in layers.into_iter().flatten() {
            let name: String = name.extract()?;
            let layer = Layer::of_array(&name, &pixels)?;
            let [height, width] = layer.size(py)?;
            if name.is_empty() || [height, width] != size {
                return Err(PyValueError::new_err(format!(
                    "layers: '{name}' has {width} x {height} pixels, but the picture has {} x {}",
                    size[1], size[0]
                )));
            }
            all.push(layer);
        }
        Ok(Picture {
            size,
            layers: all,
            shown: Display::default(),
            colour_space: ColourSpace::default(),
            metadata: metadata.unwrap_or_else(|| PyDict::new(py)).unbind(),
            info: PyDict::new(py).unbind(),
        })
    }

    /// The main picture: an array (height, width, 3), or (height, width, 4) with alpha, or (height, width) if grey.
    #[getter]
    fn pixels(&self, py: Python<'_>) -> Py<PyAny> {
        self.layers.first().map_or_else(|| py.None(), |layer| layer.pixels.clone_ref(py))
    }

    /// The width in pixels.
    #[getter]
    fn width(&self) -> usize {
        self.size[1]
    }

    /// The height in pixels.
    #[getter]
    fn height(&self) -> usize {
        self.size[0]
    }

    /// The names of the other layers, such as "albedo" or "depth"; each light group has one, "group_NAME", and so has each
    /// strategy, "strategy_NAME".
    #[getter]
    fn layers(&self) -> Vec<&str> {
        self.layers.iter().map(|layer| &*layer.name).filter(|name| !name.is_empty()).collect()
    }

    /// Texts that are stored with the picture, in formats that can.
    #[getter]
    fn metadata(&self, py: Python<'_>) -> Py<PyDict> {
        self.metadata.clone_ref(py)
    }

    /// What is known of the render: "spp" (samples per pixel that were taken; their mean, if it was stopped), "spp_asked"
    /// (those that were asked for, or None where noise or time decides), "noise" (a fraction of the light, or None), "seconds" and, of them, "build_seconds" (for the scene's trees), "trees_built" (how many
    /// there were not yet), "complete" (false if it was stopped), "integrator", "choice" (of strategies, or None), "denoiser" (or None), "seed", "time" (the
    /// moment that it shows, in seconds), "rays", and "warnings".
    /// Empty for other pictures.
    #[getter]
    fn info(&self, py: Python<'_>) -> Py<PyDict> {
        self.info.clone_ref(py)
    }

    /// The array of a layer, by the name in `bilux.aovs` or in `layers`: (height, width, channels), or (height, width) if
    /// it has one channel. "groups" and "strategies" are stacks of all their layers, sorted by name: (layers, height,
    /// width, 3).
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let found = self.found(name);
        if let (Meaning::Stack(_), false) = (meaning(name), found.is_empty()) {
            let arrays: Vec<_> = found.iter().map(|layer| layer.pixels.clone_ref(py)).collect();
            return py.import("numpy")?.call_method1("stack", (arrays,));
        }
        let pixels = found.first().map(|layer| layer.pixels.bind(py).clone());
        pixels.ok_or_else(|| {
            let known = self.layers().join(", ");
            let known = if known.is_empty() { "it has none; ask for some with aov=[…]" } else { &known };
            PyKeyError::new_err(format!("the picture has no layer '{name}' (layers: {known})"))
        })
    }

    fn __contains__(&self, name: &str) -> bool {
        !self.found(name).is_empty()
    }

    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let pixels = self.pixels(py).into_bound(py);
        if copy != Some(true) && dtype.is_none() {
            return Ok(pixels);
        }
        let keywords = PyDict::new(py);
        keywords.set_item("copy", copy.unwrap_or(false))?;
        let dtype = dtype.unwrap_or(pixels.getattr("dtype")?);
        pixels.call_method("astype", (dtype,), Some(&keywords))
    }

    /// Writes the picture; the extension says in which format. An .exr also keeps all layers.
    ///
    /// Args:
    ///     file: a path, whose file is replaced if it exists, or a file that is open for writing in binary mode.
    ///     format: the format (`bilux.picture_formats`), where no name says it.
    ///     exposure: stops by which formats for a display are brightened, or "auto"; by default as the render said.
    ///     tonemap: the tone curve of formats for a display; by default as the render said.
    ///     bits: 8 or 16 bits per channel of a PNG or PPM.
    ///     quality: of a JPEG, from 1 to 100.
    ///
    /// Raises:
    ///     PictureError: if the file cannot be written, or the format does not exist.
    ///
    /// Example:
    ///     >>> bilux.Picture(np.full((2, 2, 3), 0.5)).save("grey.png")
    #[pyo3(signature = (file, *, format = None, exposure = None, tonemap = None, bits = 8, quality = None))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword of Picture.save")]
    fn save(
        &self,
        py: Python<'_>,
        file: &Bound<'_, PyAny>,
        format: Option<&str>,
        exposure: Option<&Bound<'_, PyAny>>,
        tonemap: Option<&str>,
        bits: u32,
        quality: Option<f64>,
    ) -> PyResult<()> {
        let shown = shown::with(self.shown, exposure, tonemap)?;
        let mut picture = self.to_rust(py)?;
        let mut options = shown.options(&mut picture);
        options.bit_depth = match bits {
            8 => BitDepth::Eight,
            16 => BitDepth::Sixteen,
            _ => return Err(PyValueError::new_err(format!("bits: {bits} is neither 8 nor 16"))),
        };
        if let Some(quality) = quality {
            if !(1.0..=100.0).contains(&quality) {
                return Err(PyValueError::new_err(format!("quality: {quality} is not from 1 to 100")));
            }
            options.quality = quality as u8;
        }
        let sink = Sink::of(file, format)?;
        sink.format()?;
        let lost = bilux::lost_alpha(&picture, &sink.named(), options.behind).map_err(exception)?;
        warn(py, lost.as_slice())?;
        if let Sink::Path(path) = &sink {
            return without_gil(py, || bilux::pictures::write(path, &picture, &options)).map_err(of_picture);
        }
        let format = sink.format()?;
        let bytes = without_gil(py, || bilux::pictures::write_bytes(&format, &picture, &options));
        sink.write(py, &bytes.map_err(of_picture)?)
    }

    /// The picture as a display shows it: exposed, with a tone curve, sRGB-encoded, from 0 to 1, with straight alpha.
    ///
    /// Args:
    ///     curve: the name of a tone curve (`bilux.tonemaps`); by default as the render said.
    ///     exposure: stops, or "auto"; by default as the render said.
    ///
    /// Returns:
    ///     an array (height, width, 3) or (height, width, 4) of float32.
    #[pyo3(signature = (curve = None, *, exposure = None))]
    fn tonemapped(
        &self,
        py: Python<'_>,
        curve: Option<&str>,
        exposure: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        let shown = self.displayed(py, curve, exposure)?;
        let layers = layers_of(py, &shown)?;
        layers.into_iter().next().map(|layer| layer.pixels).ok_or_else(|| PyValueError::new_err("no pixels"))
    }

    /// The same in bytes, from 0 to 255: an array (height, width, 4) of uint8, as many widgets and encoders want it.
    #[pyo3(signature = (curve = None, *, exposure = None))]
    fn to_uint8<'py>(
        &self,
        py: Python<'py>,
        curve: Option<&str>,
        exposure: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let shown = self.displayed(py, curve, exposure)?;
        let bytes = shown.to_rgba8().unwrap_or_default();
        numpy::PyArray1::from_vec(py, bytes).call_method1("reshape", ((self.size[0], self.size[1], 4),))
    }

    /// The picture without noise; layers stay as they are. The layers albedo, normal, depth and variance help a lot.
    ///
    /// Args:
    ///     by: the denoiser (`bilux.denoisers`), or "auto" for the best one that is there.
    ///     threads: 0 for all cores.
    #[pyo3(signature = (by = "auto", *, threads = 0))]
    fn denoised(&self, py: Python<'_>, by: &str, threads: usize) -> PyResult<Picture> {
        crate::forks::check()?;
        let noisy = self.to_rust(py)?;
        let smooth = without_gil(py, || {
            let chosen = denoiser(by, &Task { threads, ..Task::default() })?;
            denoise(&noisy, &*chosen.denoiser)
        });
        Picture::of(py, &smooth.map_err(of_picture)?, self.shown, Some(self.info.clone_ref(py)))
    }

    /// What the sensor of a camera makes of the picture's light: photons, electrons, digital numbers, with their noise [EMVA 1288].
    ///
    /// Args:
    ///     parameters: those of `bilux.sensor["sensor"]`, such as exposure_time=0.01 (s), f_number=2.8, iso=400 or
    ///         gain=0.4 (DN/e-), quantum_efficiency=(0.45, 0.6, 0.5), full_well=10000, read_noise=2.5, bit_depth=12,
    ///         pattern="rggb", output="raw", seed=0. Samples of the picture are radiance in W/(m² sr), unless unit="cd/m2".
    ///
    /// Returns:
    ///     the light that the numbers stand for, in the unit of the picture; with output="raw" the digital numbers, an array
    ///     (height, width), or (height, width, 3) of the pattern "prism". Its `info` has "gain", "iso", "saturating_luminance"
    ///     (cd/m²) and "saturated" (pixels).
    ///
    /// Raises:
    ///     SceneError: if a parameter has a wrong name or a value out of range.
    ///     PictureError: if the picture has no colours, or the black level leaves no room for light.
    ///
    /// Example:
    ///     >>> grey = bilux.Picture(np.full((64, 64), 0.1))
    ///     >>> raw = grey.sensor(exposure_time=0.001, pattern="mono", output="raw")
    ///     >>> raw.pixels.shape
    ///     (64, 64)
    #[pyo3(signature = (**parameters))]
    fn sensor(&self, py: Python<'_>, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Picture> {
        let (picture, shown, info) = sensed(py, &self.to_rust(py)?, parameters)?;
        Picture::of(py, &picture, shown.unwrap_or(self.shown), Some(info))
    }

    /// The bytes of a PNG, for notebooks.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut picture = self.to_rust(py)?;
        let options = self.shown.options(&mut picture);
        let bytes = without_gil(py, || bilux::pictures::write_bytes("png", &picture, &options));
        Ok(PyBytes::new(py, &bytes.map_err(of_picture)?))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let restore = slf.get_type().getattr("_restored")?;
        (restore, (slf.get().values(slf.py()),)).into_pyobject(slf.py())
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, values: PictureValues) -> PyResult<Picture> {
        let (form, layers, shown, space, metadata, info) = values;
        if form != pickling::FORM || layers.is_empty() {
            return Err(pickling::other_version());
        }
        let layer = |(name, channels, pixels)| Layer { name, channels, pixels };
        let layers: Vec<Layer> = layers.into_iter().map(layer).collect();
        let (shown, colour_space) = (shown_of(shown)?, space_of(space));
        Ok(Picture { size: layers[0].size(py)?, layers, shown, colour_space, metadata, info })
    }

    fn __repr__(&self) -> String {
        let layers = self.layers();
        let layers =
            if layers.is_empty() { String::new() } else { format!(", layers {}", layers.join(", ")) };
        format!("<bilux.Picture {} x {} pixels{layers}>", self.size[1], self.size[0])
    }
}

impl Picture {
    /// Everything that it holds.
    fn values(&self, py: Python<'_>) -> PictureValues {
        let layers = self.layers.iter();
        let layers = layers.map(|l| (l.name.clone(), l.channels.clone(), l.pixels.clone_ref(py))).collect();
        let (shown, space) = (shown_values(&self.shown), space_value(self.colour_space));
        (pickling::FORM, layers, shown, space, self.metadata.clone_ref(py), self.info.clone_ref(py))
    }

    /// The layers that a name stands for.
    fn found(&self, name: &str) -> Vec<&Layer> {
        let all = || self.layers.iter().filter(|layer| !layer.name.is_empty());
        if let Some(layer) = all().find(|layer| layer.name == name) {
            return vec![layer];
        }
        match meaning(name) {
            Meaning::Layer(wanted) => all().find(|layer| layer.name == wanted).into_iter().collect(),
            Meaning::Stack(beginning) => {
                let mut layers: Vec<&Layer> =
                    all().filter(|layer| layer.name.starts_with(beginning)).collect();
                // As files list them.
                layers.sort_by_key(|layer| &layer.name);
                layers
            }
        }
    }

    /// A picture of the library, its planes interleaved into arrays.
    pub(crate) fn of(
        py: Python<'_>,
        picture: &bilux::pictures::Picture,
        shown: Display,
        info: Option<Py<PyDict>>,
    ) -> PyResult<Picture> {
        let metadata = PyDict::new(py);
        for (key, text) in &picture.metadata {
            metadata.set_item(key, text)?;
        }
        Ok(Picture {
            size: [picture.height(), picture.width()],
            layers: layers_of(py, picture)?,
            shown,
            colour_space: picture.colour_space,
            metadata: metadata.unbind(),
            info: info.unwrap_or_else(|| PyDict::new(py).unbind()),
        })
    }

    /// The picture as the library has it, with its arrays as they are now.
    pub(crate) fn to_rust(&self, py: Python<'_>) -> PyResult<bilux::pictures::Picture> {
        let [height, width] = self.size;
        let mut picture = bilux::pictures::Picture::new(width, height).map_err(of_picture)?;
        for layer in &self.layers {
            layer.push_to(py, &mut picture)?;
        }
        picture.colour_space = self.colour_space;
        for (key, text) in self.metadata.bind(py) {
            picture.metadata.insert(key.extract()?, text.extract()?);
        }
        Ok(picture)
    }

    fn displayed(
        &self,
        py: Python<'_>,
        curve: Option<&str>,
        exposure: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<bilux::pictures::Picture> {
        let shown = shown::with(self.shown, exposure, curve)?;
        let picture = self.to_rust(py)?;
        let display = || to_display(&picture, shown.exposure_of(&picture), shown.tone_map);
        without_gil(py, display).map_err(of_picture)
    }
}

//! Textures from arrays and files.

use crate::arrays;
use crate::encoded::{Encoded, decoded as decoded_scene};
use crate::ending::without_gil;
use crate::errors::{of_picture, warn_of_picture};
use crate::memory;
use crate::source::Source;
use bilux::math::Rgb;
use bilux::pictures::{Limits, PictureError, Rgba8, read_rgba8};
use bilux::scene::SceneBuilder;
use bilux::scene::texture::{Filter, Image, Texels, Wrap};
use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// An image on surfaces, for any parameter of a material or a light that takes a texture.
///
/// Args:
///     pixels: an array (height, width), (height, width, 3) or (height, width, 4), the top row first. Of uint8, it
///         holds colours as a screen shows them (sRGB) or, with `data=True`, fractions of 255; all other numbers are
///         linear.
///     data: the texture holds numbers, such as roughness or normals, instead of colours.
///     wrap: what is beyond its edges: "repeat", "mirror" or "clamp".
///     filter: "linear" or "nearest".
///     name: a name for messages and written files.
///
/// Example:
///     >>> checks = np.kron([[1, 0] * 4, [0, 1] * 4] * 4, np.ones((8, 8)))
///     >>> material = bilux.materials.diffuse(reflectance=bilux.Texture(checks, filter="nearest"))
#[pyclass(frozen, module = "bilux")]
pub(crate) struct Texture(pub(crate) Arc<bilux::scene::Texture>);

#[pymethods]
impl Texture {
    #[new]
    #[pyo3(signature = (pixels, *, data = false, wrap = "repeat", filter = "linear", name = ""))]
    fn new(pixels: &Bound<'_, PyAny>, data: bool, wrap: &str, filter: &str, name: &str) -> PyResult<Texture> {
        let image = match bytes(pixels)? {
            Some(image) => image,
            None => floats(pixels)?,
        };
        if image.width == 0 || image.height == 0 {
            return Err(PyValueError::new_err("pixels: a texture has at least one row and one column"));
        }
        placed(bilux::scene::Texture::of(name, Arc::new(image), data), wrap, filter)
    }

    /// Reads a picture file as a texture.
    ///
    /// Args:
    ///     file: a picture in any format that Bilux reads: a path, bytes, or a file that is open in binary mode.
    ///     data, wrap, filter: as for `Texture`.
    ///     format: the format (`bilux.picture_formats`), where neither its bytes nor its name says it.
    ///     layer: a layer of an EXR, in place of its main picture.
    ///
    /// Raises:
    ///     FileNotFoundError: if there is no such file.
    ///     PictureError: if the file is no picture, or has no such layer.
    #[staticmethod]
    #[pyo3(signature = (file, *, data = false, wrap = "repeat", filter = "linear", format = None, layer = None))]
    fn read(
        file: &Bound<'_, PyAny>,
        data: bool,
        wrap: &str,
        filter: &str,
        format: Option<String>,
        layer: Option<&str>,
    ) -> PyResult<Texture> {
        let py = file.py();
        let limits = memory::for_picture_files();
        let source = Source::of("file", file, limits.max_bytes)?.opened(py, limits.max_bytes)?;
        let (name, format) = (source.file_name(), format.or_else(|| source.extension()));
        let bytes = source.bytes();
        let read = without_gil(py, || decoded(bytes, format.as_deref(), data, layer, &limits));
        let (image, warnings) = read.map_err(of_picture)?;
        warn_of_picture(py, &source.name(), &warnings)?;
        let image = image.ok_or_else(|| {
            PyValueError::new_err(format!("{}: this picture has no colours", source.name()))
        })?;
        placed(bilux::scene::Texture::of(&name, Arc::new(image), data), wrap, filter)
    }

    /// Its height and width in texels.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.0.height(), self.0.width())
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Texture>().is_ok_and(|other| Arc::ptr_eq(&self.0, &other.get().0))
    }

    fn __hash__(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, mut alone) = (slf.py(), SceneBuilder::default());
        alone.textures.push(slf.get().0.clone());
        let encoded = Encoded::of(py, &alone)?;
        let restore = slf.get_type().getattr("_restored")?;
        (restore, (encoded.document(py), encoded.blobs(py)?)).into_pyobject(py)
    }

    #[staticmethod]
    fn _restored(document: &Bound<'_, PyAny>, blobs: &Bound<'_, PyDict>) -> PyResult<Texture> {
        let texture = decoded_scene(document, blobs)?.textures.pop();
        texture.map(Texture).ok_or_else(|| PyValueError::new_err("this is no pickle of a texture"))
    }

    fn __repr__(&self) -> String {
        format!("<bilux.Texture '{}', {} x {} texels>", self.0.name, self.0.width(), self.0.height())
    }
}

impl Texture {
    /// A texture of a scene.
    pub(crate) fn of(texture: Arc<bilux::scene::Texture>) -> Texture {
        Texture(texture)
    }
}

fn placed(texture: bilux::scene::Texture, wrap: &str, filter: &str) -> PyResult<Texture> {
    let wraps = match wrap {
        "repeat" => Wrap::Repeat,
        "mirror" => Wrap::Mirror,
        "clamp" => Wrap::Clamp,
        _ => return Err(unknown("wrap", wrap, "'repeat', 'mirror' or 'clamp'")),
    };
    let filter = match filter {
        "linear" => Filter::Linear,
        "nearest" => Filter::Nearest,
        _ => return Err(unknown("filter", filter, "'linear' or 'nearest'")),
    };
    Ok(Texture(Arc::new(bilux::scene::Texture { wrap: [wraps; 2], filter, ..texture })))
}

fn unknown(argument: &str, word: &str, known: &str) -> PyErr {
    PyValueError::new_err(format!("{argument}: there is no '{word}': write {known}"))
}

/// The image in a file, and what is odd about that; `None` if it has no colours.
fn decoded(
    bytes: &[u8],
    extension: Option<&str>,
    data: bool,
    layer: Option<&str>,
    limits: &Limits,
) -> Result<(Option<Image>, Vec<String>), PictureError> {
    if layer.is_none()
        && let Some(Rgba8 { width, height, texels, warnings }) = read_rgba8(bytes, extension, limits)?
    {
        return Ok((Some(Image { width, height, texels: Texels::Bytes(texels) }), warnings));
    }
    // What a file says of its colours does not count for numbers.
    let read = if data { bilux::pictures::read_stored_bytes } else { bilux::pictures::read_bytes };
    let picture = read(bytes, extension, limits)?.with_main(layer)?;
    let (width, height, warnings) = (picture.width(), picture.height(), picture.warnings.clone());
    let picture = if data { picture } else { picture.into_linear() };
    let alpha = picture.channel("A").map_or_else(Vec::new, <[f32]>::to_vec);
    let image = |colours| Image { width, height, texels: Texels::Floats { colours, alpha } };
    Ok((picture.to_rgb().map(image), warnings))
}

/// Colours of bytes, if that is what the array holds.
fn bytes(pixels: &Bound<'_, PyAny>) -> PyResult<Option<Image>> {
    let Ok(array) = pixels.extract::<PyReadonlyArrayDyn<'_, u8>>() else { return Ok(None) };
    let array = array.as_array();
    let (height, width, channels) = match *array.shape() {
        [height, width] => (height, width, 1),
        [height, width, channels @ (1 | 3 | 4)] => (height, width, channels),
        _ => return Ok(None),
    };
    let samples: Vec<u8> = array.iter().copied().collect();
    let texel = |texel: &[u8]| match *texel {
        [r, g, b, a] => [r, g, b, a],
        [r, g, b] => [r, g, b, 255],
        [grey, ..] => [grey, grey, grey, 255],
        [] => [0; 4],
    };
    let texels = Texels::Bytes(samples.chunks_exact(channels).map(texel).collect());
    Ok(Some(Image { width, height, texels }))
}

fn floats(pixels: &Bound<'_, PyAny>) -> PyResult<Image> {
    let ([height, width, channels], samples) = arrays::pixels("pixels", pixels)?;
    if let Some(bad) = samples.iter().position(|sample| !sample.is_finite()) {
        let (row, column) = (bad / channels / width, bad / channels % width);
        return Err(PyValueError::new_err(format!(
            "pixels: the texel in row {row}, column {column} is not finite: correct it"
        )));
    }
    let colour = |texel: &[f32]| match *texel {
        [r, g, b, ..] => Rgb::new(r, g, b),
        [grey, ..] => Rgb::grey(grey),
        [] => Rgb::BLACK,
    };
    let texels = || samples.chunks_exact(channels);
    let alpha = texels().filter_map(|texel| match (channels, texel.last()) {
        (2 | 4, Some(alpha)) => Some(*alpha),
        _ => None,
    });
    let alpha = alpha.collect();
    Ok(Image { width, height, texels: Texels::Floats { colours: texels().map(colour).collect(), alpha } })
}

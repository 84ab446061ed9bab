//! Scenes as bytes, for `pickle` and for other machines.

use crate::ending::without_gil;
use crate::errors::exception;
use bilux::encoding::{Blob, ContentHash, EncodedScene, decode, encode};
use bilux::scene::SceneBuilder;
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::HashMap;

/// A scene as bytes: a document, and the blobs to which it refers by the hashes of their content.
#[pyclass(frozen, module = "bilux._bilux")]
pub(crate) struct Encoded(EncodedScene);

#[pymethods]
impl Encoded {
    /// Everything but the blobs.
    #[getter]
    pub(crate) fn document<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.document)
    }

    /// The hashes of the blobs.
    #[getter]
    fn hashes(&self) -> Vec<String> {
        self.0.blobs.keys().map(ToString::to_string).collect()
    }

    /// The bytes of a blob.
    fn blob<'py>(&self, py: Python<'py>, hash: &str) -> PyResult<Bound<'py, PyBytes>> {
        let blob = ContentHash::from_hex(hash).and_then(|hash| self.0.blobs.get(&hash));
        let blob = blob.ok_or_else(|| PyKeyError::new_err(format!("there is no blob {hash}")))?;
        let bytes = without_gil(py, || Blob::bytes(blob));
        Ok(PyBytes::new(py, &bytes))
    }
}

impl Encoded {
    /// All blobs, by their hashes.
    pub(crate) fn blobs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let blobs = PyDict::new(py);
        for (hash, blob) in &self.0.blobs {
            blobs.set_item(hash.to_string(), PyBytes::new(py, &without_gil(py, || Blob::bytes(blob))))?;
        }
        Ok(blobs)
    }

    pub(crate) fn of(py: Python<'_>, scene: &SceneBuilder) -> PyResult<Encoded> {
        without_gil(py, || encode(scene)).map(Encoded).map_err(exception)
    }
}

/// Bytes, or an array of uint8 over the memory that others share.
pub(crate) enum Bytes<'py> {
    Bytes(Bound<'py, PyBytes>),
    Array(PyReadonlyArray1<'py, u8>),
}

impl<'py> Bytes<'py> {
    pub(crate) fn of(argument: &Bound<'py, PyAny>) -> PyResult<Bytes<'py>> {
        if let Ok(bytes) = argument.cast::<PyBytes>() {
            return Ok(Bytes::Bytes(bytes.clone()));
        }
        let array = argument.extract().map(Bytes::Array);
        array.map_err(|_| PyTypeError::new_err("give bytes, or an array of uint8 with one dimension"))
    }

    pub(crate) fn get(&self) -> PyResult<&[u8]> {
        match self {
            Bytes::Bytes(bytes) => Ok(bytes.as_bytes()),
            Bytes::Array(array) => Ok(array.as_slice()?),
        }
    }
}

/// The scene of a document and its blobs, by their hashes.
pub(crate) fn decoded(document: &Bound<'_, PyAny>, blobs: &Bound<'_, PyDict>) -> PyResult<SceneBuilder> {
    let py = document.py();
    let document = Bytes::of(document)?;
    let mut held = Vec::new();
    for (hash, bytes) in blobs {
        held.push((ContentHash::from_hex(&hash.extract::<String>()?), Bytes::of(&bytes)?));
    }
    let mut by_hash: HashMap<ContentHash, &[u8]> = HashMap::new();
    for (hash, bytes) in &held {
        if let Some(hash) = hash {
            by_hash.insert(*hash, bytes.get()?);
        }
    }
    let document = document.get()?;
    let scene = without_gil(py, || decode(document, &|hash| by_hash.get(&hash).copied()));
    scene.map_err(exception)
}

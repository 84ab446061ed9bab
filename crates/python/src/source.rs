//! Sources of a file's bytes: a path, the bytes themselves, or an open file.

use crate::ending::without_gil;
use crate::errors::of_picture;
use bilux::pictures::PictureError;
use bilux::pictures::formats::format_of_path;
use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyMemoryView, PyString};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of bytes that are read from an open file at a time.
const CHUNK: usize = 16 << 20;

/// Name in messages of bytes without a name.
const UNNAMED: &str = "(bytes)";

/// A file that was given.
#[derive(Clone)]
pub(crate) enum Source {
    /// The file at this path.
    Path(PathBuf),
    /// These bytes.
    Bytes {
        /// The bytes.
        bytes: Arc<[u8]>,
        /// The name of the open file that they were read from, if it has one.
        name: Option<String>,
    },
}

impl Source {
    /// The source that an argument gives: a path, bytes, or a file that is open in binary mode, from where it is to its end, but
    /// not many more bytes than `most`.
    ///
    /// # Errors
    /// If it is none of these, or the file is open as text, or gives no bytes; and whatever reading it raises.
    pub(crate) fn of(argument: &str, given: &Bound<'_, PyAny>, most: u64) -> PyResult<Source> {
        if let Some(bytes) = bytes_of(given)? {
            return Ok(Source::Bytes { bytes, name: None });
        }
        if let Ok(text) = given.cast::<PyString>()
            && text.to_str()?.contains('\n')
        {
            let message = format!("{argument}: this is the text of a file, not its path: give text.encode()");
            return Err(PyTypeError::new_err(message));
        }
        if !given.hasattr("read")? {
            return given.extract().map(Source::Path).map_err(|_| {
                let kind = given.get_type().name().map_or_else(|_| "value".into(), |name| name.to_string());
                PyTypeError::new_err(format!(
                    "{argument}: a {kind} is no file: give a path, bytes, or a file that is open in binary mode"
                ))
            });
        }
        let name = given.getattr("name").ok().and_then(|name| name.extract::<String>().ok());
        Ok(Source::Bytes { bytes: read_all(argument, given, most)?, name })
    }

    /// This source with the bytes of a picture's file in place of its path, but not many more than `most`.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(crate) fn opened(self, py: Python<'_>, most: u64) -> PyResult<Source> {
        let Source::Path(path) = &self else { return Ok(self) };
        let fault = |source| of_picture(PictureError::Io { action: "open it", source }.in_file(path));
        let bytes = without_gil(py, || bytes_at(path, most)).map_err(fault)?;
        Ok(Source::Bytes { bytes: bytes.into(), name: Some(path.display().to_string()) })
    }

    /// The extension of its name.
    pub(crate) fn extension(&self) -> Option<String> {
        let path = match self {
            Source::Path(path) => path,
            Source::Bytes { name, .. } => Path::new(name.as_deref()?),
        };
        path.extension().map(|extension| extension.to_string_lossy().into_owned())
    }

    /// The bytes, if it is not a path.
    pub(crate) fn bytes(&self) -> &[u8] {
        match self {
            Source::Path(_) => &[],
            Source::Bytes { bytes, .. } => bytes,
        }
    }

    /// The last part of its path, or nothing.
    pub(crate) fn file_name(&self) -> String {
        let path = match self {
            Source::Path(path) => path,
            Source::Bytes { name, .. } => Path::new(name.as_deref().unwrap_or_default()),
        };
        path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// The name for messages and for what is made of it.
    pub(crate) fn name(&self) -> String {
        match self {
            Source::Path(path) => path.display().to_string(),
            Source::Bytes { name, .. } => name.clone().unwrap_or_else(|| UNNAMED.to_owned()),
        }
    }

    /// The folder of the files that it refers to, if it is known.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let path = match self {
            Source::Path(path) => path.clone(),
            Source::Bytes { name, .. } => PathBuf::from(name.as_ref()?),
        };
        path.is_file().then(|| path.parent().map(Path::to_owned)).flatten()
    }
}

/// The bytes of a file, but not many more than `most`: whoever reads them says that they are too many.
pub(crate) fn bytes_at(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes in a Python object that holds some; `None` if it holds none.
fn bytes_of(given: &Bound<'_, PyAny>) -> PyResult<Option<Arc<[u8]>>> {
    if let Ok(bytes) = given.cast::<PyBytes>() {
        return Ok(Some(bytes.as_bytes().into()));
    }
    if let Ok(array) = given.extract::<PyReadonlyArrayDyn<'_, u8>>() {
        return Ok(Some(array.as_array().iter().copied().collect()));
    }
    let is_view = given.is_instance_of::<PyMemoryView>();
    if is_view || given.is_instance_of::<PyByteArray>() {
        let copy = given.py().get_type::<PyBytes>().call1((given,))?;
        return Ok(Some(copy.cast::<PyBytes>()?.as_bytes().into()));
    }
    Ok(None)
}

/// The bytes of an open file, from where it is to its end.
fn read_all(argument: &str, file: &Bound<'_, PyAny>, most: u64) -> PyResult<Arc<[u8]>> {
    let as_text = || {
        PyTypeError::new_err(format!(
            "{argument}: this file is open as text: open it in binary mode, with open(…, \"rb\")"
        ))
    };
    if file.is_instance(&file.py().import("io")?.getattr("TextIOBase")?)? {
        return Err(as_text());
    }
    let mut all = Vec::new();
    loop {
        let chunk = file.call_method1("read", (CHUNK,))?;
        if chunk.is_instance_of::<PyString>() {
            return Err(as_text());
        }
        let Some(bytes) = bytes_of(&chunk)? else {
            let kind = chunk.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "{argument}: its method read gives a {kind}, not bytes"
            )));
        };
        all.extend_from_slice(&bytes);
        // Whoever reads them says that they are too many.
        if bytes.is_empty() || all.len() as u64 > most {
            break;
        }
    }
    if all.is_empty() {
        return Err(PyValueError::new_err(format!(
            "{argument}: this file gives no bytes: it is empty, or at its end, and then seek(0) goes back"
        )));
    }
    Ok(all.into())
}

/// Destination of a picture.
pub(crate) enum Sink<'py> {
    /// To the file at this path, whose extension says the format.
    Path(PathBuf),
    /// To the file at this path, in this format.
    PathIn(PathBuf, String),
    /// To this open file, in a format that was given, or that its name says.
    File(Bound<'py, PyAny>, Option<String>),
}

impl<'py> Sink<'py> {
    /// The destination that an argument gives: a path, or a file that is open for writing in binary mode.
    ///
    /// # Errors
    /// If it is neither.
    pub(crate) fn of(given: &Bound<'py, PyAny>, format: Option<&str>) -> PyResult<Sink<'py>> {
        if given.hasattr("write")? {
            if given.is_instance(&given.py().import("io")?.getattr("TextIOBase")?)? {
                return Err(PyTypeError::new_err(
                    "file: this file is open as text: open it in binary mode, with open(…, \"wb\")",
                ));
            }
            let name = given.getattr("name").ok().and_then(|name| name.extract::<PathBuf>().ok());
            let by_name = name.and_then(|name| Some(name.extension()?.to_string_lossy().into_owned()));
            return Ok(Sink::File(given.clone(), format.map(str::to_owned).or(by_name)));
        }
        let path: PathBuf = given.extract().map_err(|_| {
            PyTypeError::new_err("file: give a path, or a file that is open for writing in binary mode")
        })?;
        Ok(match format {
            Some(format) => Sink::PathIn(path, format.to_owned()),
            None => Sink::Path(path),
        })
    }

    /// A name with the extension of the format, for messages.
    pub(crate) fn named(&self) -> PathBuf {
        match self {
            Sink::Path(path) => path.clone(),
            Sink::PathIn(path, format) => path.with_extension(format),
            Sink::File(_, format) => Path::new("file").with_extension(format.as_deref().unwrap_or_default()),
        }
    }

    /// The name of the format.
    ///
    /// # Errors
    /// If nothing says it, or pictures are not written in it.
    pub(crate) fn format(&self) -> PyResult<String> {
        if let Sink::File(_, None) = self {
            return Err(PyValueError::new_err(
                "format: this file has no name that says the format: give one, such as format=\"png\"",
            ));
        }
        Ok(format_of_path(self.named()).map_err(of_picture)?.entry.name.to_owned())
    }

    /// Writes the bytes of the picture.
    ///
    /// # Errors
    /// If that fails.
    pub(crate) fn write(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        match self {
            Sink::Path(path) | Sink::PathIn(path, _) => {
                let written = without_gil(py, || bilux::pictures::formats::write_atomically(path, bytes));
                written.map_err(|error| of_picture(error.in_file(path)))
            }
            Sink::File(file, _) => file.call_method1("write", (PyBytes::new(py, bytes),)).map(drop),
        }
    }
}

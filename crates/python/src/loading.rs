//! Scenes from files, bytes and open files.

use crate::ending::without_gil;
use crate::errors::{of_text, warn};
use crate::source::{Source, bytes_at};
use bilux::formats::{FormatError, Glass, ReadOptions, Scheme};
use bilux::scene::SceneBuilder;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Origin of a scene, and the options with which it was read.
#[derive(Clone)]
pub(crate) struct Origin {
    pub(crate) source: Source,
    /// The name of its format, if it was given.
    pub(crate) format: Option<String>,
    /// The folder of the files that it refers to, if it was given.
    pub(crate) folder: Option<PathBuf>,
    pub(crate) options: ReadOptions,
}

impl Origin {
    /// Reads the scene.
    ///
    /// # Errors
    /// As `bilux::load`.
    pub(crate) fn read(&self) -> Result<SceneBuilder, bilux::Error> {
        self.read_with(&self.options)
    }

    /// Reads the scene as it is at another time, in seconds.
    ///
    /// # Errors
    /// As `bilux::load`.
    pub(crate) fn read_at(&self, time: f32) -> Result<SceneBuilder, bilux::Error> {
        self.read_with(&ReadOptions { time, ..self.options.clone() })
    }

    fn read_with(&self, options: &ReadOptions) -> Result<SceneBuilder, bilux::Error> {
        let Origin { source, format, folder, .. } = self;
        let opened;
        let bytes = match source {
            Source::Path(path) if format.is_none() && folder.is_none() => return bilux::load(path, options),
            Source::Path(path) => {
                let fault = |source| FormatError::Io { path: path.clone(), action: "open it", source };
                opened = bytes_at(path, options.max_memory).map_err(fault)?;
                &opened[..]
            }
            Source::Bytes { bytes, .. } => bytes,
        };
        let by_name =
            || source.extension().filter(|e| bilux::formats::format_named(e).is_some_and(|f| f.reads()));
        let format = format.clone().or_else(by_name).unwrap_or_default();
        let folder = folder.clone().or_else(|| source.folder());
        let read = bilux::formats::read_bytes(bytes, &format, folder.as_deref(), &source.name(), options);
        Ok(read?)
    }
}

/// Reads a scene, and shows what is odd about it.
///
/// # Errors
/// If it cannot be read; where nothing says what its format is, the message names the keyword that does.
pub(crate) fn loaded(py: Python<'_>, origin: &Origin) -> PyResult<SceneBuilder> {
    let scene = without_gil(py, || origin.read()).map_err(|error| {
        let is_unknown = matches!(&error, bilux::Error::Format(FormatError::UnknownFormat { .. }));
        let advice = match (is_unknown, &origin.source, &origin.format) {
            (true, Source::Bytes { .. }, None) => "; if you know its format, say so, such as format=\"obj\"",
            _ => "",
        };
        of_text(&error, error.to_string() + advice)
    })?;
    warn(py, &scene.warnings)?;
    Ok(scene)
}

/// The way of reading glass whose thickness a file does not give.
///
/// # Errors
/// If there is no such way.
pub(crate) fn glass_named(name: &str) -> PyResult<Glass> {
    match name {
        "auto" => Ok(Glass::Auto),
        "thin" => Ok(Glass::Thin),
        "solid" => Ok(Glass::Solid),
        _ => {
            let message = format!("glass: there is no '{name}': write 'auto', 'thin' or 'solid'");
            Err(PyValueError::new_err(message))
        }
    }
}

pub(crate) fn scheme_named(name: &str) -> PyResult<Scheme> {
    Scheme::named(name).ok_or_else(|| {
        let known = Scheme::ALL.map(|(name, _)| format!("'{name}'"));
        PyValueError::new_err(format!("subdivide: there is no '{name}': write {}", known.join(", ")))
    })
}

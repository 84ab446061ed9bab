//! The Python package `bilux`: a thin front end over the library.
//!
//! What Python sees of it is `python/bilux/`, whose classes complete those here: here is what touches arrays, threads
//! and the library; there are names, defaults and documentation.

mod accel;
mod arrays;
mod errors;
mod forks;
mod layer;
mod picture;
mod progressive;
mod render;
mod scene;
mod spec;
mod texture;
mod values;
mod watch;

use pyo3::prelude::*;

/// The native part of the package `bilux`.
#[pymodule]
mod _bilux {
    use super::*;
    #[pymodule_export]
    use crate::accel::Accel;
    #[pymodule_export]
    use crate::picture::{Picture, compare, read_picture};
    #[pymodule_export]
    use crate::progressive::Progressive;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::spec::{Spec, rows};
    #[pymodule_export]
    use crate::texture::Texture;

    /// Adds the version.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

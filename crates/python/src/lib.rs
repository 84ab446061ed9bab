//! The Python package `bilux`: a thin front end over the library.
//!
//! What Python sees of it is `python/bilux/`, whose classes complete those here: here is what touches arrays, threads
//! and the library; there are names, defaults and documentation.

mod accel;
mod adding;
mod arrays;
mod building;
mod cameras;
mod distribution;
mod encoded;
mod ending;
mod errors;
mod forks;
mod grid;
mod hits;
mod inspect;
mod keyframes;
mod layer;
mod layer_names;
mod lidar;
mod loading;
mod memory;
mod objects;
mod output;
mod parts;
mod pickling;
mod picture;
mod placed_mesh;
mod poses;
mod progressive;
mod rays;
mod reading;
mod render;
mod request;
mod scene;
mod sensor;
mod sensors;
mod shown;
mod silhouettes;
mod source;
mod spec;
mod strategies;
mod surroundings;
mod texture;
mod transient;
mod turntable;
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
    use crate::encoded::Encoded;
    #[pymodule_export]
    use crate::inspect::{replay, strategies};
    #[pymodule_export]
    use crate::keyframes::set_keyframes;
    #[pymodule_export]
    use crate::lidar::scan;
    #[pymodule_export]
    use crate::objects::{labels_of, merge, mesh_of, pose, set_category, set_name, set_visibility};
    #[pymodule_export]
    use crate::parts::{Gathering, PartRenderer};
    #[pymodule_export]
    use crate::picture::Picture;
    #[pymodule_export]
    use crate::placed_mesh::PlacedMesh;
    #[pymodule_export]
    use crate::progressive::Progressive;
    #[pymodule_export]
    use crate::reading::{compare, read_cameras, read_picture};
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::sensors::{daylight_coefficients, irradiance, patch_numbers, sunlight};
    #[pymodule_export]
    use crate::silhouettes::silhouettes;
    #[pymodule_export]
    use crate::spec::rows;
    #[pymodule_export]
    use crate::texture::Texture;
    #[pymodule_export]
    use crate::transient::transient;
    #[pymodule_export]
    use crate::turntable::Turntable;
    #[pymodule_export]
    use crate::values::{Grid, IntensityDistribution, Spec};

    /// The licences of Bilux, and of everything in this package that others wrote.
    ///
    /// Example:
    ///     >>> "MIT" in bilux.licenses()
    ///     True
    #[pyfunction]
    fn licenses() -> &'static str {
        include_str!("../../../LICENSES.txt")
    }

    /// Coefficients a to e of the all-weather sky, by clearness, brightness and the zenith angle of the sun in radians.
    #[pyfunction]
    fn perez_coefficients(clearness: f64, brightness: f64, zenith: f64) -> [f64; 5] {
        bilux::scene::lights::perez_coefficients(clearness, brightness, zenith)
    }

    /// Adds the version.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        ending::watch_for_it(module)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

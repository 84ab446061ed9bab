//! Integrators, which estimate the light along a camera ray. One integrator per file; the table is [`INTEGRATORS`].

mod auto;
mod bdpt;
mod cast;
mod cook;
mod light;
mod merging;
mod occlusion;
pub(crate) mod path;
pub(crate) mod pixel_integrator;
mod sppm;
mod vcm;
mod whitted;

use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{Reader, SceneError, Spec};

pub use crate::integrators::pixel_integrator::{Chooser, LightSubpaths, PixelIntegrator};
pub use crate::sampling::camera_rays::CameraSpread;

/// A row of [`INTEGRATORS`].
#[derive(Clone, Copy, Debug)]
pub struct IntegratorEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// The paths from light (L) to eye (E) that it finds, in the notation of [Heckbert 1990]: D for diffuse, G for
    /// glossy and S for specular scattering.
    pub covers: &'static str,
    /// True for Equations 1 and 2, whose intensities have no units; false for radiometry.
    pub classic: bool,
    /// Default number of samples per pixel.
    pub default_spp: u32,
    /// Builds an integrator from its parameters.
    pub build: fn(&Reader) -> Result<Box<dyn PixelIntegrator>, SceneError>,
}

/// When Russian roulette begins, for all integrators that use it.
const ROULETTE_DEPTH: Parameter = Parameter {
    name: "roulette_depth",
    summary: "number of scattering events before Russian roulette starts",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: 1000 },
    default: "4",
};

/// All integrators.
pub static INTEGRATORS: &[IntegratorEntry] = &[
    auto::ENTRY,
    cast::ENTRY,
    whitted::ENTRY,
    cook::ENTRY,
    path::ENTRY,
    light::ENTRY,
    bdpt::ENTRY,
    sppm::ENTRY,
    vcm::ENTRY,
    occlusion::ENTRY,
];

/// The row with this name.
///
/// # Errors
/// When there is none.
pub fn find(name: &str) -> Result<&'static IntegratorEntry, SceneError> {
    find_at(name, &Default::default())
}

/// Builds the integrator that a spec describes.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn build(spec: &Spec) -> Result<Box<dyn PixelIntegrator>, SceneError> {
    let row = find_at(&spec.kind, &spec.span)?;
    (row.build)(&Reader::new(spec, &row.entry)?)
}

/// Names of the integrators whose techniques can be rendered separately.
pub fn with_strategies() -> impl Iterator<Item = &'static str> {
    let has_them = |name: &&str| build(&Spec::new("", name)).is_ok_and(|one| one.has_strategies());
    INTEGRATORS.iter().map(|row| row.entry.name).filter(has_them)
}

/// Names of the integrators whose light can be divided into parts.
pub fn with_light_parts() -> impl Iterator<Item = &'static str> {
    let has_them = |name: &&str| build(&Spec::new("", name)).is_ok_and(|one| one.has_light_parts());
    INTEGRATORS.iter().map(|row| row.entry.name).filter(has_them)
}

fn find_at(name: &str, span: &bilux_scene::parameters::Span) -> Result<&'static IntegratorEntry, SceneError> {
    let names = INTEGRATORS.iter().map(|row| row.entry.name);
    INTEGRATORS
        .iter()
        .find(|row| row.entry.name == name)
        .ok_or_else(|| SceneError::unknown("integrator", name, names, span))
}

//! Names that settings give, which must be those of rows of tables: an unknown one is an error before anything is rendered.

use crate::Error;
use bilux_pictures::TONEMAPS;
use bilux_scene::{Reader, SceneError};
use bilux_transport::integrators::{INTEGRATORS, IntegratorEntry};

pub(super) fn find_integrator(reader: &Reader) -> Result<&'static IntegratorEntry, Error> {
    let name = reader.text("integrator");
    let names = INTEGRATORS.iter().map(|row| row.entry.name);
    let found = INTEGRATORS.iter().find(|row| row.entry.name == name);
    Ok(found.ok_or_else(|| SceneError::unknown("integrator", &name, names, reader.span("integrator")))?)
}

/// A tone curve, or `auto`.
pub(super) fn tone_curve(reader: &Reader) -> Result<String, Error> {
    let name = reader.text("tonemap");
    let known = || TONEMAPS.iter().map(|row| row.entry.name).chain(["auto"]);
    if !known().any(|known| known == name) {
        return Err(SceneError::unknown("tone-mapping curve", &name, known(), reader.span("tonemap")).into());
    }
    Ok(name)
}

//! Media that fill shapes: the same everywhere, or as dense as a grid says.

use crate::FormatError;
use crate::input::diagnostics::Diagnostics;
use crate::input::reading::Reading;
use bilux_math::{DMat4, Rgb, Transform};
use bilux_scene::media::Grid;
use bilux_scene::wavelength::black_body_of_peak_one;
use bilux_scene::{Span, Spec, Value};
use std::sync::Arc;

/// The supported properties of a medium.
#[derive(Clone, Debug, Default)]
pub struct Medium {
    /// Absorption per unit of length; where a grid varies it, where that is 1.
    pub absorption: Rgb,
    /// Scattering per unit of length.
    pub scattering: Rgb,
    /// The mean cosine of Henyey and Greenstein's phase function.
    pub anisotropy: f32,
    /// The factor on both.
    pub density: Option<Density>,
    /// The radiance of a thick layer, and a factor on it.
    pub emission: Rgb,
    pub emission_grid: Option<Density>,
    pub temperature: Option<Temperature>,
}

impl Medium {
    /// True when it changes nothing.
    pub fn is_clear(&self) -> bool {
        self.absorption.is_black() && self.scattering.is_black()
    }

    /// Sets the parameters of a material that it fills.
    pub fn fill(&self, spec: &mut Spec) {
        spec.parameters.set("absorption", self.absorption.clamp(0.0, 1e6));
        if !self.scattering.is_black() {
            spec.parameters.set("scattering", self.scattering.clamp(0.0, 1e6));
            spec.parameters.set("scattering_anisotropy", self.anisotropy.clamp(-0.99, 0.99));
        }
        if !self.emission.is_black() {
            spec.parameters.set("medium_emission", self.emission.clamp(0.0, 1e9));
        }
        if let Some(temperature) = &self.temperature {
            spec.parameters.set("temperature_scale", temperature.scale.min(1e6));
            spec.parameters.set("temperature_norm", "peak");
        }
    }
}

/// Fills a material, which is on a shape with this transform to world space, with a medium.
pub fn fill(
    spec: &mut Spec,
    medium: &Medium,
    to_world: &DMat4,
    at: &Span,
    (reading, diagnostics): (&mut Reading, &mut Diagnostics),
) -> Result<(), FormatError> {
    let is_interface = spec.kind == "interface";
    let is_solid_glass = spec.kind == "dielectric" && spec.parameters.find("thin").is_none();
    if !is_interface && !is_solid_glass {
        let what = "a medium inside is supported only in dielectrics and interfaces";
        diagnostics.note(what, || at.clone());
        return Ok(());
    }
    if !is_interface && (medium.density.is_some() || !medium.emission.is_black()) {
        let what = "a medium that varies or emits light is supported only in interfaces";
        diagnostics.note(what, || at.clone());
        return Ok(());
    }
    medium.fill(spec);
    let temperature = medium.temperature.as_ref().map(|temperature| &temperature.grid);
    let [density, emission] = [&medium.density, &medium.emission_grid].map(Option::as_ref);
    let grids = [("density", density), ("medium_emission_grid", emission), ("temperature", temperature)];
    for (key, grid) in grids {
        let Some(grid) = grid else { continue };
        if let Some(grid) = grid.within(to_world, at, reading)? {
            spec.parameters.set(key, Value::Grid(grid));
        }
    }
    Ok(())
}

/// A grid, and the place of its medium in the world.
#[derive(Clone, Debug)]
pub struct Density {
    pub grid: Arc<Grid>,
    pub to_world: DMat4,
}

impl Density {
    /// True if it is in the same place as a shape with this matrix.
    fn is_placed_as(&self, shape_to_world: &DMat4) -> bool {
        self.to_world == *shape_to_world
    }

    /// A grid in the space of a shape, whose medium has a place of its own in the world; `None` for a shape
    /// without extent.
    pub fn within(
        &self,
        shape_to_world: &DMat4,
        at: &Span,
        reading: &mut Reading,
    ) -> Result<Option<Arc<Grid>>, FormatError> {
        if self.is_placed_as(shape_to_world) {
            return Ok(Some(self.grid.clone()));
        }
        let to_medium = self.grid.to_object().matrix().as_dmat4();
        let to_shape = shape_to_world.inverse() * self.to_world * to_medium;
        let Some(to_shape) = Transform::from_matrix(to_shape) else { return Ok(None) };
        let grid = Grid::clone(&self.grid).placed(&to_shape);
        reading.charge_grid(&grid, &at.file)?;
        Ok(Some(Arc::new(grid)))
    }
}

/// Temperatures of a medium, whose light has the spectrum of a black body with a maximum of 1.
#[derive(Clone, Debug)]
pub struct Temperature {
    pub grid: Density,
    /// Kelvins for each unit.
    pub scale: f32,
}

impl Temperature {
    /// The luminance of its hottest place.
    pub fn brightest(&self) -> f32 {
        black_body_of_peak_one(self.grid.grid.maximum() * self.scale).luminance()
    }
}

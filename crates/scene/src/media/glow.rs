//! Light that a medium emits: fire.
//!
//! What absorbs light emits it, as Kirchhoff's law says: the absorption coefficient times a radiance. It is that of the medium
//! where nobody sees through it, and a small part of it where it is thin.

use crate::bsdf::wavelength::{black_body, black_body_of_peak_one};
use crate::grid::{Grid, GridLine};
use crate::parameters::Reader;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use std::sync::Arc;

/// The radiance of a medium that emits light.
#[derive(Clone, Debug, PartialEq)]
pub struct Glow {
    /// The radiance, in W/(m² sr), where the grids say 1 and the temperature is at its maximum.
    radiance: Rgb,
    /// A factor on it.
    factor: Option<Arc<Grid>>,
    temperature: Option<Temperature>,
}

/// Radiance of a black body by its temperature.
#[derive(Clone, Debug, PartialEq)]
struct Temperature {
    grid: Arc<Grid>,
    /// At equal steps from 0 to the maximum: the colour there, relative to the luminance of the last.
    colours: Vec<Rgb>,
    /// Steps for each unit of the grid.
    steps: f32,
}

/// A line through the grids of a [`Glow`].
#[derive(Clone, Copy, Debug)]
pub struct GlowLine {
    factor: Option<GridLine>,
    temperature: Option<GridLine>,
}

/// Steps of the table of colours.
const STEPS: usize = 256;

impl Glow {
    /// Reads the parameters of emission; `None` where nothing is emitted.
    pub(crate) fn read(reader: &Reader) -> Option<Glow> {
        let radiance = reader.colour(EMISSION.name);
        let scale = reader.number(TEMPERATURE_SCALE.name);
        let spectrum =
            if reader.text(TEMPERATURE_NORM.name) == "peak" { black_body_of_peak_one } else { black_body };
        let temperature = reader.grid(TEMPERATURE.name).map(|grid| Temperature::new(grid, scale, spectrum));
        let glow = Glow { radiance, factor: reader.grid(EMISSION_GRID.name), temperature };
        (!radiance.is_black()).then_some(glow)
    }

    /// One without grids.
    pub fn even(radiance: Rgb) -> Glow {
        Glow { radiance, factor: None, temperature: None }
    }

    /// One with a factor from a grid.
    pub fn of(radiance: Rgb, factor: Arc<Grid>) -> Glow {
        Glow { radiance, factor: Some(factor), temperature: None }
    }

    /// True where it is the same everywhere.
    pub fn is_even(&self) -> bool {
        self.factor.is_none() && self.temperature.is_none()
    }

    /// The grid outside of which nothing is emitted.
    pub(super) fn grid(&self) -> Option<&Grid> {
        self.factor.as_deref().or(self.temperature.as_ref().map(|temperature| &*temperature.grid))
    }

    /// The line of a ray in an object.
    pub(super) fn line(&self, origin: Vec3, direction: Vec3) -> GlowLine {
        let temperature =
            self.temperature.as_ref().map(|temperature| temperature.grid.line(origin, direction));
        GlowLine { factor: self.factor.as_ref().map(|grid| grid.line(origin, direction)), temperature }
    }

    /// The radiance after this distance along a line, in metres.
    pub(super) fn at(&self, line: Option<&GlowLine>, distance: f32) -> Rgb {
        let Some(line) = line else { return self.radiance };
        let mut radiance = self.radiance;
        if let (Some(grid), Some(line)) = (&self.factor, &line.factor) {
            radiance *= grid.at(line, distance);
        }
        if let (Some(temperature), Some(line)) = (&self.temperature, &line.temperature) {
            radiance *= temperature.colour(temperature.grid.at(line, distance));
        }
        radiance
    }
}

impl GlowLine {
    /// The line through the [grid](Glow::grid).
    pub(super) fn through_grid(&self) -> Option<&GridLine> {
        self.factor.as_ref().or(self.temperature.as_ref())
    }
}

impl Temperature {
    /// A grid whose numbers are kelvins over `scale`.
    fn new(grid: Arc<Grid>, scale: f32, spectrum: fn(f32) -> Rgb) -> Temperature {
        let maximum = grid.maximum();
        let hottest = spectrum(maximum * scale).luminance();
        let colour = |step: usize| {
            let kelvin = maximum * scale * step as f32 / STEPS as f32;
            if hottest > 0.0 { spectrum(kelvin) / hottest } else { Rgb::BLACK }
        };
        let steps = if maximum > 0.0 { STEPS as f32 / maximum } else { 0.0 };
        Temperature { colours: (0..=STEPS).map(colour).collect(), grid, steps }
    }

    fn colour(&self, value: f32) -> Rgb {
        let place = (value * self.steps).min(STEPS as f32);
        let step = (place as usize).min(STEPS - 1);
        self.colours[step].lerp(self.colours[step + 1], place - step as f32)
    }
}

pub(crate) const EMISSION: Parameter = Parameter {
    name: "medium_emission",
    summary: "radiance of the inside where it is too thick to see through; it emits this times its absorption per metre: fire",
    unit: "W/(m² sr)",
    kind: ParameterKind::Colour { min: 0.0, max: 1e9 },
    default: "0",
};

pub(crate) const EMISSION_GRID: Parameter = Parameter {
    name: "medium_emission_grid",
    summary: "factor on medium_emission, from a grid",
    unit: "",
    kind: ParameterKind::Grid,
    default: "none",
};

pub(crate) const TEMPERATURE: Parameter = Parameter {
    name: "temperature",
    summary: "grid of temperatures: the inside emits as a black body, medium_emission where it is hottest",
    unit: "",
    kind: ParameterKind::Grid,
    default: "none",
};

pub(crate) const TEMPERATURE_SCALE: Parameter = Parameter {
    name: "temperature_scale",
    summary: "kelvins for each unit of the temperature grid",
    unit: "K",
    kind: ParameterKind::Number { min: 0.0, max: 1e6 },
    default: "1",
};

pub(crate) const TEMPERATURE_NORM: Parameter = Parameter {
    name: "temperature_norm",
    summary: "which maximum counts as 1: of the light of the hottest place, as physics has it; or of each temperature's spectrum (peak), as pbrt has it, where cool fire is brighter",
    unit: "",
    kind: ParameterKind::Choice(&["hottest", "peak"]),
    default: "hottest",
};

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Transform;

    /// Chromaticities of the Planckian locus. [Wyszecki 1982, table I(6.2.2)]
    #[test]
    fn black_bodies_have_the_colours_of_the_planckian_locus() {
        for (kelvin, [x, y]) in
            [(2856.0, [0.4476, 0.4074]), (6500.0, [0.3135, 0.3237]), (10_000.0, [0.2807, 0.2884])]
        {
            let Rgb { r, g, b } = black_body(kelvin);
            let (r, g, b) = (f64::from(r), f64::from(g), f64::from(b));
            let big_x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
            let big_y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
            let big_z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
            let sum = big_x + big_y + big_z;
            let (found_x, found_y) = (big_x / sum, big_y / sum);
            assert!(
                (found_x - x).abs() < 0.012 && (found_y - y).abs() < 0.012,
                "{kelvin}: {found_x}, {found_y}"
            );
        }
        assert_eq!(black_body(0.0), Rgb::BLACK);
    }

    #[test]
    fn what_is_half_as_hot_hardly_glows() {
        let values = [1000.0, 2000.0];
        let grid = Arc::new(Grid::dense("", [2, 1, 1], &Transform::IDENTITY, &values).unwrap());
        let temperature = Temperature::new(grid.clone(), 1.0, black_body);
        assert!((temperature.colour(2000.0).luminance() - 1.0).abs() < 1e-5);
        // By Planck's law at 555 nm it would be 2.3e-6; eyes see longer waves too.
        let cool = temperature.colour(1000.0).luminance();
        assert!(cool > 1e-6 && cool < 1e-4, "{cool}");
        let [warm, hot] = [1600.0, 2000.0].map(|kelvin| temperature.colour(kelvin));
        assert!(warm.g / warm.r < hot.g / hot.r, "what is cooler is redder");
        // By its own peak, a black body half as hot has 2⁵ times as much.
        let by_peak = Temperature::new(grid, 1.0, black_body_of_peak_one).colour(1000.0).luminance();
        assert!((by_peak / cool / 32.0 - 1.0).abs() < 1e-3, "{by_peak} {cool}");
    }

    /// The hottest place has the radiance, whatever a unit of the grid is in kelvins, and others that of a black body beside it.
    #[test]
    fn the_hottest_place_has_the_radiance_at_any_scale() {
        let fill = |_: [usize; 3], block: &mut crate::grid::Block| {
            block[..3].copy_from_slice(&[0.5, 4.0, 2.0]);
            true
        };
        let grid = Arc::new(Grid::new("heat", [3, 1, 1], &Transform::IDENTITY, fill).unwrap());
        for scale in [1.0, 400.0, 700.0] {
            let temperature = Temperature::new(grid.clone(), scale, black_body);
            let hottest = black_body(4.0 * scale).luminance();
            let found = temperature.colour(4.0).luminance();
            assert!(hottest == 0.0 || (found - 1.0).abs() < 1e-5, "{scale}: {found}");
            let (half, wanted) = (temperature.colour(2.0), black_body(2.0 * scale) / hottest.max(1e-30));
            assert!(
                (half.r - wanted.r).abs() < 1e-3 * wanted.r.max(1e-6),
                "{scale}: {half:?}, not {wanted:?}"
            );
        }
    }
}

//! `interface`: the boundary of a medium, without a surface of its own: fog, smoke, a cloud.

use super::{ABSORPTION, Material, MaterialEntry, Nested};
use crate::bsdf::{Bsdf, Dielectric, Lobe};
use crate::classic::ClassicMaterial;
use crate::grid::Grid;
use crate::media::{
    DENSITY, DIAMETER, DRAINE_ALPHA, EMISSION, EMISSION_GRID, Glow, Medium, PHASE, PHASE_ANISOTROPY,
    SCATTERING, TEMPERATURE, TEMPERATURE_NORM, TEMPERATURE_SCALE,
};
use crate::surface::Surface;
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

/// Priority, which an interface has in any case: without one, it would be a surface that others refract against.
const PRIORITY: Parameter = Parameter {
    name: "priority",
    summary: "where media overlap, the one with the higher priority fills the overlap, of equal ones the one inside the \
              other; 0 is the same as 1",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: 1000 },
    default: "0",
};

pub(super) const ENTRY: MaterialEntry = MaterialEntry {
    entry: Entry {
        name: "interface",
        summary: "the boundary of fog, smoke or a cloud, which light passes straight through",
        source: "",
        parameters: &[
            ABSORPTION,
            SCATTERING,
            DENSITY,
            PHASE,
            PHASE_ANISOTROPY,
            DRAINE_ALPHA,
            DIAMETER,
            EMISSION,
            EMISSION_GRID,
            TEMPERATURE,
            TEMPERATURE_SCALE,
            TEMPERATURE_NORM,
            PRIORITY,
        ],
    },
    build: |reader, _| {
        let medium = Medium::read(reader, reader.colour(ABSORPTION.name))?;
        let priority = (reader.integer(PRIORITY.name) as u32).max(1);
        let (density, glow) = (reader.grid(DENSITY.name), Glow::read(reader));
        Ok(Arc::new(Interface { medium, density, glow, priority }))
    },
    principled: None,
};

/// Boundary between sides that are alike.
const NOTHING: Dielectric =
    Dielectric { eta: 1.0, dispersion: 0.0, tint: Rgb::WHITE, thin: true, film: None };

struct Interface {
    medium: Medium<'static>,
    density: Option<Arc<Grid>>,
    glow: Option<Glow>,
    priority: u32,
}

impl Material for Interface {
    fn bsdf(&self, surface: &Surface) -> Bsdf {
        Bsdf::of(surface.n_shade, surface.n_geom, Lobe::Dielectric(NOTHING))
    }

    fn classic(&self, _surface: &Surface) -> ClassicMaterial {
        ClassicMaterial {
            ks: Rgb::BLACK,
            kt: Rgb::WHITE,
            reflectivity: 0.0,
            sigma_a: self.medium.sigma_a,
            ..ClassicMaterial::default()
        }
    }

    fn nested(&self) -> Option<Nested> {
        Some(Nested { priority: self.priority, eta: 1.0, dispersion: 0.0 })
    }

    fn is_interface(&self) -> bool {
        true
    }

    fn medium(&self) -> Option<Medium<'_>> {
        Some(Medium { density: self.density.as_deref(), glow: self.glow.as_ref(), ..self.medium })
    }
}

//! Parameters of the integrators that merge subpaths.

use crate::photons::Merging;
use crate::techniques::TechniqueCounts;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_scene::Reader;

/// The default of [`radius`].
pub(super) const RADIUS: f32 = 0.003;

pub(super) const fn radius(min: f64) -> Parameter {
    Parameter {
        name: "radius",
        summary: "initial merging radius, relative to the scene's radius",
        unit: "",
        kind: ParameterKind::Number { min, max: 1.0 },
        default: "0.003",
    }
}

pub(super) const ALPHA: Parameter = Parameter {
    name: "alpha",
    summary: "how slowly the radius shrinks from iteration to iteration",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 1.0 },
    default: "0.75",
};

pub(super) const LIGHT_PATHS: Parameter = Parameter {
    name: "light_paths",
    summary: "maximum number of light paths per iteration whose vertices are stored",
    unit: "",
    kind: ParameterKind::Integer { min: 1, max: 1 << 26 },
    default: "1048576",
};

/// Whether subpaths are connected with each other, and whether light subpaths are connected with the camera.
pub(super) const CONNECTIONS: Parameter = switch("connections", "connect the vertices of the two subpaths");
pub(super) const SPLATS: Parameter = switch("splats", "connect light paths to the camera");

/// Whether light subpaths look for direct light too where camera subpaths find it well: on surfaces, and in fog with equiangular points, where
/// all lights are always sampled.
pub(super) const DIRECT: Parameter = Parameter {
    name: "direct",
    summary: "also connect and merge light paths that come straight from a light to a surface or into grey, even fog; in coloured fog and \
              smoke, and with more than four lights, this is always done, and where a lamp shines into a cone through fog they are always \
              connected with the camera",
    unit: "",
    kind: ParameterKind::Bool,
    default: "false",
};

const fn switch(name: &'static str, summary: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Bool, default: "true" }
}

pub(super) fn read(reader: &Reader, techniques: TechniqueCounts) -> Merging {
    Merging {
        radius: reader.number("radius"),
        alpha: reader.number("alpha"),
        max_light_paths: reader.integer("light_paths") as u32,
        part: 1.0,
        densest: None,
        roulette_depth: reader.integer("roulette_depth") as u32,
        techniques,
    }
}

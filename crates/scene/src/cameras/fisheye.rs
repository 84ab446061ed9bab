//! `fisheye`: a lens that sees half of everything around it, or more.

use super::CameraEntry;
use super::central;
use super::perspective::{MIRRORED, vector};
use super::pixels::Pixels;
use super::radial::{Lens, Radial};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::DVec2;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice};
use bilux_math::transcendental::{asin_f64, atan2_f64, sin_cos_f64};

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "fisheye",
        summary: "fisheye lens: a circle of up to everything around it, black outside of the circle",
        source: "Miyamoto 1964",
        parameters: &[
            vector("position", "position of the eye", "0 0 5"),
            vector("look_at", "the point at the centre of the picture", "0 0 0"),
            vector("up", "the up direction in the picture", "0 1 0"),
            choice(
                "mapping",
                "how the distance from the centre grows with the angle θ: θ, sin θ/2, tan θ/2 or sin θ",
                &["equidistant", "equisolid", "stereographic", "orthographic"],
                "equidistant",
            ),
            Parameter {
                name: "fov",
                summary: "field of view, from one side of the circle to the other; at most 180 if orthographic",
                unit: "degrees",
                kind: ParameterKind::Number { min: 1.0, max: 359.0 },
                default: "180",
            },
            choice(
                "fit",
                "whether the circle is as wide as the shorter side of the picture, or reaches its corners",
                &["shorter", "diagonal"],
                "shorter",
            ),
            MIRRORED,
        ],
    },
    build: |keys, aspect| central::build(keys, aspect, 0.0, read),
};

fn read(reader: &Reader, aspect: f64) -> Result<Radial<Fisheye>, SceneError> {
    let (mapping, degrees) = (Mapping::of(&reader.text("mapping")), reader.number_f64("fov"));
    if mapping == Mapping::Orthographic && degrees > 180.0 {
        let message =
            "an orthographic fisheye lens sees at most 180 degrees: choose another mapping, or a smaller fov";
        return Err(SceneError::invalid(message, reader.span("fov")));
    }
    let widest = 0.5 * degrees.to_radians();
    let size = DVec2::new(aspect, 1.0);
    let circle = 0.5 * if reader.text("fit") == "diagonal" { size.length() } else { size.min_element() };
    let most = mapping.radius(widest).0;
    let pixels = Pixels::centred(size, DVec2::splat(circle / most));
    Ok(Radial { lens: Fisheye { mapping, widest, most }, pixels, warnings: Vec::new() })
}

struct Fisheye {
    mapping: Mapping,
    widest: f64,
    /// The radius there.
    most: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Mapping {
    Equidistant,
    Equisolid,
    Stereographic,
    Orthographic,
}

impl Mapping {
    fn of(name: &str) -> Mapping {
        match name {
            "equisolid" => Mapping::Equisolid,
            "stereographic" => Mapping::Stereographic,
            "orthographic" => Mapping::Orthographic,
            _ => Mapping::Equidistant,
        }
    }

    /// The radius of an angle, and how it grows.
    fn radius(self, angle: f64) -> (f64, f64) {
        let (sin, cos) = sin_cos_f64(0.5 * angle);
        match self {
            Mapping::Equidistant => (angle, 1.0),
            Mapping::Equisolid => (2.0 * sin, cos),
            Mapping::Stereographic => (2.0 * sin / cos, 1.0 / (cos * cos)),
            Mapping::Orthographic => (2.0 * sin * cos, cos * cos - sin * sin),
        }
    }
}

impl Lens for Fisheye {
    fn radius(&self, angle: f64) -> (f64, f64) {
        self.mapping.radius(angle)
    }

    fn angle(&self, radius: f64) -> Option<f64> {
        if radius > self.most {
            return None;
        }
        Some(match self.mapping {
            Mapping::Equidistant => radius,
            Mapping::Equisolid => 2.0 * asin_f64(0.5 * radius),
            Mapping::Stereographic => 2.0 * atan2_f64(0.5 * radius, 1.0),
            Mapping::Orthographic => asin_f64(radius.min(1.0)),
        })
    }

    fn widest(&self) -> f64 {
        self.widest
    }
}

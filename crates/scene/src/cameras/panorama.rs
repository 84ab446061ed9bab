//! `panorama`: everything around the eye.

use super::CameraEntry;
use super::central::{self, Projection};
use super::perspective::{MIRRORED, vector};
use super::stereo;
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::registry::{Entry, Parameter, ParameterKind, choice};
use bilux_math::transcendental::{asin_f64, atan2_f64, sin_cos_f64, tan_f64};
use bilux_math::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "panorama",
        summary: "panorama: everything around the eye, for viewers, virtual reality and environment maps",
        source: "",
        parameters: &[
            vector("position", "position of the eye", "0 0 5"),
            vector("look_at", "the point at the centre of the picture", "0 0 0"),
            vector("up", "the up direction in the picture", "0 1 0"),
            choice(
                "mapping",
                "equirectangular: longitude and latitude; cylindrical: verticals stay straight; cube: the six faces of a cube in \
                 a row (right, left, up, down, front, back)",
                &["equirectangular", "cylindrical", "cube"],
                "equirectangular",
            ),
            degrees("fov_x", "horizontal field of view; not for cubes", 360.0, "360"),
            degrees("fov", "vertical field of view, below 180 if cylindrical; not for cubes", 180.0, "180"),
            stereo::STEREO,
            stereo::EYE_DISTANCE,
            MIRRORED,
        ],
    },
    build: |keys, aspect| {
        stereo::build(keys, aspect, |keys, aspect, aside| {
            central::build(keys, aspect, aside, |reader, _| Panorama::read(reader))
        })
    },
};

const fn degrees(name: &'static str, summary: &'static str, max: f64, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "degrees", kind: ParameterKind::Number { min: 1.0, max }, default }
}

#[derive(Clone, Copy)]
enum Panorama {
    /// The ranges of longitude and latitude, in radians.
    Equirectangular {
        range: DVec2,
    },
    /// The range of longitude in radians, and the height at distance 1.
    Cylindrical {
        range: DVec2,
    },
    Cube,
}

impl Panorama {
    fn read(reader: &Reader) -> Result<Panorama, SceneError> {
        let [x, y] = ["fov_x", "fov"].map(|key| reader.number_f64(key).to_radians());
        match reader.text("mapping").as_str() {
            "cube" => Ok(Panorama::Cube),
            // What nobody has asked for is what a cylinder can have.
            "cylindrical" if !reader.is_given("fov") => {
                Ok(Panorama::Cylindrical { range: DVec2::new(x, 2.0) })
            }
            "cylindrical" if y > 3.12 => {
                let message = "a cylindrical panorama sees neither up nor down: choose a fov below 179 degrees, such as 90";
                Err(SceneError::invalid(message, reader.span("fov")))
            }
            "cylindrical" => Ok(Panorama::Cylindrical { range: DVec2::new(x, 2.0 * tan_f64(0.5 * y)) }),
            _ => Ok(Panorama::Equirectangular { range: DVec2::new(x, y) }),
        }
    }

    /// Whether its left edge continues at its right edge, and its upper edge on the other side of the pole.
    fn closes(&self) -> [bool; 2] {
        const ALL: f64 = 1.0 - 1e-9;
        match self {
            Panorama::Equirectangular { range } => {
                let around = range.x > ALL * 2.0 * PI;
                [around, around && range.y > ALL * PI]
            }
            Panorama::Cylindrical { range } => [range.x > ALL * 2.0 * PI, false],
            Panorama::Cube => [false; 2],
        }
    }
}

/// The unit direction of a longitude, to the right, and a latitude, downwards.
fn of_angles(longitude: f64, latitude: f64) -> DVec3 {
    let ((sin, cos), (down, along)) = (sin_cos_f64(longitude), sin_cos_f64(latitude));
    DVec3::new(sin * along, down, cos * along)
}

/// The axes of a cube's face: to the right, downwards, and to its middle.
fn face(index: usize) -> [DVec3; 3] {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    [[-z, y, x], [z, y, -x], [x, z, -y], [x, -z, y], [x, y, z], [-x, y, -z]][index]
}

const FACES: usize = 6;

/// The face that a direction goes through.
fn face_of(towards: DVec3) -> usize {
    let size = towards.abs();
    let (axis, along) = match size.max_element() {
        most if most == size.x => (0, towards.x),
        // y is downwards, and the face above comes first.
        most if most == size.y => (1, -towards.y),
        _ => (2, towards.z),
    };
    2 * axis + usize::from(along < 0.0)
}

impl Projection for Panorama {
    fn direction(&self, film: DVec2) -> Option<DVec3> {
        let [around, over_poles] = self.closes();
        let from_middle = film - 0.5;
        match self {
            Panorama::Equirectangular { range } => {
                let at = from_middle * *range;
                let is_seen = (around || at.x.abs() <= PI) && (over_poles || at.y.abs() <= FRAC_PI_2);
                is_seen.then(|| of_angles(at.x, at.y))
            }
            Panorama::Cylindrical { range } => {
                let at = from_middle * *range;
                let (sin, cos) = sin_cos_f64(at.x);
                (around || at.x.abs() <= PI).then(|| DVec3::new(sin, at.y, cos).normalize())
            }
            Panorama::Cube => {
                let is_inside = (0.0..1.0).contains(&film.x) && (0.0..=1.0).contains(&film.y);
                let at = film.x * FACES as f64;
                let [right, down, middle] = face((at.max(0.0) as usize).min(FACES - 1));
                let place = DVec2::new(at - at.floor(), film.y) * 2.0 - 1.0;
                is_inside.then(|| (right * place.x + down * place.y + middle).normalize())
            }
        }
    }

    fn seen(&self, towards: DVec3) -> Option<(DVec2, f64)> {
        let towards = towards.try_normalize()?;
        let aside = DVec2::new(towards.x, towards.z).length();
        match self {
            Panorama::Equirectangular { range } => {
                let at = DVec2::new(atan2_f64(towards.x, towards.z), asin_f64(towards.y.clamp(-1.0, 1.0)));
                Some((at / *range + 0.5, 1.0 / (range.x * range.y * aside)))
            }
            Panorama::Cylindrical { range } => {
                let at = DVec2::new(atan2_f64(towards.x, towards.z), towards.y / aside);
                Some((at / *range + 0.5, 1.0 / (range.x * range.y * aside * aside * aside)))
            }
            Panorama::Cube => {
                let index = face_of(towards);
                let [right, down, middle] = face(index);
                let depth = towards.dot(middle);
                let place = DVec2::new(towards.dot(right), towards.dot(down)) / depth * 0.5 + 0.5;
                let film = DVec2::new((index as f64 + place.x) / FACES as f64, place.y);
                // A face has an area of 4 at distance 1, and a sixth of the film.
                Some((film, 1.0 / (4.0 * FACES as f64 * depth * depth * depth)))
            }
        }
    }

    fn repeats(&self, film: DVec2) -> [Option<DVec2>; 3] {
        let [around, over_poles] = self.closes();
        let other_side =
            |film: DVec2| DVec2::new(if film.x < 0.5 { film.x + 1.0 } else { film.x - 1.0 }, film.y);
        let over = || {
            let x = if film.x < 0.5 { film.x + 0.5 } else { film.x - 0.5 };
            DVec2::new(x, if film.y < 0.5 { -film.y } else { 2.0 - film.y })
        };
        let over = over_poles.then(over);
        [around.then(|| other_side(film)), over, over.map(other_side)]
    }

    fn shape(&self) -> Option<f64> {
        Some(match self {
            Panorama::Equirectangular { range } | Panorama::Cylindrical { range } => range.x / range.y,
            Panorama::Cube => FACES as f64,
        })
    }

    fn height_at(&self, p: DVec3) -> f64 {
        let height = match self {
            Panorama::Equirectangular { range } | Panorama::Cylindrical { range } => range.y,
            Panorama::Cube => 2.0,
        };
        p.length() * height
    }
}

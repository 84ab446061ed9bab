//! `perspective`: a pinhole, or a thin lens if an aperture is given.

use super::lens::{self, ThinLens};
use super::pose::look_f64;
use super::stereo;
use super::{
    Camera, CameraConnection, CameraEntry, CameraKeys, CameraMatrices, CameraSample, Pinhole, around,
    check_changes, look, without_axes,
};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_accel::Ray;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::tan;
use bilux_math::{DVec2, DVec3, Mat4, Vec2, Vec3};
use std::sync::Arc;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "perspective",
        summary: "perspective camera: a pinhole, or a thin lens if it has an aperture",
        source: "",
        parameters: &[
            vector("position", "position of the eye", "0 0 5"),
            vector("look_at", "the point at the centre of the picture", "0 0 0"),
            vector("up", "the up direction in the picture", "0 1 0"),
            Parameter {
                name: "fov",
                summary: "vertical field of view",
                unit: "degrees",
                kind: ParameterKind::Number { min: 0.01, max: 179.0 },
                default: "40",
            },
            Parameter {
                name: "frame",
                summary: "aspect ratio (width over height) that stays fully visible in narrower pictures too; 0 to \
                          fix only the height",
                unit: "",
                kind: ParameterKind::Number { min: 0.0, max: 1000.0 },
                default: "0",
            },
            lens::APERTURE,
            lens::FOCUS,
            lens::BLADES,
            lens::BLADES_ROTATION,
            lens::FOCUS_TILT_X,
            lens::FOCUS_TILT_Y,
            fraction("principal_x", "where the axis meets the picture, from its left edge, in widths", "0.5"),
            fraction(
                "principal_y",
                "where the axis meets the picture, from its upper edge, in heights",
                "0.5",
            ),
            fraction(
                "shift_x",
                "lens shift to the right, in longer sides of the picture, as in Blender",
                "0",
            ),
            fraction("shift_y", "lens shift upwards, in longer sides of the picture, as in Blender", "0"),
            Parameter {
                name: "pixel_aspect",
                summary: "width of a pixel over its height: fy / fx of a camera matrix",
                unit: "",
                kind: ParameterKind::Number { min: 1e-3, max: 1e3 },
                default: "1",
            },
            Parameter {
                name: "skew",
                summary: "by how much the picture leans to the right downwards: s / fx of a camera matrix",
                unit: "",
                kind: ParameterKind::Number { min: -100.0, max: 100.0 },
                default: "0",
            },
            stereo::STEREO,
            stereo::EYE_DISTANCE,
            Parameter {
                name: "convergence",
                summary: "distance at which both eyes of stereo see a point at the same place; 0 for parallel axes",
                unit: "m",
                kind: ParameterKind::Number { min: 0.0, max: 1e9 },
                default: "0",
            },
            MIRRORED,
        ],
    },
    build: |keys, aspect| stereo::build(keys, aspect, build),
};

/// The parameters that keyframes can change.
const CHANGING: &str = "position look_at up fov frame aperture focus blades_rotation focus_tilt_x focus_tilt_y \
                        principal_x principal_y shift_x shift_y skew convergence";

/// Makes the camera of one eye, so many metres to the right in the picture.
fn build(keys: CameraKeys, aspect: f32, aside: f64) -> Result<Arc<dyn Camera>, SceneError> {
    check_changes(keys, CHANGING)?;
    let pixel_aspect = keys.first().map_or(1.0, |(_, reader)| reader.number("pixel_aspect"));
    let aspect = aspect * pixel_aspect;
    let keys = keys
        .iter()
        .map(|(time, reader)| Ok((*time, Key::read(reader, aspect, aside as f32)?)))
        .collect::<Result<Vec<_>, SceneError>>()?;
    let mirrored = keys.first().is_some_and(|(_, key)| key.mirrored);
    let aspect = if mirrored { -aspect } else { aspect };
    let mut camera = Perspective { keys, aspect, static_key: None };
    if camera.keys.len() == 1 {
        camera.static_key = Some(camera.key_at(0.0));
    }
    Ok(Arc::new(camera))
}

pub(super) const fn vector(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "m", kind: ParameterKind::Vector, default }
}

/// A part of the picture's width or height.
const fn fraction(name: &'static str, summary: &'static str, default: &'static str) -> Parameter {
    Parameter { name, summary, unit: "", kind: ParameterKind::Number { min: -100.0, max: 100.0 }, default }
}

pub(super) const MIRRORED: Parameter = Parameter {
    name: "mirrored",
    summary: "mirror left and right, as left-handed cameras do",
    unit: "",
    kind: ParameterKind::Bool,
    default: "false",
};

struct Perspective {
    keys: Vec<(f32, Key)>,
    /// Width of the film over its height; negative when mirrored.
    aspect: f32,
    /// The constant result of [`Perspective::key_at`] when there is only one key.
    static_key: Option<(Key, [Vec3; 3])>,
}

#[derive(Clone, Copy)]
struct Key {
    position: Vec3,
    look_at: Vec3,
    up: Vec3,
    /// Half the height of the film at distance 1.
    tan_half_fov: f32,
    lens: ThinLens,
    /// From the middle between two eyes to this one, to the right of the camera.
    aside: f32,
    /// From the axis to the middle of the film: in half its width to the right, in half its height upwards.
    offset: Vec2,
    /// By how much x grows with y, downwards, on the film at distance 1.
    skew: f32,
    mirrored: bool,
}

impl Key {
    fn read(reader: &Reader, aspect: f32, aside: f32) -> Result<Key, SceneError> {
        let wider = (reader.number("frame") / aspect).max(1.0);
        let [position, look_at, up] = ["position", "look_at", "up"].map(|key| reader.vector(key));
        let (mirrored, convergence) = (reader.bool("mirrored"), reader.number("convergence"));
        let tan_half_fov = tan(reader.number("fov").to_radians() * 0.5) * wider;
        let mut offset = offset(reader, aspect);
        if convergence > 0.0 {
            offset.x -= aside / (convergence * tan_half_fov * aspect);
        }
        let key = Key {
            position,
            look_at,
            up,
            tan_half_fov,
            lens: ThinLens::read(reader, position.distance(look_at))?,
            aside: if mirrored { -aside } else { aside },
            offset,
            skew: reader.number("skew"),
            mirrored,
        };
        look(key.position, key.look_at, key.up).map(|_| key).ok_or_else(|| without_axes(reader))
    }

    fn lerp(&self, other: &Key, t: f32) -> Key {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Key {
            position: self.position.lerp(other.position, t),
            look_at: self.look_at.lerp(other.look_at, t),
            up: self.up.lerp(other.up, t),
            tan_half_fov: mix(self.tan_half_fov, other.tan_half_fov),
            lens: self.lens.lerp(&other.lens, t),
            aside: mix(self.aside, other.aside),
            offset: self.offset.lerp(other.offset, t),
            skew: mix(self.skew, other.skew),
            mirrored: self.mirrored,
        }
    }
}

/// [`Key::offset`] by the principal point and the lens shift, for a film of this width over height.
fn offset(reader: &Reader, aspect: f32) -> Vec2 {
    let of = |x: &str, y: &str| Vec2::new(reader.number(x), reader.number(y));
    let principal = of("principal_x", "principal_y") - 0.5;
    let sides = Vec2::new(aspect, 1.0);
    let shift = of("shift_x", "shift_y") * (sides.max_element() / sides);
    (shift + Vec2::new(-principal.x, principal.y)) * 2.0
}

impl Perspective {
    fn key_at(&self, time: f32) -> (Key, [Vec3; 3]) {
        if let Some(static_key) = self.static_key {
            return static_key;
        }
        let (low, high, t) = around(&self.keys, time);
        let mut key = if t == 0.0 { *low } else { low.lerp(high, t) };
        // Between two valid keyframes the view can become degenerate; the first keyframe is valid.
        let axes = look(key.position, key.look_at, key.up)
            .or_else(|| look(low.position, low.look_at, low.up))
            .unwrap_or([Vec3::X, Vec3::Y, -Vec3::Z]);
        if key.aside != 0.0 {
            [key.position, key.look_at] = [key.position, key.look_at].map(|p| p + axes[0] * key.aside);
        }
        key.lens = key.lens.focused((key.look_at - key.position).length());
        (key, axes)
    }

    /// The camera as it would be without a lens.
    fn pinhole_at(&self, key: &Key, axes: [Vec3; 3]) -> Pinhole {
        let axes = if key.offset == Vec2::ZERO && key.skew == 0.0 { axes } else { self.oblique(key, axes) };
        Pinhole { position: key.position, axes, tan_half_fov: key.tan_half_fov, aspect: self.aspect }
    }
}

impl Perspective {
    /// The frame of a film that is shifted or skewed.
    fn oblique(&self, key: &Key, [right, up, forward]: [Vec3; 3]) -> [Vec3; 3] {
        let up = up + right * self.lean(key);
        let aside = key.offset * Vec2::new(self.aspect, 1.0) * key.tan_half_fov;
        [right, up, forward + right * aside.x + up * aside.y]
    }

    /// By how much x changes with y, upwards, on the film at distance 1.
    fn lean(&self, key: &Key) -> f32 {
        // In a mirrored picture to the right is to the left.
        key.skew * self.aspect.signum()
    }

    /// The point of the film by that of the plane at distance 1, with x to the right and y upwards.
    fn film_of(&self, key: &Key, seen: Vec2) -> Vec2 {
        let x = seen.x - self.lean(key) * seen.y;
        let half = Vec2::new(x / (key.tan_half_fov * self.aspect), -seen.y / key.tan_half_fov);
        (half + Vec2::new(-key.offset.x, key.offset.y)) * 0.5 + 0.5
    }
}

impl Key {
    /// The axes in double precision; those of single precision where there are none.
    fn axes_f64(&self, axes: [Vec3; 3]) -> [DVec3; 3] {
        let [position, look_at, up] = [self.position, self.look_at, self.up].map(Vec3::as_dvec3);
        look_f64(position, look_at, up).unwrap_or(axes.map(Vec3::as_dvec3))
    }

    /// Half the width and the height of the film at distance 1.
    fn half_f64(&self, aspect: f32) -> DVec2 {
        DVec2::new(f64::from(aspect), 1.0) * f64::from(self.tan_half_fov)
    }

    /// Density of rays over area perpendicular to them, at a distance and a cosine to the axis. The film's points are
    /// uniform on the plane at distance 1, stretched by the point on the lens; `1 / cos³` converts their density to solid
    /// angle, there as on the plane of focus.
    fn density(&self, aspect: f32, cos: f32, distance2: f32, stretch: f32) -> f32 {
        let film_area = 4.0 * self.tan_half_fov * self.tan_half_fov * aspect.abs();
        1.0 / (film_area * cos * cos * cos * distance2 * stretch)
    }
}

impl Camera for Perspective {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let (key, axes) = self.key_at(sample.time);
        let pinhole = self.pinhole_at(&key, axes);
        let (origin, direction) = if sample.lens == Vec2::ZERO || key.lens.aperture == 0.0 {
            (key.position, pinhole.direction(sample.film))
        } else {
            let ([right, up, _], point) = (axes, key.lens.point(sample.lens));
            let lens = (right * point.x + up * point.y) * key.lens.aperture;
            let through = pinhole.through(sample.film);
            let depth = key.lens.depth(Vec2::new(through.dot(right), through.dot(up)));
            (key.position + lens, (through * key.lens.focus - lens * depth).normalize())
        };
        Ray { time: sample.time, ..Ray::new(origin.to_array(), direction.to_array()) }
    }

    fn connect(&self, from: Vec3, lens: Vec2, time: f32) -> Option<CameraConnection> {
        let (key, [right, up, forward]) = self.key_at(time);
        let lens = key.lens.point(lens) * key.lens.aperture;
        let p = key.position + right * lens.x + up * lens.y;
        let away = from - p;
        let depth = away.dot(forward);
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let film = self.film_of(&key, key.lens.seen(lens, Vec2::new(away.dot(right), away.dot(up)) / depth));
        let distance2 = away.length_squared();
        let distance = distance2.sqrt();
        let density = key.density(self.aspect, depth / distance, distance2, key.lens.stretch(lens));
        CameraConnection { film, p, wi: -away / distance, density }.if_finite()
    }

    fn density(&self, ray: &Ray, t: f32) -> f32 {
        let (key, [right, up, forward]) = self.key_at(ray.time);
        let cos = Vec3::from(ray.direction).dot(forward);
        let stretch = if key.lens.is_tilted() {
            let point = Vec3::from(ray.origin) - key.position;
            key.lens.stretch(Vec2::new(point.dot(right), point.dot(up)))
        } else {
            1.0
        };
        if cos > 0.0 { key.density(self.aspect, cos, t * t, stretch) } else { 0.0 }
    }

    fn project(&self, p: Vec3, time: f32) -> Option<Vec2> {
        let (key, [right, up, forward]) = self.key_at(time);
        let away = p - key.position;
        let depth = away.dot(forward);
        let (x, y) = (away.dot(right) - self.lean(&key) * away.dot(up), away.dot(up));
        let seen = Vec2::new(x / self.aspect, -y) / (depth * key.tan_half_fov);
        (depth > 0.0).then(|| (seen + Vec2::new(-key.offset.x, key.offset.y)) * 0.5 + 0.5)
    }

    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2> {
        let (key, axes) = self.key_at(time);
        let away = p - key.position.as_dvec3();
        let [x, y, depth] = key.axes_f64(axes).map(|axis| away.dot(axis));
        let (half, offset) = (key.half_f64(self.aspect), key.offset.as_dvec2());
        let seen = DVec2::new(x - f64::from(self.lean(&key)) * y, y) / (depth * half) - offset;
        (depth > 0.0).then(|| seen * DVec2::new(0.5, -0.5) + 0.5)
    }

    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]> {
        let (key, axes) = self.key_at(time);
        let [right, up, forward] = key.axes_f64(axes);
        let half = key.half_f64(self.aspect);
        let seen = ((film - 0.5) * DVec2::new(2.0, -2.0) + key.offset.as_dvec2()) * half;
        let x = seen.x + f64::from(self.lean(&key)) * seen.y;
        Some([key.position.as_dvec3(), (right * x + up * seen.y + forward).normalize()])
    }

    fn matrices(&self, time: f32) -> CameraMatrices {
        let (key, axes) = self.key_at(time);
        let half = 0.5 / key.tan_half_fov;
        // Not minus 0, where nothing leans.
        let leaning = 0.0 - self.lean(&key) * half / self.aspect;
        // The plane at 1 m is at 0, what is infinitely far away at 1.
        let film = Mat4::from_cols_array(&[
            half / self.aspect,
            0.0,
            0.0,
            0.0, //
            leaning,
            -half,
            0.0,
            0.0, //
            0.5 - key.offset.x * 0.5,
            0.5 + key.offset.y * 0.5,
            1.0,
            1.0, //
            0.0,
            0.0,
            -1.0,
            0.0,
        ]);
        CameraMatrices::new(key.position, axes, Some(film))
    }

    fn height_at(&self, p: Vec3, time: f32) -> f32 {
        let (key, [_, _, forward]) = self.key_at(time);
        2.0 * key.tan_half_fov * (p - key.position).dot(forward).abs()
    }

    fn pinhole(&self) -> Option<Pinhole> {
        let (key, axes) = self.static_key.as_ref().filter(|(key, _)| key.lens.aperture == 0.0)?;
        Some(self.pinhole_at(key, *axes))
    }

    fn has_lens(&self) -> bool {
        self.keys.iter().any(|(_, key)| key.lens.aperture != 0.0)
    }

    fn forward(&self, time: f32) -> Vec3 {
        self.key_at(time).1[2]
    }
}

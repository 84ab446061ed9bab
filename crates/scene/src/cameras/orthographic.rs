//! `orthographic`: parallel rays, as in a plan.

use super::perspective::{MIRRORED, vector};
use super::{
    Camera, CameraConnection, CameraEntry, CameraKeys, CameraMatrices, CameraSample, around, check_changes,
    look, without_axes,
};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_accel::Ray;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{DVec2, DVec3, Mat4, Vec2, Vec3};
use std::sync::Arc;

pub(super) const ENTRY: CameraEntry = CameraEntry {
    entry: Entry {
        name: "orthographic",
        summary: "orthographic camera: parallel rays",
        source: "",
        parameters: &[
            vector("position", "the centre of the film", "0 0 5"),
            vector("look_at", "the point at the centre of the picture", "0 0 0"),
            vector("up", "the up direction in the picture", "0 1 0"),
            Parameter {
                name: "height",
                summary: "height of the view",
                unit: "m",
                kind: ParameterKind::Number { min: 1e-9, max: 1e9 },
                default: "2",
            },
            MIRRORED,
        ],
    },
    build: |keys, aspect| Ok(Arc::new(Orthographic::read(keys, aspect)?)),
};

pub(super) struct Orthographic {
    keys: Vec<(f32, Key)>,
    /// The one place of a camera that stands still.
    still: Option<Placed>,
    /// Width over height; negative when mirrored.
    aspect: f32,
    /// [`Camera::receives`].
    receives: bool,
}

#[derive(Clone, Copy)]
struct Key {
    position: Vec3,
    look_at: Vec3,
    up: Vec3,
    half_height: f32,
}

/// A camera at a moment.
#[derive(Clone, Copy)]
struct Placed {
    position: Vec3,
    axes: [Vec3; 3],
    half_height: f32,
}

impl Key {
    fn read(reader: &Reader) -> Result<Key, SceneError> {
        let [position, look_at, up] = ["position", "look_at", "up"].map(|key| reader.vector(key));
        let key = Key { position, look_at, up, half_height: reader.number("height") * 0.5 };
        look(position, look_at, up).map(|_| key).ok_or_else(|| without_axes(reader))
    }

    fn lerp(&self, other: &Key, t: f32) -> Key {
        Key {
            position: self.position.lerp(other.position, t),
            look_at: self.look_at.lerp(other.look_at, t),
            up: self.up.lerp(other.up, t),
            half_height: self.half_height + (other.half_height - self.half_height) * t,
        }
    }
}

impl Orthographic {
    pub(super) fn read(keys: CameraKeys, aspect: f32) -> Result<Orthographic, SceneError> {
        let mirrored = keys.first().is_some_and(|(_, reader)| reader.bool("mirrored"));
        let aspect = if mirrored { -aspect } else { aspect };
        check_changes(keys, "position look_at up height")?;
        let keys = keys
            .iter()
            .map(|(time, reader)| Ok((*time, Key::read(reader)?)))
            .collect::<Result<Vec<_>, SceneError>>()?;
        let mut camera = Orthographic { keys, still: None, aspect, receives: false };
        camera.still = (camera.keys.len() == 1).then(|| camera.placed_at(0.0));
        Ok(camera)
    }

    /// Turns the film into a meter of the light that arrives.
    pub(super) fn receiving(self) -> Orthographic {
        Orthographic { receives: true, ..self }
    }

    fn placed_at(&self, time: f32) -> Placed {
        if let Some(still) = self.still {
            return still;
        }
        let (low, high, t) = around(&self.keys, time);
        let key = if t == 0.0 { *low } else { low.lerp(high, t) };
        // Between two valid keyframes the view can become degenerate; the first keyframe is valid.
        let axes = look(key.position, key.look_at, key.up)
            .or_else(|| look(low.position, low.look_at, low.up))
            .unwrap_or([Vec3::X, Vec3::Y, -Vec3::Z]);
        Placed { position: key.position, axes, half_height: key.half_height }
    }

    /// Rays per area: film points are uniform, and the rays are parallel.
    fn density_of(&self, key: &Placed) -> f32 {
        1.0 / (4.0 * key.half_height * key.half_height * self.aspect.abs())
    }
}

impl Camera for Orthographic {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let Placed { position, axes: [right, up, forward], half_height } = self.placed_at(sample.time);
        let x = (2.0 * sample.film.x - 1.0) * half_height * self.aspect;
        let y = (1.0 - 2.0 * sample.film.y) * half_height;
        let origin = position + right * x + up * y;
        Ray { time: sample.time, ..Ray::new(origin.to_array(), forward.to_array()) }
    }

    fn connect(&self, from: Vec3, _lens: Vec2, time: f32) -> Option<CameraConnection> {
        let key = self.placed_at(time);
        let Placed { position, axes: [right, up, forward], half_height } = key;
        let d = from - position;
        let (x, y, depth) = (d.dot(right), d.dot(up), d.dot(forward));
        if depth <= 0.0 {
            return None;
        }
        let film = Vec2::new(x / (half_height * self.aspect), -y / half_height) * 0.5 + 0.5;
        let p = position + right * x + up * y;
        CameraConnection { film, p, wi: -forward, density: self.density_of(&key) }.if_finite()
    }

    fn density(&self, ray: &Ray, _t: f32) -> f32 {
        self.density_of(&self.placed_at(ray.time))
    }

    fn project(&self, p: Vec3, time: f32) -> Option<Vec2> {
        let Placed { position, axes: [right, up, _], half_height } = self.placed_at(time);
        let away = p - position;
        let seen = Vec2::new(away.dot(right) / self.aspect, -away.dot(up)) / half_height;
        Some(seen * 0.5 + 0.5)
    }

    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2> {
        let Placed { position, axes, half_height } = self.placed_at(time);
        let (away, [right, up, _]) = (p - position.as_dvec3(), axes.map(Vec3::as_dvec3));
        let seen = DVec2::new(away.dot(right) / f64::from(self.aspect), -away.dot(up));
        Some(seen / f64::from(half_height) * 0.5 + 0.5)
    }

    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]> {
        let Placed { position, axes, half_height } = self.placed_at(time);
        let [right, up, forward] = axes.map(Vec3::as_dvec3);
        let aside = (film * 2.0 - 1.0) * DVec2::new(f64::from(self.aspect), -1.0) * f64::from(half_height);
        Some([position.as_dvec3() + right * aside.x + up * aside.y, forward])
    }

    fn matrices(&self, time: f32) -> CameraMatrices {
        let Placed { position, axes, half_height } = self.placed_at(time);
        let half = 0.5 / half_height;
        let film = Mat4::from_cols_array(&[
            half / self.aspect,
            0.0,
            0.0,
            0.0, //
            0.0,
            -half,
            0.0,
            0.0, //
            0.0,
            0.0,
            1.0,
            0.0, //
            0.5,
            0.5,
            0.0,
            1.0,
        ]);
        CameraMatrices::new(position, axes, Some(film))
    }

    fn height_at(&self, _p: Vec3, time: f32) -> f32 {
        2.0 * self.placed_at(time).half_height
    }

    fn receives(&self) -> bool {
        self.receives
    }

    fn has_lens(&self) -> bool {
        false
    }

    fn forward(&self, time: f32) -> Vec3 {
        self.placed_at(time).axes[2]
    }
}

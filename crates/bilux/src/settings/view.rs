//! The settings that move the camera, wherever a file or the studio has put it.
//!
//! A camera that is moved stands upright: its up direction becomes the axis that is nearest to its own. So it can be
//! moved around a scene without tilting the horizon, and two points say everything about it.

use crate::Error;
use bilux_math::Vec3;
use bilux_math::registry::Entry;
use bilux_math::transcendental::{atan, tan};
use bilux_scene::cameras::{CAMERAS, CameraSpec};
use bilux_scene::{Reader, SceneBuilder, SceneError, Value};

/// The value of `eye` and `look_at` that leaves the camera where it is.
pub(super) const OF_CAMERA: &str = "camera";

/// View to which the camera is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The position of the eye, if it is moved.
    pub eye: Option<Vec3>,
    /// The point at the centre of the picture, if it is moved.
    pub look_at: Option<Vec3>,
    /// By how much the picture is magnified.
    pub zoom: f32,
}

impl Default for View {
    fn default() -> View {
        View { eye: None, look_at: None, zoom: 1.0 }
    }
}

impl View {
    /// View that the settings ask for.
    pub(super) fn read(reader: &Reader) -> Result<View, Error> {
        let point = |key: &str| match reader.text(key) {
            text if text == OF_CAMERA => Ok(None),
            text => parse_point(&text).map(Some).ok_or_else(|| {
                let message = format!(
                    "'{text}' is not a point: write X,Y,Z in metres, such as 0,1.5,4, or {OF_CAMERA}"
                );
                SceneError::invalid(message, reader.span(key))
            }),
        };
        Ok(View { eye: point("eye")?, look_at: point("look_at")?, zoom: reader.number("zoom") })
    }

    /// True if it moves the camera or magnifies its picture.
    pub fn is_moved(&self) -> bool {
        *self != View::default()
    }

    /// Moves the camera of this name or number, which then stands still. Does nothing if there is no such camera.
    pub fn place(&self, scene: &mut SceneBuilder, camera: &str) {
        if !self.is_moved() {
            return;
        }
        let by_name = scene.cameras.iter().position(|own| own.spec.name == camera);
        let number = by_name.or_else(|| camera.parse().ok());
        if let Some(own) = number.and_then(|number| scene.cameras.get_mut(number)) {
            self.move_camera(own);
        }
    }

    fn move_camera(&self, camera: &mut CameraSpec) {
        let up = if self.eye.is_some() || self.look_at.is_some() { self.up(camera) } else { None };
        let mut set = |key: &str, value: Value| {
            camera.spec.parameters.set(key, value);
            camera.keyframes.iter_mut().for_each(|(_, changes)| changes.0.retain(|(own, ..)| own != key));
        };
        for (key, point) in [("position", self.eye), ("look_at", self.look_at), ("up", up)] {
            if let Some(point) = point {
                set(key, point.into());
            }
        }
        if self.zoom != 1.0 {
            let Some(row) = CAMERAS.iter().find(|row| row.entry.name == camera.spec.kind) else { return };
            // Wrong values are refused where the camera is built.
            let Ok(reader) = Reader::new(&camera.spec, &row.entry) else { return };
            let values: Vec<_> = magnified(&reader, &row.entry, f64::from(self.zoom))
                .into_iter()
                .map(|(key, value)| {
                    let [least, most] = reader.range(key);
                    (key, value.clamp(least, most))
                })
                .collect();
            for (key, value) in values {
                camera.spec.parameters.set(key, Value::Number(value));
                camera.keyframes.iter_mut().for_each(|(_, changes)| changes.0.retain(|(own, ..)| own != key));
            }
        }
    }
}

impl View {
    /// The axis that is nearest to the camera's own up direction, unless the camera looks along it.
    fn up(&self, camera: &CameraSpec) -> Option<Vec3> {
        let row = CAMERAS.iter().find(|row| row.entry.name == camera.spec.kind)?;
        let reader = Reader::new(&camera.spec, &row.entry).ok()?;
        let own = reader.vector("up");
        let axis = [Vec3::Y, Vec3::Z, Vec3::X]
            .into_iter()
            .reduce(|a, b| if own.dot(b).abs() > own.dot(a).abs() { b } else { a })?;
        let eye = self.eye.unwrap_or(reader.vector("position"));
        let ahead = self.look_at.unwrap_or(reader.vector("look_at")) - eye;
        let is_along = axis.cross(ahead).length() <= 1e-4 * ahead.length();
        (!is_along).then_some(axis * own.dot(axis).signum())
    }
}

/// The parameters of a camera whose picture is magnified by a factor: each kind of camera has some of these.
fn magnified(reader: &Reader, entry: &Entry, zoom: f64) -> Vec<(&'static str, f64)> {
    let has = |key: &str| entry.parameters.iter().any(|p| p.name == key);
    if has("fx") {
        // Around the middle of the picture, where the axis need not be.
        let away = |key: &str, side: &str| {
            let middle = 0.5 * (reader.number_f64(side) - 1.0);
            middle + (reader.number_f64(key) - middle) * zoom
        };
        let scaled = ["fx", "fy", "skew"].map(|key| (key, reader.number_f64(key) * zoom));
        return scaled
            .into_iter()
            .chain([("cx", away("cx", "width")), ("cy", away("cy", "height"))])
            .collect();
    }
    match has("fov") {
        // Angles of half a circle and more have no tangents.
        true if entry.name != "perspective" => vec![("fov", reader.number_f64("fov") / zoom)],
        true => vec![("fov", f64::from(narrowed(reader.number("fov"), zoom as f32)))],
        false => vec![("height", f64::from(reader.number("height") / zoom as f32))],
    }
}

/// A field of view in degrees, of a picture that is magnified by a factor.
fn narrowed(degrees: f32, zoom: f32) -> f32 {
    2.0 * atan(tan(degrees.to_radians() * 0.5) / zoom).to_degrees()
}

/// Parses `X,Y,Z`.
fn parse_point(text: &str) -> Option<Vec3> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let point = Vec3::from(<[f32; 3]>::try_from(numbers?).ok()?);
    point.is_finite().then_some(point)
}

//! Cameras. Each camera has its own file; the table is [`CAMERAS`].

mod central;
mod fisheye;
mod irradiance;
mod lens;
mod opencv;
mod opencv_fisheye;
mod orthographic;
mod panorama;
mod perspective;
mod pinhole;
mod pixels;
mod pose;
mod radial;
mod sensor_points;
mod stereo;

pub use pinhole::Pinhole;
pub use sensor_points::{SensorPoint, SensorPoints};

use crate::messages::error::SceneError;
use crate::parameters::{Parameters, Reader, Spec};
use bilux_accel::Ray;
use bilux_math::glam::Vec4;
use bilux_math::registry::Entry;
use bilux_math::{DVec2, DVec3, Mat4, Vec2, Vec3};
use std::sync::Arc;

/// A sample of the film, the lens and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSample {
    /// Point of the film, 0..=1 on both axes, y downwards.
    pub film: Vec2,
    /// Point on the unit disc, to be scaled by the aperture; zero for a pinhole.
    pub lens: Vec2,
    /// When, in seconds.
    pub time: f32,
}

/// A connection from a point of the scene to the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraConnection {
    /// Point of the film's plane, as in [`CameraSample`]; off the film where it is outside 0..1. Pixel filters reach beyond
    /// the film's edge.
    pub film: Vec2,
    /// Point on the lens (on the film, for parallel rays) that sees it.
    pub p: Vec3,
    /// Unit direction from the point of the scene to there.
    pub wi: Vec3,
    /// Density of camera rays at the point of the scene, over area perpendicular to `wi`, 1/m², for film points uniform
    /// over the unit square and this point on the lens; of two eyes, over the part of this one. It is the camera's importance, for
    /// a film of area 1.
    pub density: f32,
}

/// Matrices with which compositors place points of the world in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraMatrices {
    /// To the space of the camera: x to the right, y upwards, z forwards, in metres.
    pub to_camera: Mat4,
    /// To the film, 0..=1 on both axes, y downwards, with z and w for the division by w. \[OpenEXR\] `None` where straight lines
    /// are curved in the picture: no matrix does that.
    pub to_film: Option<Mat4>,
}

impl CameraMatrices {
    /// Matrices of a camera at a position with these axes, whose film is given in the camera's own space.
    fn new(position: Vec3, [right, up, forward]: [Vec3; 3], film: Option<Mat4>) -> CameraMatrices {
        let rotation = Mat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), Vec4::W);
        let to_camera = rotation.transpose() * Mat4::from_translation(-position);
        CameraMatrices { to_camera, to_film: film.map(|film| film * to_camera) }
    }
}

impl CameraConnection {
    /// Whether its point is on the film.
    pub fn is_on_film(&self) -> bool {
        let inside = |x: f32| (0.0..1.0).contains(&x);
        inside(self.film.x) && inside(self.film.y)
    }

    /// The connection, if its numbers are finite.
    fn if_finite(self) -> Option<CameraConnection> {
        (self.film.is_finite() && self.density.is_finite()).then_some(self)
    }
}

/// Something that turns points of the film into rays.
pub trait Camera: Send + Sync {
    /// The ray of a sample. Its direction is of unit length, or zero ([`Ray::is_nowhere`]) where nothing reaches the film, as
    /// beyond the circle of a fisheye lens.
    fn ray(&self, sample: &CameraSample) -> Ray;
    /// Connects a point of the scene through a point on the lens (as in [`CameraSample`]) at a time in seconds.
    ///
    /// This is the inverse of [`Camera::ray`], off the film too. `None` when no ray sees the point, as behind the camera.
    fn connect(&self, from: Vec3, lens: Vec2, time: f32) -> Option<CameraConnection>;
    /// Points beside the film whose ray is that of a point on the film: a panorama begins again at its edges, and pixel filters
    /// reach there.
    fn repeats(&self, _film: Vec2) -> [Option<Vec2>; 3] {
        [None; 3]
    }
    /// The point on the lens with which [`Camera::connect`] finds the ray through this point of the film and this point on the lens:
    /// another one only if the camera has two eyes, which are parts of one lens.
    fn lens_of(&self, _film: Vec2, lens: Vec2) -> Vec2 {
        lens
    }
    /// [`CameraConnection::density`] at distance `t` along one of its rays (of unit direction).
    fn density(&self, ray: &Ray, t: f32) -> f32;
    /// The point of the film at which a point of the scene is seen through the middle of the lens, also where that is off
    /// the film. `None` where no ray sees it, as behind the camera. Of two eyes, it is the left one that sees it.
    fn project(&self, p: Vec3, time: f32) -> Option<Vec2>;
    /// [`Camera::project`] in double precision, for those who measure in pictures.
    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2>;
    /// [`Camera::project_f64`] for the eye that sees another point of the film.
    fn project_beside(&self, p: DVec3, time: f32, _film: DVec2) -> Option<DVec2> {
        self.project_f64(p, time)
    }
    /// The ray through a point of the film and the middle of the lens in double precision: where it starts, and its unit
    /// direction. `None` where the film sees nothing.
    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]>;
    /// The transforms of points in the world at a time in seconds.
    fn matrices(&self, time: f32) -> CameraMatrices;
    /// The height of the film's view at a point, in metres perpendicular to the axis, at a time in seconds. Divided by
    /// the number of pixel rows, it is the width of a pixel there. Where pixels differ, as in a panorama, it is that of those in
    /// the middle.
    fn height_at(&self, p: Vec3, time: f32) -> f32;
    /// The camera as a pinhole that does not move, if it is one: many of its rays can be computed at once.
    fn pinhole(&self) -> Option<Pinhole> {
        None
    }
    /// True for a meter instead of an eye: a pixel shows the light that arrives where its rays begin, on the side to which they go,
    /// over π. That is the radiance of white matt paper there, which faces along the ray and shades nothing.
    fn receives(&self) -> bool {
        false
    }
    /// The width over height of pictures that show all as it is, if others show it stretched.
    fn shape(&self) -> Option<f64> {
        None
    }
    /// Warnings for users about the picture: each is a sentence.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
    /// True when its rays depend on [`CameraSample::lens`].
    fn has_lens(&self) -> bool;
    /// The viewing direction, a unit vector, at a time in seconds.
    fn forward(&self, time: f32) -> Vec3;
}

/// A camera's parameters over time: one row, or one for every keyframe.
pub type CameraKeys<'a> = &'a [(f32, Reader<'a>)];

/// A row of [`CAMERAS`].
#[derive(Clone, Copy, Debug)]
pub struct CameraEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from its keyframes (at least one, times rising) and the film's width over its height.
    pub build: fn(CameraKeys, f32) -> Result<Arc<dyn Camera>, SceneError>,
}

/// All cameras.
pub static CAMERAS: &[CameraEntry] = &[
    perspective::ENTRY,
    orthographic::ENTRY,
    irradiance::ENTRY,
    fisheye::ENTRY,
    panorama::ENTRY,
    opencv::ENTRY,
    opencv_fisheye::ENTRY,
];

/// A camera as a scene describes it: a spec, and the changes at keyframes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraSpec {
    /// Kind and parameters.
    pub spec: Spec,
    /// Times in seconds, in ascending order, each with the parameters that differ from the spec's.
    pub keyframes: Vec<(f32, Parameters)>,
}

impl CameraSpec {
    /// A camera that does not move.
    pub fn new(spec: impl Into<Spec>) -> CameraSpec {
        CameraSpec { spec: spec.into(), keyframes: Vec::new() }
    }

    /// The width and height in pixels of the pictures that it was calibrated with, if its parameters are in pixels.
    pub fn calibrated_size(&self) -> Option<[u32; 2]> {
        let row = CAMERAS.iter().find(|row| row.entry.name == self.spec.kind)?;
        row.entry.parameters.iter().find(|parameter| parameter.name == "fx")?;
        let reader = Reader::new(&self.spec, &row.entry).ok()?;
        Some(["width", "height"].map(|side| reader.integer(side) as u32))
    }
}

/// Makes the camera that a spec describes, for a film of this width over height.
///
/// # Errors
/// When no row has its kind, or a parameter is wrong.
pub fn build(camera: &CameraSpec, aspect: f32) -> Result<Arc<dyn Camera>, SceneError> {
    let names = CAMERAS.iter().map(|row| row.entry.name);
    let row = CAMERAS
        .iter()
        .find(|row| row.entry.name == camera.spec.kind)
        .ok_or_else(|| SceneError::unknown("camera", &camera.spec.kind, names, &camera.spec.span))?;
    let mut keys: Vec<(f32, Spec)> = camera
        .keyframes
        .iter()
        .map(|(time, changes)| {
            let mut spec = camera.spec.clone();
            for (key, value, span) in &changes.0 {
                spec.parameters.set_at(key, value.clone(), span.clone());
            }
            (*time, spec)
        })
        .collect();
    if keys.is_empty() {
        keys.push((0.0, camera.spec.clone()));
    }
    if keys.windows(2).any(|pair| pair[0].0 >= pair[1].0 || pair[1].0.is_nan()) {
        return Err(SceneError::invalid(
            "the times of a camera's keyframes must increase: put them in order, each once",
            &camera.spec.span,
        ));
    }
    let readers = keys
        .iter()
        .map(|(time, spec)| Ok((*time, Reader::new(spec, &row.entry)?)))
        .collect::<Result<Vec<_>, SceneError>>()?;
    (row.build)(&readers, aspect)
}

/// The two keyframes around a time, and its fraction of the way between them.
fn around<K>(keys: &[(f32, K)], time: f32) -> (&K, &K, f32) {
    let after = keys.partition_point(|(t, _)| *t <= time);
    let (low, high) = (after.saturating_sub(1), after.min(keys.len() - 1));
    let (t0, t1) = (keys[low].0, keys[high].0);
    let fraction = if t1 > t0 { ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 };
    (&keys[low].1, &keys[high].1, fraction)
}

/// Refuses keyframes of parameters other than those that may change over time, whose names have spaces between them.
fn check_changes(keys: CameraKeys, may_change: &str) -> Result<(), SceneError> {
    let may_change: Vec<&str> = may_change.split(' ').collect();
    let Some((_, first)) = keys.first() else { return Ok(()) };
    let Some(key) = keys.iter().find_map(|(_, other)| other.differs(first, &may_change)) else {
        return Ok(());
    };
    let message = format!("the camera's {key} cannot change over time: leave it out of the keyframes");
    Err(SceneError::invalid(message, first.span(key)))
}

/// Error of a camera that has no axes.
fn without_axes(reader: &Reader) -> SceneError {
    let message = "a camera must not look along its own up direction, nor at its own position: one that looks straight down needs \
                   another up, such as [0, 0, -1]";
    SceneError::invalid(message, reader.span("look_at"))
}

/// The right, up and forward axes of a camera that looks from one point to another.
fn look(position: Vec3, look_at: Vec3, up: Vec3) -> Option<[Vec3; 3]> {
    let forward = (look_at - position).try_normalize()?;
    let right = forward.cross(up).try_normalize()?;
    Some([right, right.cross(forward), forward])
}

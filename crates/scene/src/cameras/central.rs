//! A camera all of whose rays start at one point, or on the circle of an eye that looks around, and a map between their directions and its film: what cameras of that kind
//! share.

use super::pose::{Pose, Poses};
use super::{Camera, CameraConnection, CameraKeys, CameraMatrices, CameraSample, Pinhole, check_changes};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_accel::Ray;
use bilux_math::glam::DMat3;
use bilux_math::{DVec2, DVec3, Mat4, Vec2, Vec3};
use std::sync::Arc;

/// A map between directions and points of the film (0..=1 on both axes, y downwards), one to one. Directions are in the space
/// of the camera: x to the right, y downwards, z forwards. Both ends of light's paths use it, so the two functions have to be
/// inverse to each other, off the film too.
pub(super) trait Projection: Send + Sync + 'static {
    /// The unit direction that a point of the film's plane sees, if it sees any.
    fn direction(&self, film: DVec2) -> Option<DVec3>;
    /// Point of the film that sees a direction of any length except zero, and the film's area per solid angle there, in 1/sr.
    fn seen(&self, towards: DVec3) -> Option<(DVec2, f64)>;
    /// [`Camera::repeats`].
    fn repeats(&self, _film: DVec2) -> [Option<DVec2>; 3] {
        [None; 3]
    }
    /// The matrix from directions to points of the film with w for the division by w, if there is one.
    fn matrix(&self) -> Option<DMat3> {
        None
    }
    /// [`Camera::height_at`] for a point of the camera's space.
    fn height_at(&self, p: DVec3) -> f64;
    /// [`Camera::shape`].
    fn shape(&self) -> Option<f64> {
        None
    }
    /// [`Camera::warnings`].
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Such a camera.
pub(super) struct Central<P> {
    poses: Poses,
    projection: P,
    /// From the middle to the eye, in metres to the right of the direction in which it looks: it turns with the head
    /// [Ishiguro 1992].
    aside: f64,
    /// This camera as a pinhole, if it stands still and straight lines stay straight.
    pinhole: Option<Pinhole>,
}

/// Makes such a camera by its parameters, of which only `position`, `look_at` and `up` can change over time.
pub(super) fn build<P: Projection>(
    keys: CameraKeys,
    aspect: f32,
    aside: f64,
    read: impl Fn(&Reader, f64) -> Result<P, SceneError>,
) -> Result<Arc<dyn Camera>, SceneError> {
    let poses = Poses::read(keys)?;
    let (_, reader) = keys.first().ok_or_else(|| SceneError::invalid("no keyframes", &Default::default()))?;
    check_changes(keys, "position look_at up")?;
    let projection = read(reader, f64::from(aspect))?;
    let pinhole = poses.still().zip(projection.matrix()).map(|(pose, matrix)| pinhole(pose, matrix));
    Ok(Arc::new(Central { poses, projection, aside, pinhole }))
}

/// The pinhole of a matrix from directions to the film.
fn pinhole(pose: &Pose, matrix: DMat3) -> Pinhole {
    let at_distance_1 = |film: DVec2| {
        let towards = matrix.inverse() * film.extend(1.0);
        pose.to_world(towards / towards.z)
    };
    let middle = at_distance_1(DVec2::splat(0.5));
    let right = at_distance_1(DVec2::new(1.0, 0.5)) - middle;
    let up = at_distance_1(DVec2::new(0.5, 0.0)) - middle;
    let axes = [right, up, middle].map(|axis| axis.as_vec3());
    Pinhole { position: pose.position.as_vec3(), axes, tan_half_fov: 1.0, aspect: 1.0 }
}

impl<P: Projection> Central<P> {
    /// Point of the film at which a point is seen from a pose, the density there, and its distance and direction in the world.
    fn seen(&self, pose: &Pose, p: DVec3) -> Option<(DVec2, f64, f64, DVec3)> {
        let away = p - pose.position;
        let towards = self.towards(pose.to_camera(away))?;
        let distance = towards.length();
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let (film, density) = self.projection.seen(towards)?;
        let away = if self.aside == 0.0 { away } else { pose.to_world(towards) };
        // Next to an eye that turns, neighbouring rays are as far apart as next to one that does not: turning moves it along
        // its rays.
        film.is_finite().then_some((film, density / (distance * distance), distance, away / distance))
    }

    /// From the eye that sees it to a point of the camera's space.
    fn towards(&self, p: DVec3) -> Option<DVec3> {
        if self.aside == 0.0 {
            return Some(p);
        }
        // The right angle between what is aside and what is ahead.
        let level = DVec2::new(p.x, p.z);
        let ahead = (level.length_squared() - self.aside * self.aside).sqrt();
        let to = (level * ahead - DVec2::new(level.y, -level.x) * self.aside) / level.length_squared();
        (ahead > 0.0).then(|| DVec3::new(to.x * ahead, p.y, to.y * ahead))
    }

    /// Position of the eye that looks in a direction of the camera's space.
    fn eye(&self, pose: &Pose, towards: DVec3) -> DVec3 {
        let level = DVec2::new(towards.x, towards.z).try_normalize();
        let Some(level) = level.filter(|_| self.aside != 0.0) else { return pose.position };
        pose.position + pose.to_world(DVec3::new(level.y, 0.0, -level.x) * self.aside)
    }
}

impl<P: Projection> Camera for Central<P> {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let (position, direction) = match &self.pinhole {
            Some(pinhole) => (pinhole.position, pinhole.direction(sample.film)),
            None => {
                let pose = self.poses.at(sample.time);
                let direction = self.projection.direction(sample.film.as_dvec2());
                let eye = direction.map_or(pose.position, |direction| self.eye(&pose, direction));
                (eye.as_vec3(), direction.map_or(Vec3::ZERO, |d| pose.to_world(d).as_vec3()))
            }
        };
        Ray { time: sample.time, ..Ray::new(position.to_array(), direction.to_array()) }
    }

    fn connect(&self, from: Vec3, _lens: Vec2, time: f32) -> Option<CameraConnection> {
        let pose = self.poses.at(time);
        let (film, density, distance, direction) = self.seen(&pose, from.as_dvec3())?;
        let eye = if self.aside == 0.0 { pose.position } else { from.as_dvec3() - direction * distance };
        let (film, density, wi) = (film.as_vec2(), density as f32, -direction.as_vec3());
        CameraConnection { film, p: eye.as_vec3(), wi, density }.if_finite()
    }

    fn repeats(&self, film: Vec2) -> [Option<Vec2>; 3] {
        self.projection.repeats(film.as_dvec2()).map(|film| film.map(|film| film.as_vec2()))
    }

    fn density(&self, ray: &Ray, t: f32) -> f32 {
        let towards = self.poses.at(ray.time).to_camera(Vec3::from(ray.direction).as_dvec3());
        let seen = if towards == DVec3::ZERO { None } else { self.projection.seen(towards) };
        seen.map_or(0.0, |(_, density)| (density / (f64::from(t) * f64::from(t))) as f32)
    }

    fn project(&self, p: Vec3, time: f32) -> Option<Vec2> {
        Some(self.project_f64(p.as_dvec3(), time)?.as_vec2())
    }

    fn project_f64(&self, p: DVec3, time: f32) -> Option<DVec2> {
        Some(self.seen(&self.poses.at(time), p)?.0)
    }

    fn ray_f64(&self, film: DVec2, time: f32) -> Option<[DVec3; 2]> {
        let pose = self.poses.at(time);
        let direction = self.projection.direction(film)?;
        Some([self.eye(&pose, direction), pose.to_world(direction)])
    }

    fn matrices(&self, time: f32) -> CameraMatrices {
        let Pose { position, axes: [right, down, forward] } = self.poses.at(time);
        let sign = if self.poses.mirrored { -1.0 } else { 1.0 };
        let axes = [right * sign, -down, forward].map(|axis| axis.as_vec3());
        let film = self.projection.matrix().map(|matrix| {
            let [x, y, z] = [matrix.x_axis * sign, -matrix.y_axis, matrix.z_axis].map(|axis| axis.as_vec3());
            let column = |v: Vec3, depth: f32| [v.x, v.y, depth, v.z];
            // The plane at 1 m is at 0, what is infinitely far away at 1.
            Mat4::from_cols_array_2d(&[column(x, 0.0), column(y, 0.0), column(z, 1.0), [0.0, 0.0, -1.0, 0.0]])
        });
        CameraMatrices::new(position.as_vec3(), axes, film)
    }

    fn height_at(&self, p: Vec3, time: f32) -> f32 {
        let pose = self.poses.at(time);
        self.projection.height_at(pose.to_camera(p.as_dvec3() - pose.position)) as f32
    }

    fn pinhole(&self) -> Option<Pinhole> {
        self.pinhole
    }

    fn shape(&self) -> Option<f64> {
        self.projection.shape()
    }

    fn warnings(&self) -> Vec<String> {
        self.projection.warnings()
    }

    fn has_lens(&self) -> bool {
        false
    }

    fn forward(&self, time: f32) -> Vec3 {
        self.poses.at(time).axes[2].as_vec3()
    }
}

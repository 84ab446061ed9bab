//! Points that receive light: not a row of the table, as they come from programs.

use super::{Camera, CameraConnection, CameraMatrices, CameraSample};
use bilux_accel::Ray;
use bilux_math::{DVec2, DVec3, Mat4, Vec2, Vec3};

/// A point that receives light, on the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPoint {
    /// In metres.
    pub p: Vec3,
    /// A unit vector.
    pub normal: Vec3,
}

/// A camera with a pixel for each of some points: what the point [receives](Camera::receives). Pixels are to be filtered by
/// boxes.
pub struct SensorPoints {
    points: Vec<SensorPoint>,
    size: [u32; 2],
}

impl SensorPoints {
    /// A film that is about square.
    pub fn new(points: Vec<SensorPoint>) -> SensorPoints {
        let width = (points.len() as f64).sqrt().ceil().max(1.0) as u32;
        let height = (points.len() as u64).div_ceil(u64::from(width)).max(1) as u32;
        SensorPoints { points, size: [width, height] }
    }

    /// The width and the height of its film in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The points, row by row of the film. Pixels at its end have none.
    pub fn points(&self) -> &[SensorPoint] {
        &self.points
    }

    /// The column and the row of a point.
    pub fn pixel(&self, point: usize) -> [u32; 2] {
        [point as u32 % self.size[0], point as u32 / self.size[0]]
    }

    /// The point of a place on the film.
    fn point(&self, film: DVec2) -> Option<&SensorPoint> {
        let [width, height] = self.size;
        let at = |x: f64, side: u32| ((x * f64::from(side)).max(0.0) as usize).min(side as usize - 1);
        self.points.get(at(film.y, height) * width as usize + at(film.x, width))
    }
}

impl Camera for SensorPoints {
    fn ray(&self, sample: &CameraSample) -> Ray {
        let seen = self.point(sample.film.as_dvec2());
        let [p, direction] = seen.map_or([Vec3::ZERO; 2], |point| [point.p, point.normal]);
        Ray { time: sample.time, ..Ray::new(p.to_array(), direction.to_array()) }
    }

    /// No ray comes to a point by chance.
    fn connect(&self, _from: Vec3, _lens: Vec2, _time: f32) -> Option<CameraConnection> {
        None
    }

    fn receives(&self) -> bool {
        true
    }

    fn density(&self, _ray: &Ray, _t: f32) -> f32 {
        0.0
    }

    fn project(&self, _p: Vec3, _time: f32) -> Option<Vec2> {
        None
    }

    fn project_f64(&self, _p: DVec3, _time: f32) -> Option<DVec2> {
        None
    }

    fn ray_f64(&self, film: DVec2, _time: f32) -> Option<[DVec3; 2]> {
        self.point(film).map(|point| [point.p.as_dvec3(), point.normal.as_dvec3()])
    }

    fn matrices(&self, _time: f32) -> CameraMatrices {
        CameraMatrices { to_camera: Mat4::IDENTITY, to_film: None }
    }

    fn height_at(&self, _p: Vec3, _time: f32) -> f32 {
        0.0
    }

    fn has_lens(&self) -> bool {
        false
    }

    fn forward(&self, _time: f32) -> Vec3 {
        self.points.first().map_or(Vec3::Y, |point| point.normal)
    }
}

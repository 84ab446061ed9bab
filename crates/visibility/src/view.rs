//! The eye and its pixels.

use crate::result::BACKGROUND;
use bilux_accel::Accelerator;
use bilux_accel::triangle::PreparedRay;
use bilux_accel::{Culling, Query, Ray};
use bilux_math::{DVec3, transcendental};

/// An eye and the directions from it through the centres of a rectangle of pixels.
#[derive(Clone, Debug)]
pub struct View {
    eye: [f32; 3],
    width: usize,
    height: usize,
    directions: Vec<[f32; 3]>,
    t_min: f32,
    /// Right, down and forward: orthonormal, world coordinates.
    pub(crate) axes: [DVec3; 3],
    pub(crate) columns: Lanes,
    pub(crate) rows: Lanes,
    /// The maximum component along `forward` of any direction.
    pub(crate) deepest: f64,
}

/// Why a view cannot be created.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The number of directions is not that of the pixels.
    #[error("a view of {width}×{height} pixels needs {} directions, not {count}", width * height)]
    DirectionCount {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The number of directions given.
        count: usize,
    },
    /// There are no pixels, or too many.
    #[error("a view of {0}×{1} pixels is not possible: it needs at least one and at most 16,777,216")]
    Size(usize, usize),
    /// The eye is not a finite point.
    #[error("the eye of a view must be a finite point, not {0:?}")]
    Eye([f32; 3]),
    /// The minimum distance is negative or not finite.
    #[error("the minimum distance of a view must be finite and not negative, not {0}")]
    Near(f32),
    /// No plane has all directions in front of it.
    #[error("the directions of a view must all lie in front of the eye; split a wider view into several")]
    TooWide,
    /// The pinhole camera has no direction.
    #[error(
        "a pinhole view needs two distinct finite points (the eye and the target), an up direction that is not \
         parallel to the line between them, and a field of view between 0 and 180 degrees"
    )]
    Pinhole,
}

/// Maximum number of pixels in a view.
const MAX_PIXELS: usize = 1 << 24;

impl View {
    /// Creates a view from directions through the pixel centres, row by row from the top. They need not have unit
    /// length; `t_min` (0 or more) is measured in their lengths. Pixels whose direction is not finite, or zero, see
    /// nothing.
    ///
    /// # Errors
    /// Returns an error when sizes do not match or are out of range, or the directions do not lie in one half-space.
    pub fn new(
        eye: [f32; 3],
        width: usize,
        height: usize,
        directions: Vec<[f32; 3]>,
        t_min: f32,
    ) -> Result<View, ViewError> {
        check_size(width, height)?;
        if directions.len() != width * height {
            return Err(ViewError::DirectionCount { width, height, count: directions.len() });
        }
        if !eye.iter().all(|c| c.is_finite()) {
            return Err(ViewError::Eye(eye));
        }
        if !(t_min >= 0.0 && t_min.is_finite()) {
            return Err(ViewError::Near(t_min));
        }
        let axes = axes_of(&directions, width, height);
        let [right, down, forward] = axes;
        let (mut columns, mut rows) = (Lanes::new(width), Lanes::new(height));
        let mut deepest = 0f64;
        for (pixel, direction) in usable(&directions) {
            let z = direction.dot(forward);
            let is_ahead = z > direction.length() * MIN_COSINE;
            if !is_ahead {
                return Err(ViewError::TooWide);
            }
            deepest = deepest.max(z);
            columns.include(pixel % width, direction.dot(right) / z);
            rows.include(pixel / width, direction.dot(down) / z);
        }
        columns.finish();
        rows.finish();
        Ok(View { eye, width, height, directions, t_min, axes, columns, rows, deepest })
    }

    /// A pinhole camera: `vertical_fov_degrees` is between the upper edge of the uppermost pixels and the
    /// lower edge of the lowermost, and pixels are square.
    ///
    /// # Errors
    /// As [`View::new`], and when the camera has no direction or a field of view that is not valid.
    pub fn pinhole(
        eye: [f32; 3],
        look_at: [f32; 3],
        up: [f32; 3],
        vertical_fov_degrees: f32,
        width: usize,
        height: usize,
    ) -> Result<View, ViewError> {
        check_size(width, height)?;
        let point = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        let forward = (point(look_at) - point(eye)).try_normalize().ok_or(ViewError::Pinhole)?;
        let right = forward.cross(point(up)).try_normalize().ok_or(ViewError::Pinhole)?;
        if !(vertical_fov_degrees > 0.0 && vertical_fov_degrees < 180.0) {
            return Err(ViewError::Pinhole);
        }
        let up = right.cross(forward);
        let slope = transcendental::tan_f64(f64::from(vertical_fov_degrees).to_radians() * 0.5);
        let pitch = 2.0 * slope / height as f64;
        let centre = |index: usize, count: usize| (index as f64 + 0.5 - count as f64 * 0.5) * pitch;
        let directions = (0..width * height)
            .map(|pixel| {
                let (x, y) = (centre(pixel % width, width), centre(pixel / width, height));
                (forward + right * x - up * y).to_array().map(|c| c as f32)
            })
            .collect();
        View::new(eye, width, height, directions, 0.0)
    }

    /// This view, without anything nearer than `t_min` lengths of each direction.
    ///
    /// # Errors
    /// Returns an error when `t_min` is negative or not finite.
    pub fn with_t_min(mut self, t_min: f32) -> Result<View, ViewError> {
        if !(t_min >= 0.0 && t_min.is_finite()) {
            return Err(ViewError::Near(t_min));
        }
        self.t_min = t_min;
        Ok(self)
    }

    /// The position of the eye.
    pub fn eye(&self) -> [f32; 3] {
        self.eye
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The ray through the centre of a pixel, row by row from the top: the one that every algorithm uses, bit for
    /// bit. `None` outside the image.
    pub fn ray(&self, pixel: usize) -> Option<Ray> {
        let direction = *self.directions.get(pixel)?;
        Some(Ray { t_min: self.t_min, ..Ray::new(self.eye, direction) })
    }

    /// The image by ray casting: the reference that the other algorithms are tested against.
    pub fn cast(&self, accelerator: &dyn Accelerator, culling: Culling) -> Vec<u32> {
        let query = Query { culling, ..Query::default() };
        (0..self.directions.len())
            .filter_map(|pixel| self.ray(pixel))
            .map(|ray| accelerator.closest_hit(&ray, &query).map_or(BACKGROUND, |hit| hit.primitive))
            .collect()
    }

    pub(crate) fn eye_point(&self) -> DVec3 {
        DVec3::from(self.eye.map(f64::from))
    }

    pub(crate) fn direction(&self, pixel: usize) -> DVec3 {
        DVec3::from(self.directions[pixel].map(f64::from))
    }

    pub(crate) fn t_min(&self) -> f32 {
        self.t_min
    }

    pub(crate) fn prepared_rays(&self) -> Vec<Option<PreparedRay>> {
        (0..self.directions.len()).map(|pixel| PreparedRay::new(&self.ray(pixel)?)).collect()
    }
}

/// Cosine of the angle to `forward` below which directions are rejected: rays that run along the camera plane have no
/// position on a screen.
const MIN_COSINE: f64 = 1.0 / 65536.0;

/// The positions of the pixels of each column (or row) on the screen one unit in front of the eye. Made monotone, so
/// that a search is conservative however the directions were rounded, or distorted.
#[derive(Clone, Debug)]
pub(crate) struct Lanes {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Lanes {
    fn new(count: usize) -> Lanes {
        Lanes { low: vec![f64::INFINITY; count], high: vec![f64::NEG_INFINITY; count] }
    }

    fn include(&mut self, lane: usize, position: f64) {
        self.low[lane] = self.low[lane].min(position);
        self.high[lane] = self.high[lane].max(position);
    }

    fn finish(&mut self) {
        for lane in 1..self.high.len() {
            self.high[lane] = self.high[lane].max(self.high[lane - 1]);
        }
        for lane in (1..self.low.len()).rev() {
            self.low[lane - 1] = self.low[lane - 1].min(self.low[lane]);
        }
    }

    /// The lanes that may have a pixel centre between two positions; all possible lanes, when the positions are NaN.
    pub(crate) fn between(&self, low: f64, high: f64) -> (usize, usize) {
        let first = self.high.partition_point(|&h| h < low);
        let end = self.low.partition_point(|&l| l <= high || high.is_nan());
        (first, end.max(first))
    }

    /// The positions of all pixel centres of some lanes.
    pub(crate) fn span(&self, first: usize, end: usize) -> (f64, f64) {
        (self.low[first], self.high[end - 1])
    }

    /// The positions of all pixel centres.
    pub(crate) fn whole(&self) -> (f64, f64) {
        self.span(0, self.low.len())
    }
}

fn check_size(width: usize, height: usize) -> Result<(), ViewError> {
    match width.checked_mul(height) {
        Some(1..=MAX_PIXELS) => Ok(()),
        _ => Err(ViewError::Size(width, height)),
    }
}

fn usable(directions: &[[f32; 3]]) -> impl Iterator<Item = (usize, DVec3)> {
    directions.iter().enumerate().filter_map(|(pixel, &d)| {
        let sound = d.iter().all(|c| c.is_finite()) && d != [0.0; 3];
        sound.then(|| (pixel, DVec3::from(d.map(f64::from))))
    })
}

/// The right, down and forward axes of a bundle of directions. Any orthonormal axes would do: bounds on the screen
/// are merely tighter when these follow the rows and columns.
fn axes_of(directions: &[[f32; 3]], width: usize, height: usize) -> [DVec3; 3] {
    let (mut mean, mut across, mut along) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (pixel, direction) in usable(directions) {
        let d = direction.normalize();
        mean += d;
        across += d * (2.0 * (pixel % width) as f64 + 1.0 - width as f64);
        along += d * (2.0 * (pixel / width) as f64 + 1.0 - height as f64);
    }
    let forward = mean.try_normalize().unwrap_or(DVec3::Z);
    let flat = |v: DVec3| (v - forward * v.dot(forward)).try_normalize();
    let right = flat(across)
        .or_else(|| flat(along).map(|down| down.cross(forward)))
        .unwrap_or_else(|| forward.any_orthonormal_vector());
    let down = forward.cross(right);
    [right, if down.dot(along) < 0.0 { -down } else { down }, forward]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(fov: f32, size: usize) -> View {
        View::pinhole([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], fov, size, size).unwrap()
    }

    #[test]
    fn the_first_pixel_is_at_the_upper_left() {
        let d = square(90.0, 2).ray(0).unwrap().direction;
        assert_eq!(d, [-0.5, 0.5, -1.0]);
    }

    #[test]
    fn lanes_between_two_positions_are_found() {
        let view = square(90.0, 4);
        assert_eq!(view.columns.between(-0.3, 0.3), (1, 3));
        assert_eq!(view.columns.between(-0.2, 0.2), (2, 2));
        assert_eq!(view.columns.between(f64::NAN, f64::NAN), (0, 4));
        assert_eq!(view.rows.between(-2.0, 2.0), (0, 4));
        assert_eq!(view.rows.between(2.0, 3.0), (4, 4));
    }

    #[test]
    fn invalid_views_are_rejected() {
        let forward = vec![[0.0, 0.0, 1.0]];
        assert_eq!(View::new([0.0; 3], 0, 4, vec![], 0.0).unwrap_err(), ViewError::Size(0, 4));
        assert!(View::new([0.0; 3], usize::MAX, 2, vec![], 0.0).is_err());
        assert!(View::new([f32::NAN; 3], 1, 1, forward.clone(), 0.0).is_err());
        assert!(View::new([0.0; 3], 1, 1, forward.clone(), -1.0).is_err());
        assert!(View::new([0.0; 3], 2, 1, forward, 0.0).is_err());
        let wide = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
        assert_eq!(View::new([0.0; 3], 2, 1, wide, 0.0).unwrap_err(), ViewError::TooWide);
        assert!(View::pinhole([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0], 60.0, 8, 8).is_err());
        assert!(View::pinhole([0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 60.0, 8, 8).is_err());
        assert!(View::pinhole([0.0; 3], [1.0; 3], [0.0, 1.0, 0.0], 180.0, 8, 8).is_err());
    }
}

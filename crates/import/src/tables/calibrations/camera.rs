//! Cameras as the formats share them: a lens measured in pixels, and where it stands.

use crate::FormatError;
use bilux_math::{DMat3, DVec3};
use bilux_scene::{Span, Spec, Value};

/// Largest difference of R Rᵀ from the identity for a rotation R, since files round its numbers.
const ROUNDING: f64 = 1e-3;

/// The models that files name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Model {
    /// Radial and tangential coefficients in OpenCV's order.
    OpenCv,
    /// Four of the angle.
    Fisheye,
}

/// OpenCV's order.
const OPENCV_ORDER: [&str; 12] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"];
const FISHEYE_ORDER: [&str; 4] = ["k1", "k2", "k3", "k4"];

/// A lens and its film.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lens {
    pub(super) model: Model,
    /// Width and height of the pictures in pixels.
    pub(super) size: [u32; 2],
    /// In pixels.
    pub(super) focal: [f64; 2],
    /// The principal point from the centre of the upper left pixel, as in OpenCV.
    pub(super) centre: [f64; 2],
    pub(super) skew: f64,
    /// In the order of the model.
    pub(super) coefficients: Vec<f64>,
}

impl Lens {
    /// One whose principal point counts from the corner of the picture, as everywhere but in OpenCV.
    pub(super) fn counted_from_corner(self) -> Lens {
        Lens { centre: self.centre.map(|x| x - 0.5), ..self }
    }

    /// The camera.
    pub(super) fn spec(&self, name: &str, pose: Option<&Pose>, at: &Span) -> Result<Spec, FormatError> {
        let (kind, order) = match self.model {
            Model::OpenCv => ("opencv", &OPENCV_ORDER[..]),
            Model::Fisheye => ("opencv-fisheye", &FISHEYE_ORDER[..]),
        };
        let numbers = [self.focal, self.centre];
        if !numbers.iter().flatten().chain(&self.coefficients).all(|x| x.is_finite()) {
            return Err(FormatError::malformed("not all numbers of this camera are finite", at.clone()));
        }
        if self.focal.iter().any(|focal| *focal <= 0.0) || self.size.contains(&0) {
            let [fx, fy] = self.focal;
            let [width, height] = self.size;
            let message = format!(
                "a camera with focal lengths of {fx} and {fy} and pictures of {width}x{height} pixels: all of these must \
                 be positive"
            );
            return Err(FormatError::malformed(message, at.clone()));
        }
        if let Some(more) = self.coefficients.get(order.len()..).filter(|more| more.iter().any(|c| *c != 0.0))
        {
            let message = format!(
                "the lens has {} coefficients more than the {} that are known, such as {}: tilted sensors are not supported",
                more.len(),
                order.len(),
                more[0]
            );
            return Err(FormatError::malformed(message, at.clone()));
        }
        let mut spec = Spec { span: at.clone(), ..Spec::new(name, kind) };
        for (key, side) in ["width", "height"].into_iter().zip(self.size) {
            spec.parameters.set(key, Value::Integer(i64::from(side)));
        }
        let [fx, fy, cx, cy] = [self.focal[0], self.focal[1], self.centre[0], self.centre[1]];
        let matrix = [("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy), ("skew", self.skew)];
        let lens = order.iter().copied().zip(self.coefficients.iter().copied());
        let is_needed = |(key, value): &(&str, f64)| *key != "skew" || *value != 0.0;
        for (key, value) in matrix.into_iter().filter(is_needed).chain(lens.filter(|(_, c)| *c != 0.0)) {
            spec.parameters.set(key, Value::Number(value));
        }
        if let Some(pose) = pose {
            pose.place(&mut spec);
        }
        Ok(spec)
    }
}

/// Position of a camera, and its axes in the world: to the right, downwards and forwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    position: DVec3,
    axes: [DVec3; 3],
}

impl Pose {
    /// Pose of a camera by the rotation and translation that take points of the world to OpenCV's axes.
    pub(super) fn of_world_to_camera(rotation: DMat3, shift: DVec3, at: &Span) -> Result<Pose, FormatError> {
        let to_world = rotated(rotation, at)?.transpose();
        Ok(Pose { position: -(to_world * shift), axes: [to_world.x_axis, to_world.y_axis, to_world.z_axis] })
    }

    /// Pose of a camera by its place in the world, with OpenGL's axes: y upwards, z backwards.
    pub(super) fn of_camera_to_world(axes: DMat3, position: DVec3, at: &Span) -> Result<Pose, FormatError> {
        let axes = rotated(axes, at)?;
        Ok(Pose { position, axes: [axes.x_axis, -axes.y_axis, -axes.z_axis] })
    }

    pub(super) fn place(&self, spec: &mut Spec) {
        // So far ahead that the point, rounded, says the direction.
        let ahead = self.position + self.axes[2] * self.position.abs().max_element().max(1.0);
        for (key, v) in [("position", self.position), ("look_at", ahead), ("up", -self.axes[1])] {
            spec.parameters.set(key, Value::List(v.to_array().map(Value::Number).to_vec()));
        }
    }
}

/// A rotation, as files round it.
fn rotated(matrix: DMat3, at: &Span) -> Result<DMat3, FormatError> {
    let off = matrix * matrix.transpose() - DMat3::IDENTITY;
    let off = off.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    let message = match (matrix.is_finite() && off <= ROUNDING, matrix.determinant() > 0.0) {
        (true, true) => return Ok(matrix),
        (true, false) => {
            "the rotation of this camera mirrors: its determinant is -1, but a rotation has 1".to_owned()
        }
        _ => format!("the rotation of this camera is none: R Rᵀ is not the identity, but {off:.2e} off"),
    };
    Err(FormatError::malformed(message, at.clone()))
}

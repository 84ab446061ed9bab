//! Poses of the cameras of a rig relative to each other, as Kalibr and OpenCV's stereo calibration write them.

use super::CalibratedCameras;
use super::camera::Pose;
use super::document::{find, matrix};
use crate::FormatError;
use bilux_math::{DMat3, DVec3};
use bilux_scene::Span;
use serde_json::{Map, Value};

/// Takes points from the axes of one camera, or of the inertial unit, to those of another: to the right, downwards and forwards.
#[derive(Clone, Copy)]
struct Step {
    rotation: DMat3,
    shift: DVec3,
}

/// The cameras of a file so far.
#[derive(Default)]
pub(super) struct Rig {
    /// From the first camera to each, where the file says it.
    steps: Vec<Option<Step>>,
    /// From the inertial unit to the first camera.
    unit_to_first: Option<Step>,
}

impl Step {
    const NONE: Step = Step { rotation: DMat3::IDENTITY, shift: DVec3::ZERO };

    /// A matrix of 4 rows, or of 3.
    fn read(value: &Value, key: &str) -> Result<Step, String> {
        let all = matrix(value, key)?;
        let rows: Vec<&[f64]> = all.chunks_exact(4).collect();
        let ([a, b, c] | [a, b, c, _]) = rows[..] else {
            return Err(format!("{key} has {} numbers, but 4 rows of 4", all.len()));
        };
        let rotation = DMat3::from_cols_array(&[a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]]);
        Ok(Step { rotation, shift: DVec3::new(a[3], b[3], c[3]) })
    }

    /// This one, then another.
    fn then(self, next: Step) -> Step {
        let Step { rotation, shift } = next;
        Step { rotation: rotation * self.rotation, shift: rotation * self.shift + shift }
    }

    /// The way back, for a rotation.
    fn back(self) -> Step {
        let rotation = self.rotation.transpose();
        Step { rotation, shift: -(rotation * self.shift) }
    }
}

impl Rig {
    /// Adds the next camera, of this map and with this number in it: by `T_cn_cnm1`, from the camera before; by `T_cam_imu`, from the
    /// inertial unit, both as Kalibr writes them; or by OpenCV's `R` and `T`, from the first of two.
    pub(super) fn add(&mut self, map: &Map<String, Value>, number: &str) -> Result<(), String> {
        let step =
            |key: &str, name: &str| find(map, &[key], "").map(|value| Step::read(value, name)).transpose();
        let from_unit = step("tcamimu", "T_cam_imu")?;
        let Some(before) = self.steps.last().copied() else {
            self.unit_to_first = from_unit;
            self.steps.push(None);
            return Ok(());
        };
        let from_before = step("tcncnm1", "T_cn_cnm1")?;
        let of_pair = match (find(map, &["r"], ""), find(map, &["t"], "")) {
            (Some(r), Some(t)) if number == "2" => of_pair(&matrix(r, "R")?, &matrix(t, "T")?)?.into(),
            _ => None,
        };
        let by_unit = || Some(self.unit_to_first?.back().then(from_unit?));
        let chained = from_before.map(|step| before.unwrap_or(Step::NONE).then(step));
        self.steps.push(chained.or_else(by_unit).or(of_pair));
        Ok(())
    }

    /// Places all cameras relative to the first, if the file says how some stand to it.
    pub(super) fn place(&self, read: &mut CalibratedCameras, at: &Span) -> Result<(), FormatError> {
        if self.steps.iter().all(Option::is_none) {
            return Ok(());
        }
        read.are_relative = true;
        // From axes upwards and backwards.
        let flipped = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
        for (i, (camera, step)) in read.cameras.iter_mut().zip(&self.steps).enumerate() {
            if i > 0 && step.is_none() {
                let name = &camera.name;
                let message = format!(
                    "the file does not say how camera '{name}' stands to the others: it stands where the first does"
                );
                read.warnings.push(message);
            }
            let Step { rotation, shift } = step.unwrap_or(Step::NONE);
            Pose::of_world_to_camera(rotation * flipped, shift, at)?.place(camera);
        }
        Ok(())
    }
}

/// The rotation and translation of a pair.
fn of_pair(r: &[f64], t: &[f64]) -> Result<Step, String> {
    match (r, t) {
        (&[a, b, c, d, e, f, g, h, i], &[x, y, z]) => {
            let rotation = DMat3::from_cols_array(&[a, d, g, b, e, h, c, f, i]);
            Ok(Step { rotation, shift: DVec3::new(x, y, z) })
        }
        _ => Err(format!("R and T have {} and {} numbers, but 9 and 3", r.len(), t.len())),
    }
}

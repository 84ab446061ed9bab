//! Position and orientation of a camera, in double precision.

use super::{CameraKeys, around, without_axes};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::DVec3;

/// A place, and unit vectors to the right, downwards and forwards of the picture: those of a mirrored one are left-handed.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    pub(super) position: DVec3,
    pub(super) axes: [DVec3; 3],
}

impl Pose {
    /// A direction of the world in the space of the camera.
    pub(super) fn to_camera(self, direction: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| direction.dot(axis)))
    }

    /// A direction of the camera's space in the world.
    pub(super) fn to_world(self, direction: DVec3) -> DVec3 {
        let [right, down, forward] = self.axes;
        right * direction.x + down * direction.y + forward * direction.z
    }
}

/// The poses of a camera over time.
pub(super) struct Poses {
    keys: Vec<(f32, Placing)>,
    pub(super) mirrored: bool,
    /// The one pose of a camera that stands still.
    still: Option<Pose>,
}

#[derive(Clone, Copy)]
struct Placing {
    position: DVec3,
    look_at: DVec3,
    up: DVec3,
}

impl Placing {
    fn axes(&self) -> Option<[DVec3; 3]> {
        look_f64(self.position, self.look_at, self.up)
    }
}

impl Poses {
    /// Poses of the parameters `position`, `look_at`, `up` and `mirrored`; the first key says whether the camera is mirrored.
    pub(super) fn read(keys: CameraKeys) -> Result<Poses, SceneError> {
        let place = |(time, reader): &(f32, Reader)| {
            let [position, look_at, up] = ["position", "look_at", "up"].map(|key| reader.vector_f64(key));
            let place = Placing { position, look_at, up };
            place.axes().map(|_| (*time, place)).ok_or_else(|| without_axes(reader))
        };
        let places = keys.iter().map(place).collect::<Result<Vec<_>, SceneError>>()?;
        let mirrored = keys.first().is_some_and(|(_, reader)| reader.bool("mirrored"));
        let mut poses = Poses { keys: places, mirrored, still: None };
        if poses.keys.len() == 1 {
            poses.still = Some(poses.at(0.0));
        }
        Ok(poses)
    }

    /// The pose, if there is only one.
    pub(super) fn still(&self) -> Option<&Pose> {
        self.still.as_ref()
    }

    pub(super) fn at(&self, time: f32) -> Pose {
        if let Some(still) = self.still {
            return still;
        }
        let (low, high, t) = around(&self.keys, time);
        let t = f64::from(t);
        let [position, look_at, up] =
            [(low.position, high.position), (low.look_at, high.look_at), (low.up, high.up)]
                .map(|(low, high)| low.lerp(high, t));
        // Between two valid keyframes the view can become degenerate; the first keyframe is valid.
        let axes = Placing { position, look_at, up }.axes().or_else(|| low.axes());
        let [right, up, forward] = axes.unwrap_or([DVec3::X, DVec3::Y, DVec3::NEG_Z]);
        Pose { position, axes: [if self.mirrored { -right } else { right }, -up, forward] }
    }
}

/// The right, up and forward axes of a camera that looks from one point to another.
pub(super) fn look_f64(position: DVec3, look_at: DVec3, up: DVec3) -> Option<[DVec3; 3]> {
    let forward = (look_at - position).try_normalize()?;
    let right = forward.cross(up).try_normalize()?;
    Some([right, right.cross(forward), forward])
}

//! Options of the studio.

use crate::geometry::axis::Axis;

/// The ground below a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A diffuse cove that receives the model's shadow; in an image without surroundings, the shadow alone.
    Shadow,
    /// A level mirror.
    Mirror,
    /// No ground.
    None,
}

impl Ground {
    /// Their names in the user interface.
    pub const NAMES: &'static [&'static str] = &["shadow", "mirror", "none"];

    /// The ground of a name.
    pub fn from_name(name: &str) -> Option<Ground> {
        let all = [Ground::Shadow, Ground::Mirror, Ground::None];
        Ground::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }
}

/// Settings with which a model is photographed. A field that is `None` gets a default only where the scene does not specify it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Studio {
    /// The ground below the model.
    pub ground: Option<Ground>,
    /// Visibility in the fog around everything, in metres, if there is any.
    pub fog: Option<f32>,
    /// The view direction: degrees to the right of its front (+z), and above it.
    pub orbit: Option<[f32; 2]>,
    /// The part of a full turn by which the camera has moved to the right, around a model that is framed for the whole
    /// turn.
    pub turn: Option<f32>,
    /// The model's up axis.
    pub up: Option<Axis>,
    /// The model's front axis.
    pub front: Option<Axis>,
    /// Focal length in mm, for an image 24 mm high.
    pub focal: Option<f32>,
    /// Width of the image over its height, if it is not square.
    pub aspect: Option<f32>,
    /// The model is cut out of its surroundings, so nothing is put around it by default.
    pub cut_out: bool,
    /// Whether the scene's own light illuminates the visible objects, as measured; `None` means that having any is
    /// enough.
    pub lit: Option<bool>,
    /// Factor on the usual brightness of the studio's lights, where a scene's own light is that much brighter than what
    /// a picture shows; `None` for 1.
    pub brightness: Option<f32>,
}

impl Studio {
    /// Slightly from the right and from above. A flat model is seen from farther above.
    pub const ORBIT: [f32; 2] = [26.5, 17.8];
    /// The lens of a portrait, or slightly longer.
    pub const FOCAL: f32 = 45.0;

    /// True when the user asked for the studio's own camera, whatever cameras the scene has.
    pub(super) fn has_camera(&self) -> bool {
        self.orbit.is_some()
            || self.turn.is_some()
            || self.focal.is_some()
            || self.up.is_some()
            || self.front.is_some()
    }
}

/// The name of the ground's object and material.
pub(super) const GROUND: &str = "studio floor";

//! The channels of labels: one table, from which pictures, files and arrays get them.

use crate::film::aovs::Aov;
use bilux_math::{Vec2, Vec3};

/// All labels of a pixel.
#[derive(Clone, Copy)]
pub(super) struct Label {
    pub(super) depth: f32,
    pub(super) z_depth: f32,
    pub(super) normal: Vec3,
    pub(super) camera_normal: Vec3,
    pub(super) object: u32,
    pub(super) material: u32,
    pub(super) instance: u32,
    pub(super) category: u32,
    pub(super) position: Vec3,
    pub(super) uv: Vec2,
    pub(super) primitive: u32,
    pub(super) barycentric: [f32; 2],
    /// To the next frame, and to the previous one.
    pub(super) motion: [Vec2; 2],
    /// In the next frame, and in the previous one.
    pub(super) occluded: [bool; 2],
}

/// Label of a pixel in which nothing is visible.
impl Default for Label {
    fn default() -> Label {
        Label {
            depth: f32::INFINITY,
            z_depth: f32::INFINITY,
            normal: Vec3::ZERO,
            camera_normal: Vec3::ZERO,
            object: 0,
            material: 0,
            instance: 0,
            category: 0,
            position: Vec3::ZERO,
            uv: Vec2::ZERO,
            primitive: 0,
            barycentric: [0.0; 2],
            motion: [Vec2::ZERO; 2],
            occluded: [false; 2],
        }
    }
}

/// A number of a label.
pub(super) enum Value {
    Float(fn(&Label) -> f32),
    Integer(fn(&Label) -> u32),
}

/// A row of [`CHANNELS`].
pub(super) struct Channel {
    pub(super) aov: Aov,
    /// As files have it.
    pub(super) name: &'static str,
    pub(super) value: Value,
}

const fn float(aov: Aov, name: &'static str, of: fn(&Label) -> f32) -> Channel {
    Channel { aov, name, value: Value::Float(of) }
}

const fn integer(aov: Aov, name: &'static str, of: fn(&Label) -> u32) -> Channel {
    Channel { aov, name, value: Value::Integer(of) }
}

/// The channels of all labels.
pub(super) static CHANNELS: &[Channel] = &[
    float(Aov::Normal, "normal.X", |label| label.normal.x),
    float(Aov::Normal, "normal.Y", |label| label.normal.y),
    float(Aov::Normal, "normal.Z", |label| label.normal.z),
    float(Aov::CameraNormal, "camera_normal.X", |label| label.camera_normal.x),
    float(Aov::CameraNormal, "camera_normal.Y", |label| label.camera_normal.y),
    float(Aov::CameraNormal, "camera_normal.Z", |label| label.camera_normal.z),
    float(Aov::Depth, "depth.Z", |label| label.depth),
    float(Aov::ZDepth, "z_depth.Z", |label| label.z_depth),
    integer(Aov::Ids, "id.object", |label| label.object),
    integer(Aov::Ids, "id.material", |label| label.material),
    integer(Aov::Instance, "instance.id", |label| label.instance),
    integer(Aov::Category, "category.id", |label| label.category),
    float(Aov::Position, "position.X", |label| label.position.x),
    float(Aov::Position, "position.Y", |label| label.position.y),
    float(Aov::Position, "position.Z", |label| label.position.z),
    float(Aov::Uv, "uv.U", |label| label.uv.x),
    float(Aov::Uv, "uv.V", |label| label.uv.y),
    integer(Aov::Primitive, "primitive.id", |label| label.primitive),
    float(Aov::Barycentric, "barycentric.U", |label| label.barycentric[0]),
    float(Aov::Barycentric, "barycentric.V", |label| label.barycentric[1]),
    float(Aov::Motion, "motion.X", |label| label.motion[0].x),
    float(Aov::Motion, "motion.Y", |label| label.motion[0].y),
    float(Aov::BackwardMotion, "backward_motion.X", |label| label.motion[1].x),
    float(Aov::BackwardMotion, "backward_motion.Y", |label| label.motion[1].y),
    float(Aov::Occluded, "occluded.next", |label| f32::from(u8::from(label.occluded[0]))),
    float(Aov::Occluded, "occluded.previous", |label| f32::from(u8::from(label.occluded[1]))),
];

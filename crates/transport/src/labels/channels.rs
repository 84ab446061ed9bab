//! The numbers of labels: one table, from which the channels of pictures, files and arrays are made.

use crate::film::aovs::Aov;
use Value::{Float, Integer};
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
#[derive(Clone, Copy)]
pub(super) enum Value {
    Float(fn(&Label) -> f32),
    Integer(fn(&Label) -> u32),
}

/// A channel, as files have it.
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) value: Value,
}

/// The channels of the wanted labels, in the order of the table.
pub(super) fn channels(wanted: &[Aov]) -> Vec<Channel> {
    let wanted = VALUES.iter().filter(|(aov, _)| wanted.contains(aov));
    let named = wanted.flat_map(|(aov, values)| aov.channel_names().zip(*values));
    named.map(|(name, &value)| Channel { name, value }).collect()
}

/// The numbers of each label, in the order in which its row of [`AOVS`](crate::aovs::AOVS) names the channels.
static VALUES: &[(Aov, &[Value])] = &[
    (Aov::Normal, &[Float(|of| of.normal.x), Float(|of| of.normal.y), Float(|of| of.normal.z)]),
    (
        Aov::CameraNormal,
        &[Float(|of| of.camera_normal.x), Float(|of| of.camera_normal.y), Float(|of| of.camera_normal.z)],
    ),
    (Aov::Depth, &[Float(|of| of.depth)]),
    (Aov::ZDepth, &[Float(|of| of.z_depth)]),
    (Aov::Ids, &[Integer(|of| of.object), Integer(|of| of.material)]),
    (Aov::Instance, &[Integer(|of| of.instance)]),
    (Aov::Category, &[Integer(|of| of.category)]),
    (Aov::Position, &[Float(|of| of.position.x), Float(|of| of.position.y), Float(|of| of.position.z)]),
    (Aov::Uv, &[Float(|of| of.uv.x), Float(|of| of.uv.y)]),
    (Aov::Primitive, &[Integer(|of| of.primitive)]),
    (Aov::Barycentric, &[Float(|of| of.barycentric[0]), Float(|of| of.barycentric[1])]),
    (Aov::Motion, &[Float(|of| of.motion[0].x), Float(|of| of.motion[0].y)]),
    (Aov::BackwardMotion, &[Float(|of| of.motion[1].x), Float(|of| of.motion[1].y)]),
    (Aov::Occluded, &[Float(|of| truth(of.occluded[0])), Float(|of| truth(of.occluded[1]))]),
];

fn truth(is_true: bool) -> f32 {
    f32::from(u8::from(is_true))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_label_has_a_number_for_each_channel() {
        assert!(VALUES.iter().map(|(aov, _)| *aov).eq(Aov::labels()));
        for (aov, values) in VALUES {
            assert_eq!(values.len(), aov.row().channels.len(), "{aov:?}");
        }
    }
}

//! The up axis and the unit of length of files, and scenes as the files of a format have them.

mod specs;
mod statement;

use bilux_math::{DMat3, DMat4, DVec3, Motion, Transform};
use bilux_scene::{Axis, Orientation, SceneBuilder, UpHint};
use specs::Turn;
pub use statement::{stated, statement};
use std::borrow::Cow;
use std::sync::Arc;

/// The up axis and the unit of length of the files that a writer makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// The format fixes both: this axis, and so many metres.
    Fixed(Axis, f64),
    /// Files say both: one of these axes, and any unit.
    Stated(&'static [Axis]),
}

impl Frame {
    /// Metres with y up, as here.
    pub const METRES: Frame = Frame::Fixed(Axis::Y, 1.0);
    /// Millimetres with z up, as 3D printers have it.
    pub const PRINTED: Frame = Frame::Fixed(Axis::Z, 0.001);
}

/// Metres per unit of length of a scene.
pub fn metres(scene: &SceneBuilder) -> f64 {
    if scene.unit > 0.0 && scene.unit.is_finite() { scene.unit } else { 1.0 }
}

/// Scene scaled and turned as files of a format have it.
///
/// What states neither axis nor unit is taken as slicers take it where it is to be printed: as it is.
pub fn in_frame(scene: &SceneBuilder, frame: Frame) -> Cow<'_, SceneBuilder> {
    let (UpHint::Is(from) | UpHint::Usually(from)) = scene.up;
    let is_unstated = scene.unit == 0.0 && scene.up != UpHint::Is(from);
    let (to, unit) = match frame {
        Frame::PRINTED if is_unstated => (from, metres(scene)),
        Frame::Fixed(axis, unit) => (axis, unit),
        Frame::Stated(axes) if axes.contains(&from) => (from, metres(scene)),
        Frame::Stated(_) => (Axis::Y, metres(scene)),
    };
    let rotation = Orientation::usual(to).upright().transpose() * Orientation::usual(from).upright();
    let scale = metres(scene) / unit;
    let is_same = from == to && scale == 1.0;
    if is_same && matches!(frame, Frame::Fixed(..)) {
        return Cow::Borrowed(scene);
    }
    let mut framed = scene.clone();
    if !is_same {
        turn(&mut framed, &Turn { rotation, scale });
    }
    (framed.up, framed.unit) = (UpHint::Is(to), unit);
    Cow::Owned(framed)
}

/// Turns and scales everything that has a place.
fn turn(scene: &mut SceneBuilder, by: &Turn) {
    move_objects(scene, by);
    if let Some(movement) = &mut scene.movement {
        move_objects(Arc::make_mut(movement), by);
    }
    by.specs(scene);
    scene.origin = by.point(scene.origin);
    scene.stroke_widths.points *= by.scale as f32;
    scene.stroke_widths.lines *= by.scale as f32;
}

fn move_objects(scene: &mut SceneBuilder, by: &Turn) {
    let linear = DMat3::from_diagonal(DVec3::splat(by.scale)) * by.rotation;
    let Some(transform) = Transform::from_matrix(DMat4::from_mat3(linear)) else { return };
    let by = Motion::still(transform);
    for object in &mut scene.objects {
        object.motion = object.motion.then(&by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Vec3;
    use bilux_scene::cameras::CameraSpec;
    use bilux_scene::{Parameters, Spec, StrokeWidths, Value};

    /// From centimetres with z up: what a camera's keyframes say, and the widths of points and lines.
    #[test]
    fn keyframes_of_cameras_and_widths_of_strokes_change_with_the_frame() {
        let mut scene = SceneBuilder { up: UpHint::Is(Axis::Z), unit: 0.01, ..SceneBuilder::default() };
        scene.stroke_widths = StrokeWidths { points: 50.0, lines: 20.0 };
        let at = |x: f32| {
            let mut changes = Parameters::default();
            changes.set("position", Value::from(Vec3::new(x, -400.0, 50.0)));
            changes.set("up", Value::from(Vec3::Z));
            changes
        };
        let spec = Spec::new("", "perspective").with("position", Vec3::new(100.0, -400.0, 50.0));
        scene.cameras = vec![CameraSpec { spec, keyframes: vec![(0.0, at(100.0)), (2.0, at(300.0))] }];
        let framed = in_frame(&scene, Frame::METRES);
        let StrokeWidths { points, lines } = framed.stroke_widths;
        assert!((points - 0.5).abs() < 1e-6 && (lines - 0.2).abs() < 1e-6, "{points}, {lines}");
        for ((time, changes), (when, x)) in framed.cameras[0].keyframes.iter().zip([(0.0, 1.0), (2.0, 3.0)]) {
            let found = |key: &str| {
                let (value, _) = changes.find(key).unwrap();
                Spec::new("", "").with("v", value.clone()).vector("v").unwrap()
            };
            assert_eq!(*time, when);
            assert!(found("position").distance(Vec3::new(x, 0.5, 4.0)) < 1e-5, "{}", found("position"));
            assert!(found("up").distance(Vec3::Y) < 1e-6, "{}", found("up"));
        }
    }
}

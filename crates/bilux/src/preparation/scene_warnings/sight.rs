//! Cameras that look past everything.

use bilux_math::{Aabb, Vec2};
use bilux_scene::{Camera, CameraSample, Object, Scene, SceneBuilder, Tracer};

/// Rays on each side of the picture that look for something.
const GRID: usize = 32;

/// Said of a camera in whose picture no object of the scene is.
pub(super) const MESSAGE: &str = "the camera sees none of the scene's objects: look at its place and where it looks; if its pose is a \
     matrix, it must be of this format's axes, and go the way that the format says: those of OpenCV go from the world to the camera";

/// True if none of the objects that were given is in the picture: no ray of a grid meets one, or a lamp, and none of their middles
/// is seen.
pub(super) fn is_past_everything(given: &SceneBuilder, scene: &Scene, camera: &dyn Camera) -> bool {
    if given.cameras.is_empty() || given.objects.is_empty() || camera.receives() {
        return false;
    }
    let [opens, closes] = scene.shutter();
    let mut tracer = Tracer::new(scene, false);
    let mut meets = |i: usize| {
        let film = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
        // All moments of the shutter have some of the rays.
        let time = opens + (closes - opens) * ((i * 7) % GRID) as f32 / GRID as f32;
        let ray = camera.ray(&CameraSample { film, lens: Vec2::ZERO, time });
        !ray.is_nowhere() && tracer.closest(&ray).is_some()
    };
    !(0..GRID * GRID).any(&mut meets)
        && !given.objects.iter().any(|object| is_in_picture(object, camera, opens))
}

/// True if the middle of an object is in the picture, however small it is there.
fn is_in_picture(object: &Object, camera: &dyn Camera, time: f32) -> bool {
    let bounds = Aabb::of_points(object.mesh.positions.iter().copied().filter(|p| p.is_finite()));
    let middle = object.motion.at(time).point(bounds.centre());
    let seen = camera.project(middle, time);
    seen.is_some_and(|film| film.cmpge(Vec2::ZERO).all() && film.cmple(Vec2::ONE).all())
}

#[cfg(test)]
mod tests {
    use crate::Job;
    use bilux_math::{Transform, Vec3};
    use bilux_scene::cameras::CameraSpec;
    use bilux_scene::{Mesh, Object, Parameters, SceneBuilder, Spec, mesh::shapes};
    use std::sync::Arc;

    /// Whether the camera of this spec is said to see none of a ball at the origin and a speck at (0, 0, -40).
    fn is_reported(camera: Spec) -> bool {
        let mut scene = SceneBuilder::default();
        let clay = scene.add_material(Spec::new("", "diffuse"));
        let ball = |radius| -> Arc<Mesh> { Arc::new(shapes::icosphere(Vec3::ZERO, radius, 2)) };
        scene.objects.push(Object::new("ball", ball(1.0), clay));
        let speck = Object::new("speck", ball(1e-3), clay);
        let far = Transform::translate(Vec3::new(0.0, 0.0, -40.0)).unwrap();
        scene.objects.push(speck.placed(far));
        scene.cameras.push(CameraSpec::new(camera));
        let job = Job::new(&scene, &Parameters::default()).unwrap();
        job.warnings().iter().any(|warning| warning.to_string().contains("sees none of the scene's objects"))
    }

    #[test]
    fn a_camera_that_looks_past_everything_is_reported() {
        let eye =
            |kind: &str, from: Vec3, to: Vec3| Spec::new("", kind).with("position", from).with("look_at", to);
        let ahead = Vec3::new(0.0, 0.0, 5.0);
        for kind in ["perspective", "orthographic", "fisheye"] {
            assert!(!is_reported(eye(kind, ahead, Vec3::ZERO)), "{kind}");
        }
        assert!(is_reported(eye("perspective", ahead, Vec3::new(0.3, 0.0, 9.0))), "it looks away");
        assert!(!is_reported(eye("panorama", ahead, Vec3::new(0.3, 0.0, 9.0))), "all around");
        // Past the ball, at a speck that no ray of the grid meets.
        assert!(!is_reported(eye("perspective", Vec3::new(0.0, 0.0, -20.0), Vec3::new(1.0, 0.5, -40.0))));
    }
}

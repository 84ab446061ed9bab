//! Meters, rigs of cameras, and limits of settings: what a job makes of them.

use bilux::formats::ReadOptions;
use bilux::prelude::*;
use bilux::presets::take_cameras;
use bilux::scene::cameras::Camera;
use bilux::transport::MAX_DEPTH;
use std::f32::consts::PI;

fn spec(kind: &str, numbers: &[(&str, Vec3)]) -> Spec {
    numbers.iter().fold(Spec::new("", kind), |spec, &(key, value)| spec.with(key, value))
}

/// The mean of E/π over a square meter of 1 m under a lamp, by the inverse square: nothing has to reflect the light.
#[test]
fn a_meter_needs_no_surface() {
    let (lamp, intensity) = (Vec3::new(0.3, 1.7, -0.2), 6.0f32);
    let mut scene = SceneBuilder::default();
    scene.lights.push(spec("point", &[("position", lamp)]).with("intensity", intensity));
    let meter = spec("irradiance", &[("position", Vec3::ZERO), ("look_at", Vec3::Y), ("up", Vec3::NEG_Z)]);
    scene.cameras.push(CameraSpec::new(meter.with("height", 1.0f32)));
    let request = JobRequest::new().size(16, 16).integrator("path").spp(4);
    let picture = Job::new(&scene, request).unwrap().render(&Quiet).unwrap().picture().unwrap();
    let found: f32 = picture.to_rgb().unwrap().iter().map(|pixel| pixel.g).sum::<f32>() / 256.0;
    let at = |i: usize| (i as f32 + 0.5) / 32.0 - 0.5;
    let of = |x: f32, z: f32| {
        let distance = lamp.distance(Vec3::new(x, 0.0, z));
        intensity * lamp.y / (distance * distance * distance) / PI
    };
    let wanted = (0..1024).map(|i| of(at(i % 32), at(i / 32))).sum::<f32>() / 1024.0;
    assert!((found / wanted - 1.0).abs() < 5e-3, "{found}, not {wanted}");
    // Without light, and without a meter, there is nothing to see.
    let refused = |scene: &SceneBuilder| Job::new(scene, JobRequest::new()).err().unwrap().to_string();
    let dark = SceneBuilder { lights: Vec::new(), ..scene.clone() };
    assert!(refused(&dark).contains("empty"));
    let eye = CameraSpec::new(spec("perspective", &[("position", Vec3::Z)]));
    assert!(refused(&SceneBuilder { cameras: vec![eye], ..scene }).contains("empty"));
}

#[test]
fn the_greatest_depth_of_the_table_renders_and_one_more_is_refused() {
    let scene = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let of = |depth: i64| {
        let request =
            JobRequest::new().size(4, 4).integrator("path").spp(1).set("max_depth", Value::Integer(depth));
        let job = Job::new(&scene, request).map_err(|error| error.to_string())?;
        job.render(&Quiet).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(of(i64::from(MAX_DEPTH)), Ok(()));
    assert!(of(i64::from(MAX_DEPTH) + 1).unwrap_err().contains("from 0 to 1000"));
}

/// A rig of two cameras, of which the second is 0.2 m to the right of the first and looks along it, stands where the scene's camera does.
#[test]
fn a_rig_stands_where_the_scenes_camera_does() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("chain.yaml");
    let lens = "  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: radtan\n  intrinsics: [500, 510, 310.5, 245]\n  \
        resolution: [640, 480]\n";
    let step = "[[1, 0, 0, -0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]";
    std::fs::write(&file, format!("cam0:\n{lens}cam1:\n  T_cn_cnm1: {step}\n{lens}")).unwrap();
    let mut scene = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let [position, look_at] = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, 0.5)];
    let eye = spec("perspective", &[("position", position), ("look_at", look_at), ("up", Vec3::X)]);
    scene.cameras = vec![CameraSpec::new(eye)];
    take_cameras(&mut scene, &file, &ReadOptions::default()).unwrap();
    let pixel = |camera: usize, p: Vec3| {
        let camera = bilux::scene::cameras::build(&scene.cameras[camera], 640.0 / 480.0).unwrap();
        Camera::project(&*camera, p, 0.0).unwrap() * Vec2::new(640.0, 480.0)
    };
    // It looks along -z with x upwards: its right is -y.
    let p = Vec3::new(1.1, 2.3, 0.5);
    let [first, second] = [0, 1].map(|camera| pixel(camera, p));
    let depth = 2.5;
    let wanted = Vec2::new(310.5 - 500.0 * 0.3 / depth, 245.0 - 510.0 * 0.1 / depth) + 0.5;
    assert!((first - wanted).length() < 0.02, "{first}, not {wanted}");
    assert!((second - first - Vec2::new(-500.0 * 0.2 / depth, 0.0)).length() < 0.02, "{second}, {first}");
}

/// The shape of pixels is in the picture, for programs that show them in their shape; square ones are not mentioned.
#[test]
fn pixels_that_are_no_squares_are_said() {
    let said = |kind: &str, shape: f32, size: [u32; 2]| {
        let mut scene = bilux::generate(&Spec::new("", "teapot")).unwrap();
        let eye =
            spec(kind, &[("position", Vec3::new(1.0, 2.0, 5.0)), ("look_at", Vec3::new(0.2, 0.1, 0.0))]);
        let eye =
            if kind == "perspective" { eye.with("pixel_aspect", shape).with("skew", 0.2f32) } else { eye };
        scene.cameras = vec![CameraSpec::new(eye)];
        let request = JobRequest::new().size(size[0], size[1]).integrator("path").spp(1).camera("0");
        let job = Job::new(&scene, request).unwrap();
        let outcome = job.render(&Quiet).unwrap();
        let mut picture = outcome.picture().unwrap();
        job.describe(&mut picture, &outcome, None);
        picture.metadata.get("pixelAspectRatio").map(|text| text.parse::<f32>().unwrap())
    };
    for (shape, size) in [(1.5, [24, 16]), (0.8, [16, 24])] {
        let found = said("perspective", shape, size).unwrap();
        assert!((found - shape).abs() < 1e-3, "{found}, not {shape}");
    }
    assert_eq!(said("perspective", 1.0, [24, 16]), None);
    assert_eq!(said("orthographic", 1.0, [16, 24]), None);
}

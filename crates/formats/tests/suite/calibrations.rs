//! Files of calibrated cameras, as OpenCV, ROS, Kalibr, COLMAP and programs for radiance fields write them.

use bilux_formats::{CalibratedCameras, FormatError, ReadOptions, read_cameras};
use bilux_math::transcendental::{atan2_f64, tan_f64};
use bilux_math::{DVec2, DVec3};
use bilux_scene::cameras::{CameraSpec, build};
use bilux_scene::{Camera, Spec, Value};
use std::path::Path;
use std::sync::Arc;

fn read_with(files: &[(&str, &[u8])]) -> Result<CalibratedCameras, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    read_cameras(&folder.path().join(files[0].0), &ReadOptions::default())
}

fn read(name: &str, text: &str) -> Result<CalibratedCameras, FormatError> {
    read_with(&[(name, text.as_bytes())])
}

fn message(name: &str, text: &str) -> String {
    read(name, text).unwrap_err().to_string()
}

fn built(spec: &Spec) -> Arc<dyn Camera> {
    let [width, height] = CameraSpec::new(spec.clone()).calibrated_size().unwrap();
    build(&CameraSpec::new(spec.clone()), width as f32 / height as f32).unwrap()
}

/// The pixel of a point, whose centre is at whole numbers.
fn pixel(spec: &Spec, p: [f64; 3]) -> DVec2 {
    let [width, height] = CameraSpec::new(spec.clone()).calibrated_size().unwrap();
    let film = built(spec).project_f64(DVec3::from(p), 0.0).unwrap();
    film * DVec2::new(f64::from(width), f64::from(height)) - 0.5
}

const OPENCV: &str = "%YAML:1.0
---
calibration_time: \"Fri 27 Nov 2026\"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 310.5, 0., 510., 245., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.0e-01, 5.0e-02, 1.0e-03, -2.0e-03, 1.0e-02 ]
";

fn number(spec: &Spec, key: &str) -> f64 {
    spec.parameters.find(key).map_or(f64::NAN, |(value, _)| match value {
        bilux_scene::Value::Number(x) => *x,
        bilux_scene::Value::Integer(i) => *i as f64,
        _ => f64::NAN,
    })
}

#[test]
fn opencvs_yaml_and_json_ros_and_kalibr_say_the_same() {
    let json = "{ \"image_width\": 640, \"image_height\": 480,
        \"camera_matrix\": { \"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\",
            \"data\": [ 500.0, 0.0, 310.5, 0.0, 510.0, 245.0, 0.0, 0.0, 1.0 ] },
        \"distortion_coefficients\": { \"type_id\": \"opencv-matrix\", \"rows\": 5, \"cols\": 1, \"dt\": \"d\",
            \"data\": [ -0.2, 0.05, 0.001, -0.002, 0.01 ] } }";
    let nested = "{\"image_size\": [640, 480], \"K\": [[500, 0, 310.5], [0, 510, 245], [0, 0, 1]], \"dist\": [[-0.2, 0.05, 1e-3, -2e-3, 0.01]]}";
    let ros = "image_width: 640\nimage_height: 480\ncamera_name: head\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
        data: [500, 0, 310.5, 0, 510, 245, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  \
        cols: 5\n  data: [-0.2, 0.05, 0.001, -0.002, 0.01]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  \
        data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
    let kalibr = "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [-0.2, 0.05, 0.001, -0.002]\n  \
        distortion_model: radtan\n  intrinsics: [500, 510, 310.5, 245]\n  resolution: [640, 480]\ncam1:\n  \
        camera_model: pinhole\n  distortion_coeffs: [-0.2, 0.05, 0.001, -0.002]\n  distortion_model: equidistant\n  \
        intrinsics: [500, 510, 310.5, 245]\n  resolution: [640, 480]\n";
    for (file, text) in [
        ("a.yml", OPENCV),
        ("a.json", json),
        ("b.json", nested),
        ("ros.yaml", ros),
        ("camchain.yaml", kalibr),
    ] {
        let found = read(file, text).unwrap();
        let camera = &found.cameras[0];
        assert!(!found.are_placed && found.warnings.is_empty());
        assert_eq!(camera.kind, "opencv", "{file}");
        for (key, value) in
            [("width", 640.0), ("height", 480.0), ("fx", 500.0), ("fy", 510.0), ("cx", 310.5), ("cy", 245.0)]
        {
            assert_eq!(number(camera, key), value, "{file}: {key}");
        }
        for (key, value) in [("k1", -0.2), ("k2", 0.05), ("p1", 0.001), ("p2", -0.002)] {
            assert_eq!(number(camera, key), value, "{file}: {key}");
        }
        assert_eq!(number(camera, "k3") == 0.01, file != "camchain.yaml");
    }
    assert_eq!(read("ros.yaml", ros).unwrap().cameras[0].name, "head");
    let kalibr = read("camchain.yaml", kalibr).unwrap().cameras;
    assert_eq!([&*kalibr[0].name, &*kalibr[1].name], ["cam0", "cam1"]);
    assert_eq!(kalibr[1].kind, "opencv-fisheye");
    assert_eq!([number(&kalibr[1], "k3"), number(&kalibr[1], "k4")], [0.001, -0.002]);
    let pair = OPENCV.replace("camera_matrix", "M1").replace("distortion_coefficients", "D1");
    let pair = format!("{pair}M2: [[400, 0, 320], [0, 400, 240], [0, 0, 1]]\nD2: [0, 0, 0, 0]\n");
    let pair = read("stereo.yml", &pair).unwrap().cameras;
    assert_eq!([&*pair[0].name, &*pair[1].name], ["1", "2"]);
    assert_eq!([number(&pair[0], "fx"), number(&pair[1], "fx")], [500.0, 400.0]);
}

/// Two cameras side by side, the second 0.11 m to the right of the first and turned by a quarter to the left; a third one 0.2 m below the
/// second. Matrices take points from the axes of the camera before to those of this one: to the right, downwards and forwards.
#[test]
fn the_cameras_of_a_rig_stand_to_each_other_as_kalibr_says() {
    let lens = "  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: radtan\n  intrinsics: [500, 510, 310.5, 245]\n  \
        resolution: [640, 480]\n";
    let second = "[[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0.11], [0, 0, 0, 1]]";
    let third = "[[1, 0, 0, 0], [0, 1, 0, -0.2], [0, 0, 1, 0], [0, 0, 0, 1]]";
    let chain =
        format!("cam0:\n{lens}cam1:\n  T_cn_cnm1: {second}\n{lens}cam2:\n  T_cn_cnm1: {third}\n{lens}");
    // The same by the inertial unit, from which both are moved and turned.
    let unit = "[[0, 1, 0, 0.3], [0, 0, 1, -0.1], [1, 0, 0, 0.2], [0, 0, 0, 1]]";
    let from_unit = "[[1, 0, 0, 0.2], [0, 0, 1, -0.1], [0, -1, 0, -0.19], [0, 0, 0, 1]]";
    let imu = format!("cam0:\n  T_cam_imu: {unit}\n{lens}cam1:\n  T_cam_imu: {from_unit}\n{lens}");
    let pair = OPENCV.replace("camera_matrix", "M1").replace("distortion_coefficients", "D1");
    let pair = format!(
        "{pair}M2: [[400, 0, 320], [0, 400, 240], [0, 0, 1]]\nD2: [0, 0, 0, 0]\nR: [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]\nT: [0, 0, 0.11]\n"
    );
    let point = |camera: &Spec, key: &str| match camera.parameters.find(key) {
        Some((Value::List(values), _)) => values
            .iter()
            .map(|v| match v {
                Value::Number(n) => (n * 1e6).round() / 1e6 + 0.0,
                _ => f64::NAN,
            })
            .collect::<Vec<_>>(),
        other => panic!("{key}: {other:?}"),
    };
    for (file, text) in [("camchain.yaml", chain), ("camchain-imucam.yaml", imu), ("stereo.yml", pair)] {
        let found = read(file, &text).unwrap();
        assert!(found.are_relative && !found.are_placed && found.warnings.is_empty(), "{file}");
        let cameras = &found.cameras;
        assert_eq!(point(&cameras[0], "position"), [0.0, 0.0, 0.0]);
        assert_eq!(point(&cameras[0], "look_at"), [0.0, 0.0, -1.0]);
        assert_eq!(point(&cameras[1], "position"), [0.11, 0.0, 0.0], "{file}");
        assert_eq!(point(&cameras[1], "look_at"), [-0.89, 0.0, 0.0], "{file}");
        assert_eq!(point(&cameras[1], "up"), [0.0, 1.0, 0.0]);
        if let Some(third) = cameras.get(2) {
            assert_eq!(point(third, "position"), [0.11, -0.2, 0.0]);
        }
    }
}

const CAMERAS: &str = "# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 2
1 OPENCV 640 480 500 510 321 246 -0.1 0.02 0.001 0.002
7 SIMPLE_RADIAL_FISHEYE 800 600 300 400 300 -0.02
";
/// The second one is turned by 180 degrees around x, and has no points.
const IMAGES: &str = "# Image list with two lines of data per image:
1 1 0 0 0 0.5 -0.25 2 1 left/a b.jpg
10 20 -1 30.5 40 5
2 0 1 0 0 0 0 3 7 right.jpg

";

/// The pinhole part of COLMAP's definition, in whose pictures the corner is at 0.
#[test]
fn colmaps_cameras_stand_where_it_says() {
    let found = read_with(&[("images.txt", IMAGES.as_bytes()), ("cameras.txt", CAMERAS.as_bytes())]).unwrap();
    assert!(found.are_placed);
    let [a, b] = &found.cameras[..] else { panic!("{found:?}") };
    assert_eq!([&*a.name, &*b.name], ["left/a b.jpg", "right.jpg"]);
    assert_eq!([&*a.kind, &*b.kind], ["opencv", "opencv-fisheye"]);
    // In the space of the first camera, it is the world's moved by (0.5, -0.25, 2).
    let (x, y) = ((0.1 + 0.5) / 3.0, (0.2 - 0.25) / 3.0);
    let r2: f64 = x * x + y * y;
    let radial = 1.0 - 0.1 * r2 + 0.02 * r2 * r2;
    let u = x * radial + 2.0 * 0.001 * x * y + 0.002 * (r2 + 2.0 * x * x);
    let v = y * radial + 2.0 * 0.002 * x * y + 0.001 * (r2 + 2.0 * y * y);
    let expected = DVec2::new(500.0 * u + 321.0, 510.0 * v + 246.0) - 0.5;
    let seen = pixel(a, [0.1, 0.2, 1.0]);
    assert!(seen.distance(expected) < 1e-4, "{seen} {expected}");
    // (x, y, z) -> (x, -y, 3 - z).
    let (x, y) = (0.4f64, -0.3f64);
    let (r, theta) = (DVec2::new(x, y).length(), atan2_f64(DVec2::new(x, y).length(), 1.0));
    let scale = theta * (1.0 - 0.02 * theta * theta) / r;
    let expected = DVec2::new(300.0 * x * scale + 400.0, 300.0 * y * scale + 300.0) - 0.5;
    let seen = pixel(b, [0.4, 0.3, 2.0]);
    assert!(seen.distance(expected) < 1e-4, "{seen} {expected}");
    // Alone, they say what they are but not where.
    let alone = read("cameras.txt", CAMERAS).unwrap();
    assert!(!alone.are_placed);
    assert_eq!([&*alone.cameras[0].name, &*alone.cameras[1].name], ["1", "7"]);
}

#[test]
fn colmaps_binary_files_say_the_same() {
    let mut cameras = 2u64.to_le_bytes().to_vec();
    let mut camera = |id: u32, model: i32, size: [u64; 2], numbers: &[f64]| {
        cameras.extend(id.to_le_bytes());
        cameras.extend(model.to_le_bytes());
        size.iter().for_each(|side| cameras.extend(side.to_le_bytes()));
        numbers.iter().for_each(|number| cameras.extend(number.to_le_bytes()));
    };
    camera(1, 4, [640, 480], &[500.0, 510.0, 321.0, 246.0, -0.1, 0.02, 0.001, 0.002]);
    camera(7, 8, [800, 600], &[300.0, 400.0, 300.0, -0.02]);
    let mut images = 2u64.to_le_bytes().to_vec();
    let mut image = |id: u32, pose: [f64; 7], camera: u32, name: &str, points: u64| {
        images.extend(id.to_le_bytes());
        pose.iter().for_each(|number| images.extend(number.to_le_bytes()));
        images.extend(camera.to_le_bytes());
        images.extend(name.as_bytes());
        images.push(0);
        images.extend(points.to_le_bytes());
        images.extend(vec![0u8; 24 * points as usize]);
    };
    image(1, [1.0, 0.0, 0.0, 0.0, 0.5, -0.25, 2.0], 1, "left/a b.jpg", 2);
    image(2, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 3.0], 7, "right.jpg", 0);
    let binary = read_with(&[("images.bin", &images), ("cameras.bin", &cameras)]).unwrap();
    let text = read_with(&[("images.txt", IMAGES.as_bytes()), ("cameras.txt", CAMERAS.as_bytes())]).unwrap();
    let plain = |found: &CalibratedCameras| {
        found
            .cameras
            .iter()
            .map(|c| c.parameters.0.iter().map(|(k, v, _)| (k.clone(), v.clone())).collect())
            .collect::<Vec<Vec<_>>>()
    };
    assert_eq!(plain(&binary), plain(&text));
    // At every length, it is refused and not more.
    for length in 0..images.len() {
        assert!(
            read_with(&[("images.bin", &images[..length]), ("cameras.bin", &cameras)]).is_err(),
            "{length}"
        );
    }
    let claimed = [&u64::MAX.to_le_bytes()[..], &images[8..]].concat();
    assert!(read_with(&[("images.bin", &claimed), ("cameras.bin", &cameras)]).is_err());
}

#[test]
fn transforms_have_opengls_axes() {
    // At (1, 2, 3), turned to look along +x: right is +z, up is +y.
    let text = r#"{"w": 640, "h": 480, "fl_x": 500, "fl_y": 510, "cx": 320, "cy": 240, "k1": -0.1, "camera_model": "OPENCV",
        "frames": [{"file_path": "./images/0001.png",
            "transform_matrix": [[0, 0, -1, 1], [0, 1, 0, 2], [1, 0, 0, 3], [0, 0, 0, 1]]}]}"#;
    let found = read("transforms.json", text).unwrap();
    assert_eq!(found.cameras[0].name, "images/0001.png");
    let (x, y) = (0.1f64, -0.2f64);
    let radial = 1.0 - 0.1 * (x * x + y * y);
    let expected = DVec2::new(500.0 * x * radial + 320.0, 510.0 * y * radial + 240.0) - 0.5;
    let seen = pixel(&found.cameras[0], [1.0 + 2.0, 2.0 + 0.4, 3.0 + 0.2]);
    assert!(seen.distance(expected) < 1e-4, "{seen} {expected}");
    // Blender's: an angle, and no size.
    let blender = r#"{"camera_angle_x": 0.6911112070083618, "frames": [{"file_path": "./train/r_0",
        "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}]}"#;
    let found = read("transforms_train.json", blender).unwrap();
    assert!(found.warnings[0].contains("taken for squares"), "{:?}", found.warnings);
    let camera = build(&CameraSpec::new(found.cameras[0].clone()), 1.0).unwrap();
    let edge = camera.project_f64(DVec3::new(tan_f64(0.6911112070083618 / 2.0), 0.0, 3.0), 0.0).unwrap();
    assert!((edge.x - 1.0).abs() < 1e-6 && (edge.y - 0.5).abs() < 1e-6, "{edge}");
}

#[test]
fn what_is_wrong_is_named() {
    let cases = [
        ("a.yml", OPENCV.replace("cols: 3", "cols: 2"), "3 rows and 2 columns, but 9 numbers"),
        ("a.yml", OPENCV.replace("image_width: 640", "more: 1"), "add image_width and image_height"),
        ("a.yml", OPENCV.replace("510., 245., 0.,", "510., 245., 7.,"), "upper triangular"),
        ("a.yml", OPENCV.replace("[ 500.", "[ -500."), "must be positive"),
        ("a.yml", OPENCV.replace(", 1.0e-02", ""), "1 columns, but 4 numbers"),
        ("a.yml", "just text\n".to_owned(), "no list of names"),
        ("a.yml", "a: [1, 2\n".to_owned(), "this is no YAML"),
        ("a.yml", "a: &b [1]\nc: *b\n".to_owned(), "aliases"),
        ("a.yml", format!("a: {}1{}", "[".repeat(100), "]".repeat(100)), "nested too deeply"),
        ("a.json", "{\"K\": [1,".to_owned(), "this is no JSON"),
        ("a.yml", "x: 1\n".to_owned(), "no camera matrix"),
        (
            "a.yml",
            OPENCV.replace("calibration_time: ", "distortion_model: mei\nx: "),
            "'mei' is not supported",
        ),
        ("cameras.txt", CAMERAS.replace("OPENCV 640", "FOV 640"), "cameras.txt:4:1: the camera model 'FOV'"),
        ("cameras.txt", CAMERAS.replace(" 0.001 0.002", ""), "OPENCV has 8 numbers, not 6"),
        ("cameras.txt", CAMERAS.replace("640 480", "x 480"), "'x' stands where the width should be"),
        ("cameras.txt", "# nothing\n".to_owned(), "there is no camera in this file"),
        (
            "transforms.json",
            "{\"frames\": [{\"transform_matrix\": [[1]]}]}".to_owned(),
            "frame 0: transform_matrix",
        ),
        (
            "transforms.json",
            "{\"frames\": [{\"transform_matrix\": [[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]}]}".to_owned(),
            "frame 0: the rotation of this camera is none",
        ),
        (
            "transforms.json",
            "{\"frames\": [{\"transform_matrix\": [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}".to_owned(),
            "mirrors",
        ),
        ("a.txt", "hello".to_owned(), "no file of calibrated cameras"),
        ("a.yml", String::new(), "the file is empty"),
    ];
    for (file, text, expected) in cases {
        let found = message(file, &text);
        assert!(found.contains(expected), "{expected}: {found}");
    }
    let missing = message("images.txt", IMAGES);
    assert!(missing.contains("cameras.txt"), "{missing}");
    let other = IMAGES.replace(" 1 left", " 3 left");
    let other = read_with(&[("images.txt", other.as_bytes()), ("cameras.txt", CAMERAS.as_bytes())]);
    assert!(other.unwrap_err().to_string().contains("has the camera 3, which is not in the file"));
    assert!(read_cameras(Path::new("/nowhere/cameras.txt"), &ReadOptions::default()).is_err());
}

/// Files with bytes that are changed, missing or doubled are read or refused.
#[test]
fn broken_files_do_no_harm() {
    let transforms = r#"{"w": 640, "h": 480, "fl_x": 500, "frames": [{"file_path": "a.png",
        "transform_matrix": [[0, 0, -1, 1], [0, 1, 0, 2], [1, 0, 0, 3], [0, 0, 0, 1]]}]}"#;
    let folder = tempfile::tempdir().unwrap();
    let mut state = 1u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for (name, text) in [("a.yml", OPENCV), ("cameras.txt", CAMERAS), ("transforms.json", transforms)] {
        for _ in 0..700 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..1 + next(4) {
                let at = next(bytes.len().max(1));
                if bytes.is_empty() {
                    break;
                }
                match next(4) {
                    0 => bytes[at] = next(256) as u8,
                    1 => drop(bytes.remove(at)),
                    2 => bytes.insert(at, b"-[]{}:,&*!%\n \"'0e.9"[next(19)]),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            let path = folder.path().join(name);
            std::fs::write(&path, &bytes).unwrap();
            if let Ok(found) = read_cameras(&path, &ReadOptions::default()) {
                for camera in found.cameras {
                    drop(build(&CameraSpec::new(camera), 1.3));
                }
            }
        }
    }
}

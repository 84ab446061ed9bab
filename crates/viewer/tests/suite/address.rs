//! A view that is kept in the address of the page, and the shape of pictures that is the camera's own.

use crate::common::{Client, Frame, Viewer, cornell, options, run};
use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Spec, Value};
use serde_json::{Value as Json, json};

fn is_full(frame: &Frame) -> bool {
    frame.header["preview"] == false
}

fn numbers(json: &Json) -> Vec<f64> {
    json.as_array()
        .unwrap()
        .iter()
        .flat_map(|part| part.as_array().unwrap())
        .map(|x| x.as_f64().unwrap())
        .collect()
}

#[test]
fn a_view_can_be_asked_for_and_comes_back() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let home = client.frame(is_full).await;
        assert!(home.header["zoom"].is_null(), "nobody has moved it: {}", home.header);
        let picture = home.number("picture");
        client.send(json!({ "do": "orbit", "by": [25, 10] })).await;
        let moved = client.frame(|frame| is_full(frame) && frame.number("picture") > picture).await;
        assert_eq!(moved.header["zoom"], 1.0);
        let eye = numbers(&moved.header["eye"]);
        assert_ne!(eye, numbers(&home.header["eye"]));
        // Another visitor, as after a reload, asks for it.
        let mut other = Client::connect(&viewer).await;
        other.frame(is_full).await;
        other.send(json!({ "do": "view", "position": eye[..3], "pivot": eye[3..], "zoom": 1.0 })).await;
        let again = other.frame(|frame| is_full(frame) && !frame.header["zoom"].is_null()).await;
        let off =
            numbers(&again.header["eye"]).iter().zip(&eye).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{} for {}", again.header["eye"], moved.header["eye"]);
        other.send(json!({ "do": "home" })).await;
        let back = other.frame(|frame| is_full(frame) && frame.header["zoom"].is_null()).await;
        assert_eq!(back.header["eye"], home.header["eye"]);
    });
}

#[test]
fn a_panorama_keeps_its_shape_in_any_window() {
    let all_around = || {
        let mut scene = cornell()?;
        let eye = Spec::new("", "panorama").with("position", Value::triple([0.278, 0.273, -0.3]));
        scene.cameras = vec![CameraSpec::new(eye.with("look_at", Value::triple([0.278, 0.273, 0.0])))];
        Ok(scene)
    };
    let viewer = Viewer::with(options(all_around));
    run(async {
        let mut client = Client::connect(&viewer).await;
        for (window, shown) in [([64, 64], [64, 32]), ([200, 40], [80, 40]), ([39, 84], [39, 20])] {
            client.send(json!({ "do": "size", "to": window })).await;
            let full = json!(shown);
            let frame = client.frame(|frame| is_full(frame) && frame.header["full"] == full).await;
            assert_eq!(frame.header["size"], full, "{window:?}");
        }
    });
}

/// The time can be chosen if anything moves: an object, or the camera alone.
#[test]
fn whatever_moves_has_a_time_to_choose() {
    use bilux::math::{Motion, MotionKey, Quat, Vec3};
    use bilux::scene::{Parameters, SceneBuilder};
    let still = |scene: &mut SceneBuilder| scene.cameras.truncate(1);
    let camera = |scene: &mut SceneBuilder| {
        let mut moves = Parameters::default();
        moves.set("position", Value::triple([0.3, 0.3, -1.0]));
        scene.cameras[0].keyframes = vec![(0.0, Parameters::default()), (2.5, moves)];
    };
    let object = |scene: &mut SceneBuilder| {
        let key = |time_seconds: f32| MotionKey {
            time_seconds,
            translation: Vec3::X * 0.01 * time_seconds,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        scene.objects[1].motion = Motion::from_keys(vec![key(0.0), key(1.5)]).unwrap();
    };
    type Change = fn(&mut SceneBuilder);
    let changes = [(still as Change, Json::Null), (camera, json!(2.5)), (object, json!(1.5))];
    for (change, seconds) in changes {
        let viewer = Viewer::with(options(move || {
            let mut scene = cornell()?;
            change(&mut scene);
            Ok(scene)
        }));
        let state = run(async { Client::connect(&viewer).await.text("state", |_| true).await });
        assert_eq!(state["seconds"], seconds);
    }
}

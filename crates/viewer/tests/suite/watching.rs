//! Views of those who watch: frames that get better, moves of the camera, settings, layers, picked pixels, files.

use crate::common::{Client, Frame, Viewer, cornell, get, options, run};
use bilux::pictures::{Limits, read_bytes};
use bilux::scene::SceneBuilder;
use bilux::{Job, Quiet};
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

fn picture(frame: &Frame) -> bilux::pictures::Picture {
    read_bytes(&frame.bytes, None, &Limits::default()).unwrap()
}

#[test]
fn frames_get_better_until_the_picture_rests_without_loss() {
    let viewer = Viewer::start();
    let last = run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(|_| true).await;
        assert_eq!(first.header["type"], "image/jpeg");
        assert_eq!(first.header["full"], json!([48, 40]));
        let mut before = 0;
        loop {
            let frame = client.frame(|frame| frame.header["preview"] == false).await;
            assert!(frame.number("samples") > before && frame.number("total") == 16);
            before = frame.number("samples");
            if frame.rests() {
                return frame;
            }
        }
    });
    assert_eq!((last.number("samples"), &last.header["type"]), (16, &json!("image/png")));
    assert!(last.header["noise"].as_f64().is_some_and(|noise| noise > 0.0 && noise < 1.0), "{}", last.header);
    // The same bytes as by the command line.
    let mut user = options(cornell).settings;
    user.set("build", "balanced");
    let job = Job::new(&cornell().unwrap(), &user).unwrap();
    let rendered = job.render(&Quiet).unwrap().picture().unwrap();
    let options = job.write_options_for(&rendered).unwrap();
    assert!(bilux::pictures::write_bytes("png", &rendered, &options).unwrap() == last.bytes);
}

#[test]
fn moves_of_the_camera_show_another_picture_and_home_is_where_it_began() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        for message in [
            json!({ "do": "orbit", "by": [20, 5] }),
            json!({ "do": "pan", "by": [0.1, 0.1] }),
            json!({ "do": "approach", "by": 1.5 }),
            json!({ "do": "look", "by": [3, 3] }),
            json!({ "do": "fly", "by": [0.1, 0, -0.1] }),
            json!({ "do": "focus", "at": [0.3, 0.4] }),
        ] {
            let what = message.to_string();
            client.send(message).await;
            let moved = client.frame(|frame| frame.header["picture"] != first.header["picture"]).await;
            assert_ne!(moved.header["eye"], first.header["eye"], "{what}");
            let rested = client.frame(Frame::rests).await;
            assert_ne!(rested.bytes, first.bytes, "{what}");
            client.send(json!({ "do": "home" })).await;
            let home =
                client.frame(|frame| frame.rests() && frame.number("frame") > rested.number("frame")).await;
            assert!(home.bytes == first.bytes, "after {what}, home shows another picture than before");
        }
    });
}

#[test]
fn the_command_line_makes_the_picture_that_is_shown() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        client.send(json!({ "do": "orbit", "by": [33, -7] })).await;
        client.send(json!({ "do": "set", "key": "exposure", "value": 0.5 })).await;
        let state = client
            .text("state", |state| {
                state["command"].as_str().unwrap().contains("--spp 16 --integrator path --exposure 0.5 --eye")
            })
            .await;
        client.frame(|frame| frame.rests() && frame.header["eye"] != first.header["eye"]).await;
        let command = state["command"].as_str().unwrap();
        assert!(command.starts_with("bilux render cornell.toml -o picture.png --size 48x40"), "{command}");
        let after =
            |option: &str| command.split(option).nth(1).unwrap().split(' ').nth(1).unwrap().to_owned();
        let mut user = options(cornell).settings;
        user.set("exposure", bilux::scene::Value::Number(0.5));
        user.set("eye", after("--eye"));
        user.set("look_at", after("--look-at"));
        let job = Job::new(&cornell().unwrap(), &user).unwrap();
        let rendered = job.render(&Quiet).unwrap().picture().unwrap();
        let bytes = bilux::pictures::write_bytes("png", &rendered, &job.write_options().unwrap()).unwrap();
        let (head, saved) = get(viewer.host(), "/picture.png", viewer.host(), "").await;
        assert!(head.starts_with("HTTP/1.1 200") && head.contains("attachment"), "{head}");
        assert!(saved == bytes, "the saved picture is another one");
        let (_, exr) = get(viewer.host(), "/picture.exr", viewer.host(), "").await;
        let exr = read_bytes(&exr, Some("exr"), &Limits::default()).unwrap();
        assert_eq!(exr.channels()[0].samples, rendered.channels()[0].samples);
    });
}

#[test]
fn settings_change_what_is_shown_and_wrong_ones_change_nothing() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        client.send(json!({ "do": "set", "key": "exposure", "value": 1 })).await;
        let brighter = client.frame(Frame::rests).await;
        assert_eq!(brighter.header["picture"], first.header["picture"], "samples are kept");
        assert_ne!(brighter.bytes, first.bytes);
        for (key, value) in [
            ("integrator", json!("cast")),
            ("accel", json!("bsp")),
            ("max_depth", json!(1)),
            ("integrator", json!("auto")),
            ("denoise", json!("builtin")),
        ] {
            client.send(json!({ "do": "set", "key": key, "value": value })).await;
            let state = client.text("state", |state| state["settings"][key] == value).await;
            assert!(state["problem"].is_null(), "{state}");
            client.frame(Frame::rests).await;
        }
        for (key, value) in [
            ("integrator", json!("psychic")),
            ("max_depth", json!(-1)),
            // What is refused again is answered again: the page then shows the value that counts.
            ("max_depth", json!(-1)),
            ("exposure", json!("bright")),
            ("threads", json!(1)),
            ("size", json!("9x9")),
        ] {
            client.send(json!({ "do": "set", "key": key, "value": value })).await;
            let state = client.text("state", |state| state["problem"].is_string()).await;
            assert_ne!(state["settings"][key], value, "{key}");
        }
        client.send(json!({ "do": "set", "key": "seed", "value": 3 })).await;
        client.text("state", |state| state["problem"].is_null() && state["settings"]["seed"] == 3).await;
        client.frame(Frame::rests).await;
    });
}

#[test]
fn the_picture_follows_the_window_and_layers_take_its_place() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.send(json!({ "do": "size", "to": [70, 30] })).await;
        let frame = client.frame(|frame| frame.rests() && frame.header["full"] == json!([70, 30])).await;
        assert_eq!((picture(&frame).width(), picture(&frame).height()), (70, 30));
        for layer in ["albedo", "normal", "depth", "ids"] {
            client.send(json!({ "do": "show", "what": layer })).await;
            client.text("state", |state| state["shown"] == layer).await;
            let shown = client.frame(|frame| frame.rests() && frame.header["shown"] == layer).await;
            assert_ne!(shown.bytes, frame.bytes, "{layer}");
        }
        client.send(json!({ "do": "show", "what": "variance" })).await;
        client.text("state", |state| state["problem"].is_string()).await;
        client.send(json!({ "do": "show", "what": "picture" })).await;
        // What is refused still shows the layer once more, so that a frame of it may come first.
        let again = client.frame(|frame| frame.rests() && frame.header["shown"] == "picture").await;
        assert!(again.bytes == frame.bytes);
    });
}

#[test]
fn a_picked_pixel_says_what_is_there_and_how_light_reaches_it() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.frame(Frame::rests).await;
        client.send(json!({ "do": "pick", "at": [0.2, 0.9], "paths": 8 })).await;
        let picked = client.text("picked", |_| true).await;
        assert_eq!(picked["pixel"], json!([9, 36]));
        let surface = &picked["surface"];
        assert!(surface["object"].is_string() && surface["material"]["kind"] == "diffuse", "{surface}");
        assert!(surface["position"][1].as_f64().unwrap().abs() < 0.01, "it is the floor: {surface}");
        for channel in 0..3 {
            let [mean, half] = ["mean", "half"].map(|key| picked["interval"][channel][key].as_f64().unwrap());
            let light = picked["light"][channel].as_f64().unwrap();
            // The interval is that of 256 samples; the picture has 16.
            assert!(half > 0.0 && (light - mean).abs() < 16.0 * half, "{light} {mean} {half}");
        }
        let paths = picked["paths"].as_array().unwrap();
        assert_eq!(paths.len(), 8);
        let segments: Vec<_> = paths.iter().flat_map(|path| path["segments"].as_array().unwrap()).collect();
        let brings = |kind: &str| segments.iter().filter(|segment| segment["kind"] == kind).count();
        assert!(brings("light sample") > 0 && brings("reflection") > 0, "{segments:?}");
        for end in segments.iter().flat_map(|segment| [&segment["from"], &segment["to"]]) {
            assert!((0..2).all(|axis| (0.0..1.0).contains(&end[axis].as_f64().unwrap())), "{end}");
        }
        // Every path begins at the pixel.
        for path in paths {
            let first = &path["segments"][0];
            assert!((first["to"][1].as_f64().unwrap() - 0.9).abs() < 0.05, "{first}");
        }
    });
}

/// A scene that changes when it is opened again.
fn changing(count: Arc<AtomicUsize>, file: std::path::PathBuf) -> impl Fn() -> Result<SceneBuilder, String> {
    move || {
        count.fetch_add(1, Ordering::Relaxed);
        let text = std::fs::read_to_string(&file).map_err(|error| error.to_string())?;
        let mut scene = cornell()?;
        scene.files.insert(file.clone());
        match text.as_str() {
            "broken" => Err("line 3 is broken".to_owned()),
            "other" => {
                scene.objects.pop();
                Ok(scene)
            }
            _ => Ok(scene),
        }
    }
}

#[test]
fn a_changed_file_is_shown_and_a_broken_one_leaves_the_old_picture() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.txt");
    std::fs::write(&file, "first").unwrap();
    let count = Arc::new(AtomicUsize::new(0));
    let viewer = Viewer::with(options(changing(count.clone(), file.clone())));
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        tokio::time::sleep(Duration::from_millis(900)).await;
        std::fs::write(&file, "broken").unwrap();
        let state = client.text("state", |state| state["problem"].is_string()).await;
        assert_eq!(state["problem"], "line 3 is broken");
        std::fs::remove_file(&file).unwrap();
        client.text("state", |state| state["problem"].as_str().is_some_and(|p| !p.contains("line 3"))).await;
        std::fs::write(&file, "other").unwrap();
        let other = client.text("state", |state| state["problem"].is_null()).await;
        assert_eq!(other["objects"].as_u64().unwrap() + 1, cornell().unwrap().objects.len() as u64);
        let shown =
            client.frame(|frame| frame.rests() && frame.number("picture") > first.number("picture")).await;
        assert_ne!(shown.bytes, first.bytes);
    });
}

#[test]
fn materials_are_edited_only_if_that_is_allowed_and_edits_are_undone() {
    let edit = |value: f64| json!({ "do": "edit", "part": "material", "number": 0, "key": "reflectance", "value": [value, 0.2, 0.2] });
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.send(edit(0.9)).await;
        let state = client.text("state", |state| state["problem"].is_string()).await;
        assert!(state["problem"].as_str().unwrap().contains("--edit") && state["parts"] == json!({}));
    });
    let viewer = Viewer::with(bilux_viewer::Options { may_edit: true, ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        // A slider: all of it is one step.
        for value in [0.1, 0.5, 0.9] {
            client.send(edit(value)).await;
        }
        client
            .text("state", |state| state["parts"]["material"][0]["parameters"]["reflectance"][0] == 0.9)
            .await;
        let edited = client.frame(Frame::rests).await;
        assert_ne!(edited.bytes, first.bytes);
        client.send(json!({ "do": "undo" })).await;
        client.text("state", |state| state["can_undo"] == false && state["can_redo"] == true).await;
        let undone = client.frame(Frame::rests).await;
        assert!(undone.bytes == first.bytes);
        client.send(json!({ "do": "redo" })).await;
        client.text("state", |state| state["can_redo"] == false).await;
        assert!(client.frame(Frame::rests).await.bytes == edited.bytes);
        client
            .send(
                json!({ "do": "edit", "part": "material", "number": 99, "key": "reflectance", "value": 0.1 }),
            )
            .await;
        client.text("state", |state| state["problem"].is_string()).await;
        client
            .send(
                json!({ "do": "edit", "part": "material", "number": 0, "key": "reflectanse", "value": 0.1 }),
            )
            .await;
        client
            .text("state", |state| state["problem"].as_str().is_some_and(|p| p.contains("reflectance")))
            .await;
    });
}

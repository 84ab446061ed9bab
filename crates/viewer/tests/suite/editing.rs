//! Edits of materials, lights and cameras, what is saved of them, and files that are dropped in.

use crate::common::{Client, Frame, Viewer, cornell, get, options, post, run};
use bilux::formats::{ReadOptions, WriteOptions};
use bilux::pictures::write_bytes;
use bilux::scene::{Parameters, Value};
use bilux::{Job, Quiet};
use bilux_viewer::{Opening, Options};
use serde_json::{Value as Json, json};
use std::path::Path;

fn edit(part: &str, key: &str, value: impl Into<Json>) -> Json {
    json!({ "do": "edit", "part": part, "number": 0, "key": key, "value": value.into() })
}

fn load(path: &Path) -> Result<bilux::scene::SceneBuilder, String> {
    bilux::load(path, &ReadOptions::default()).map_err(|error| error.to_string())
}

/// A viewer of a file that opens others too.
fn viewer_of(folder: &Path) -> Viewer {
    let scene = folder.join("cornell.toml");
    bilux::formats::write(&scene, &cornell().unwrap(), &WriteOptions::default()).unwrap();
    let open = move |opening: &Opening| load(opening.file.as_deref().unwrap_or(&scene));
    Viewer::with(Options { may_edit: true, may_drop: true, open: Box::new(open), ..options(cornell) })
}

#[test]
fn lights_and_cameras_are_edited_and_all_of_it_is_undone() {
    let viewer = Viewer::with(Options { may_edit: true, ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        let edits = [
            edit("light", "radiance", json!([5.0, 9.0, 20.0])),
            edit("camera", "fov", 60.0),
            edit("material", "reflectance", 0.1),
        ];
        let mut before = vec![first.bytes];
        for edit in edits {
            let (part, key) =
                (edit["part"].as_str().unwrap().to_owned(), edit["key"].as_str().unwrap().to_owned());
            client.send(edit.clone()).await;
            client.text("state", |state| state["parts"][&part][0]["parameters"][&key] == edit["value"]).await;
            let edited = client.frame(Frame::rests).await;
            assert!(Some(&edited.bytes) != before.last(), "{edit}");
            before.push(edited.bytes);
        }
        before.pop();
        while let Some(bytes) = before.pop() {
            client.send(json!({ "do": "undo" })).await;
            client.text("state", |state| state["can_redo"] == true).await;
            assert!(client.frame(Frame::rests).await.bytes == bytes, "{} are left", before.len());
        }
        client.send(edit("light", "radianse", 1.0)).await;
        let state = client.text("state", |state| state["problem"].is_string()).await;
        assert!(state["problem"].as_str().unwrap().contains("radiance"), "{}", state["problem"]);
        client.send(edit("camera", "fov", 500.0)).await;
        client.text("state", |state| state["problem"].as_str().is_some_and(|p| p.contains("179"))).await;
    });
}

#[test]
fn what_was_edited_is_saved_as_an_overlay_and_as_changes() {
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.frame(Frame::rests).await;
        client.send(edit("light", "radiance", json!([5.0, 9.0, 20.5]))).await;
        client.send(edit("camera", "fov", 50.25)).await;
        client.send(json!({ "do": "set", "key": "exposure", "value": 0.5 })).await;
        client.send(json!({ "do": "orbit", "by": [10, 0] })).await;
        let state = client
            .text("state", |state| {
                // Edits of the scene are made by another thread than what a view alone is about.
                let is_edited = state["command"].as_str().is_some_and(|all| all.contains("--change camera"));
                is_edited && state["moved"] == true && state["settings"]["exposure"] == 0.5
            })
            .await;
        let shown = client.frame(Frame::rests).await;
        let command = state["command"].as_str().unwrap();
        for change in ["--change light:lamp:radiance=5,9,20.5", "--change camera:front:fov=50.25"] {
            assert!(command.contains(change), "{command}");
        }
        let (head, overlay) = get(viewer.host(), "/overlay.toml", viewer.host(), "").await;
        assert!(head.contains("edited.toml"), "{head}");
        let path = folder.path().join("edited.toml");
        std::fs::write(&path, overlay).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("base = \"cornell.toml\"") && text.contains("spp = 16"), "{text}");
        let mut user = Parameters::default();
        user.set("build", "balanced");
        user.set("noise", Value::Integer(0));
        user.set("time_limit", Value::Integer(0));
        let job = Job::new(&load(&path).unwrap(), &user).unwrap();
        let rendered = job.render(&Quiet).unwrap().picture().unwrap();
        let bytes = write_bytes("png", &rendered, &job.write_options_for(&rendered).unwrap()).unwrap();
        assert!(bytes == shown.bytes, "the overlay makes another picture: {text}");
    });
}

#[test]
fn edits_outlive_a_change_of_the_scene_that_they_fit() {
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    let scene = folder.path().join("cornell.toml");
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.frame(Frame::rests).await;
        client.send(edit("light", "radiance", json!([5.0, 9.0, 20.5]))).await;
        client.text("state", |state| state["can_undo"] == true).await;
        tokio::time::sleep(std::time::Duration::from_millis(900)).await;
        let text = std::fs::read_to_string(&scene).unwrap();
        std::fs::write(&scene, text.replace("fov = 39.3077", "fov = 45")).unwrap();
        let fov = |state: &Json| state["parts"]["camera"][0]["parameters"]["fov"].clone();
        let state = client.text("state", |state| fov(state) == 45.0 || fov(state) == 45).await;
        assert_eq!(state["parts"]["light"][0]["parameters"]["radiance"], json!([5.0, 9.0, 20.5]));
        std::fs::write(&scene, text.replace("name = \"lamp\"", "name = \"other\"")).unwrap();
        let state = client.text("state", |state| state["problem"].is_string()).await;
        assert!(state["problem"].as_str().unwrap().contains("do not fit"), "{}", state["problem"]);
        assert!(state["can_undo"] == false && state["parts"]["light"][0]["name"] == "other");
    });
}

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_file_that_is_dropped_in_is_opened_and_a_broken_one_leaves_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        let (host, own) = (viewer.host(), format!("Origin: http://{}\r\n", viewer.host()));
        let answer = post(host, "/open/broken.glb", &own, b"this is no model").await;
        assert!(answer.starts_with("HTTP/1.1 422") && answer.contains("broken.glb"), "{answer}");
        assert!(!answer.contains("bilux-"), "the folder is nobody's business: {answer}");
        client.send(json!({ "do": "set", "key": "seed", "value": 1 })).await;
        let state = client.text("state", |state| state["settings"]["seed"] == 1).await;
        assert_eq!((&state["title"], &state["triangles"]), (&json!("cornell"), &json!(48)));
        let answer = post(host, "/open/..%2F..%2Ftriangle.obj", &own, TRIANGLE).await;
        assert!(answer.starts_with("HTTP/1.1 204"), "{answer}");
        let state = client.text("state", |state| state["title"] == "triangle.obj").await;
        assert!(state["triangles"] != 48 && state["problem"].is_null(), "{state}");
        let command = state["command"].as_str().unwrap();
        assert!(command.starts_with("bilux render triangle.obj -o"), "{command}");
        assert_ne!(client.frame(Frame::rests).await.bytes, first.bytes);
        for (path, headers, status) in [
            ("/open/a.obj", "Origin: http://evil.example\r\n", "403"),
            ("/open/a.obj", "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\n", "403"),
            ("/open/run.sh", "", "415"),
            ("/open/", "", "404"),
        ] {
            let answer = post(host, path, headers, TRIANGLE).await;
            assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{path} {headers}: {answer}");
        }
    });
}

/// Settings of the camera are about the scene that they were made for: another one may have no such camera.
#[test]
fn another_file_is_seen_by_its_own_camera() {
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    run(async {
        let (mut client, mut other) = (Client::connect(&viewer).await, Client::connect(&viewer).await);
        client.send(json!({ "do": "set", "key": "camera", "value": "front" })).await;
        client.send(json!({ "do": "set", "key": "exposure", "value": 0.5 })).await;
        client.text("state", |state| state["settings"]["exposure"] == 0.5).await;
        let answer = post(viewer.host(), "/open/triangle.obj", "", TRIANGLE).await;
        assert!(answer.starts_with("HTTP/1.1 204"), "{answer}");
        for client in [&mut client, &mut other] {
            let state = client.text("state", |state| state["title"] == "triangle.obj").await;
            assert!(state["problem"].is_null() && state["cameras"] == json!(["studio"]), "{state}");
        }
        // What is not about the camera stays.
        client.send(json!({ "do": "set", "key": "seed", "value": 1 })).await;
        client
            .text("state", |state| state["settings"]["exposure"] == 0.5 && state["settings"]["seed"] == 1)
            .await;
    });
}

#[test]
fn files_come_one_at_a_time() {
    use tokio::io::AsyncWriteExt;
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    run(async {
        let host = viewer.host();
        let mut slow = tokio::net::TcpStream::connect(host).await.unwrap();
        let head =
            format!("POST /open/a.obj HTTP/1.1\r\nHost: {host}\r\nContent-Length: 99\r\n\r\nv 0 0 0\n");
        slow.write_all(head.as_bytes()).await.unwrap();
        let mut answer = post(host, "/open/b.obj", "", TRIANGLE).await;
        // The server may take the second one first.
        while answer.starts_with("HTTP/1.1 204") {
            answer = post(host, "/open/b.obj", "", TRIANGLE).await;
        }
        assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("try again"), "{answer}");
        drop(slow);
        while !answer.starts_with("HTTP/1.1 204") {
            tokio::time::sleep(std::time::Duration::from_millis(20)).await;
            answer = post(host, "/open/b.obj", "", TRIANGLE).await;
        }
    });
}

#[test]
fn without_edit_nothing_is_opened_and_no_file_is_too_large() {
    let viewer = Viewer::with(Options { may_drop: true, ..options(cornell) });
    run(async {
        let answer = post(viewer.host(), "/open/a.obj", "", TRIANGLE).await;
        assert!(answer.starts_with("HTTP/1.1 403") && answer.contains("--edit"), "{answer}");
    });
    let folder = tempfile::tempdir().unwrap();
    let viewer = viewer_of(folder.path());
    run(async {
        // What it says is enough: nothing of it is taken.
        let (head, _) = get_with_length(viewer.host(), 1 << 40).await;
        assert!(head.starts_with("HTTP/1.1 413"), "{head}");
    });
}

/// Begins to send a file of this length.
async fn get_with_length(host: &str, length: u64) -> (String, Vec<u8>) {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let mut stream = tokio::net::TcpStream::connect(host).await.unwrap();
    let head =
        format!("POST /open/a.obj HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n\r\nv 0 0 0\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    let mut answer = vec![0; 4096];
    let got = stream.read(&mut answer).await.unwrap();
    (String::from_utf8_lossy(&answer[..got]).into_owned(), Vec::new())
}

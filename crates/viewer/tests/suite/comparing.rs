//! Two pictures side by side, and accelerators beside each other.

use crate::common::{Client, Frame, Viewer, cornell, options, run};
use bilux::accel::ACCELERATORS;
use bilux::{Job, Quiet};
use bilux_viewer::Options;
use serde_json::{Value as Json, json};

fn is_other(frame: &Frame) -> bool {
    frame.header["side"] == "other"
}

#[test]
fn another_integrator_is_rendered_beside_the_picture_until_both_rest() {
    let viewer = Viewer::start();
    let (own, other, differences) = run(async {
        let mut client = Client::connect(&viewer).await;
        let own = client.frame(Frame::rests).await;
        client
            .send(json!({ "do": "compare", "with": "setting", "key": "integrator", "value": "light" }))
            .await;
        let state = client.text("state", |state| state["comparison"].is_object()).await;
        assert_eq!(state["comparison"]["value"], "light");
        let first = client.frame(is_other).await;
        assert!(first.header["difference"].as_f64().is_some_and(|x| x > 0.0), "{}", first.header);
        let mut last = first.clone();
        while !last.rests() {
            let next = client.frame(is_other).await;
            assert!(next.number("samples") >= last.number("samples"));
            assert!(next.header["seconds"].as_f64() >= last.header["seconds"].as_f64());
            last = next;
        }
        assert!(last.header["noise"].as_f64().is_some_and(|noise| noise > 0.0), "{}", last.header);
        client.send(json!({ "do": "differences", "show": true })).await;
        let map = client.frame(|frame| is_other(frame) && frame.header["shown"] == "differences").await;
        (own, last, map)
    });
    assert!(other.bytes != own.bytes && differences.bytes != other.bytes);
    // It is the picture that the command line makes with that integrator.
    let mut user = options(cornell).settings;
    user.set("build", "balanced");
    user.set("integrator", "light");
    let job = Job::new(&cornell().unwrap(), &user).unwrap();
    let rendered = job.render(&Quiet).unwrap().picture().unwrap();
    let bytes = bilux::pictures::write_bytes("png", &rendered, &job.write_options().unwrap()).unwrap();
    assert!(bytes == other.bytes);
}

#[test]
fn the_scene_before_the_edits_is_shown_beside_it_and_follows_the_camera() {
    let viewer = Viewer::with(Options { may_edit: true, ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        client
            .send(json!({ "do": "edit", "part": "light", "number": 0, "key": "radiance", "value": 3 }))
            .await;
        let edited = client.frame(Frame::rests).await;
        client.send(json!({ "do": "compare", "with": "unedited" })).await;
        let other = client.frame(|frame| is_other(frame) && frame.rests()).await;
        assert!(other.bytes == first.bytes && edited.bytes != first.bytes);
        for show in [true, false] {
            client.send(json!({ "do": "differences", "show": show })).await;
            let state = client.text("state", |state| state["comparison"]["differences"] == show).await;
            assert_eq!(state["comparison"], json!({ "with": "unedited", "differences": show }));
        }
        client.send(json!({ "do": "orbit", "by": [20, 0] })).await;
        let moved = client
            .frame(|frame| is_other(frame) && frame.rests() && frame.header["eye"] != other.header["eye"])
            .await;
        assert!(moved.bytes != other.bytes);
        client.send(json!({ "do": "compare", "with": "nothing" })).await;
        client.text("state", |state| state["comparison"].is_null()).await;
        // What cannot be compared leaves everything as it is.
        for (key, value) in [("threads", json!(1)), ("integrator", json!("psychic"))] {
            client.send(json!({ "do": "compare", "with": "setting", "key": key, "value": value })).await;
            client.text("state", |state| state["problem"].is_string() && state["comparison"].is_null()).await;
        }
        client.send(json!({ "do": "home" })).await;
        client.frame(|frame| frame.rests() && frame.bytes == edited.bytes).await;
    });
}

#[test]
fn accelerators_are_measured_beside_each_other_and_their_visits_are_shown() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let picture = client.frame(Frame::rests).await;
        client.send(json!({ "do": "measure" })).await;
        let mut rows: Vec<Json> = Vec::new();
        while rows.last().is_none_or(|row| row["is_last"] != true) {
            rows.push(client.text("accelerator", |_| true).await);
        }
        let names: Vec<_> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
        assert_eq!(names, ACCELERATORS.iter().map(|row| row.entry.name).collect::<Vec<_>>());
        for row in &rows {
            assert!(row["rate"].as_f64().is_some_and(|rate| rate > 1000.0), "{row}");
        }
        // Each builds all of them: of two who ask at the same time, one has to ask again later.
        let mut other = Client::connect(&viewer).await;
        let mut refusal = None;
        for _ in 0..20 {
            for visitor in [&mut client, &mut other] {
                visitor.send(json!({ "do": "measure" })).await;
            }
            for visitor in [&mut client, &mut other] {
                let last = visitor.text("accelerator", |row| row["is_last"] == true).await;
                refusal = last["why_not"].as_str().map(str::to_owned).or(refusal);
            }
            if refusal.is_some() {
                break;
            }
        }
        assert!(refusal.is_some_and(|why| why.contains("another")));
        let tests =
            |name: &str| rows.iter().find(|row| row["name"] == name).unwrap()["tests"].as_f64().unwrap();
        assert!(tests("brute") > 2.0 * tests("bvh"), "brute force tests them all");
        client.send(json!({ "do": "set", "key": "accel", "value": "brute" })).await;
        client.send(json!({ "do": "show", "what": "visits" })).await;
        let visits = |frame: &Frame| frame.header["shown"] == "visits" && frame.rests();
        let brute = client.frame(visits).await;
        client.send(json!({ "do": "set", "key": "accel", "value": "bvh" })).await;
        let bvh = client.frame(|frame| visits(frame) && frame.bytes != brute.bytes).await;
        assert!(bvh.bytes != picture.bytes);
    });
}

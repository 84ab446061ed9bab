//! Several visitors of one scene: each has a view of their own, unless they share one, and nobody is left behind.

use crate::common::{Client, Frame, Viewer, cornell, get, options, run};
use bilux::scene::Value;
use bilux_viewer::Options;
use serde_json::{Value as Json, json};
use std::time::{Duration, Instant};

async fn reconnected(viewer: &Viewer, key: &str) -> Client {
    let address = format!("{}socket?visitor={key}", viewer.address.replacen("http", "ws", 1));
    Client::connect_to(&address, &[]).await.unwrap()
}

#[test]
fn each_visitor_has_a_camera_and_settings_of_their_own_and_the_scene_is_shared() {
    let viewer = Viewer::with(Options { may_edit: true, ..options(cornell) });
    run(async {
        let mut one = Client::connect(&viewer).await;
        let mut two = Client::connect(&viewer).await;
        let [first, same] = [one.frame(Frame::rests).await, two.frame(Frame::rests).await];
        assert!(first.bytes == same.bytes, "they begin alike");
        one.send(json!({ "do": "orbit", "by": [25, 5] })).await;
        one.send(json!({ "do": "set", "key": "exposure", "value": 1 })).await;
        one.text("state", |state| state["moved"] == true && state["settings"]["exposure"] == 1).await;
        let moved = one.frame(|frame| frame.rests() && frame.header["eye"] != first.header["eye"]).await;
        // The other one has got nothing of that, and still has its own picture.
        two.send(json!({ "do": "set", "key": "seed", "value": 0 })).await;
        let state = two.text("state", |state| state["served"].as_u64() > Some(0)).await;
        assert_eq!(
            (&state["moved"], &state["settings"]["exposure"]),
            (&json!(false), &json!("0")),
            "{state}"
        );
        let still = two.frame(Frame::rests).await;
        assert!(still.header["eye"] == first.header["eye"] && still.bytes == first.bytes);
        // Each saves their own picture.
        for (client, frame) in [(&one, &moved), (&two, &still)] {
            let path = format!("/picture.png?visitor={}", client.key);
            let (head, saved) = get(viewer.host(), &path, viewer.host(), "").await;
            assert!(head.starts_with("HTTP/1.1 200") && saved == frame.bytes, "{head}");
        }
        let (head, _) = get(viewer.host(), "/picture.png", viewer.host(), "").await;
        assert!(head.starts_with("HTTP/1.1 503"), "whose picture? {head}");
        // An edit is of the scene, and both see it.
        one.send(json!({ "do": "edit", "part": "light", "number": 0, "key": "radiance", "value": 3 })).await;
        let radiance = |state: &Json| state["parts"]["light"][0]["parameters"]["radiance"] == 3;
        one.text("state", radiance).await;
        two.text("state", radiance).await;
        let darker = two.frame(Frame::rests).await;
        assert!(darker.bytes != still.bytes && darker.header["eye"] == first.header["eye"]);
        one.frame(|frame| frame.rests() && frame.header["eye"] == moved.header["eye"]).await;
        // What is wrong is said to whoever has asked only.
        two.send(json!({ "do": "edit", "part": "light", "number": 9, "key": "radiance", "value": 3 })).await;
        two.text("state", |state| state["problem"].as_str().is_some_and(|p| p.contains("light 9"))).await;
        one.send(json!({ "do": "home" })).await;
        let state = one.text("state", |state| state["moved"] == false).await;
        assert!(state["problem"].is_null() && state["can_undo"] == true, "{state}");
    });
}

#[test]
fn a_shared_view_is_one_picture_for_all() {
    let viewer = Viewer::with(Options { shared: true, ..options(cornell) });
    run(async {
        let mut one = Client::connect(&viewer).await;
        let mut two = Client::connect(&viewer).await;
        let first = two.frame(Frame::rests).await;
        one.send(json!({ "do": "orbit", "by": [25, 5] })).await;
        let moved = two.frame(|frame| frame.rests() && frame.header["eye"] != first.header["eye"]).await;
        let (_, saved) = get(viewer.host(), "/picture.png", viewer.host(), "").await;
        assert!(saved == moved.bytes);
    });
}

#[test]
fn a_visitor_whose_connection_is_lost_finds_the_same_view_again() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let first = client.frame(Frame::rests).await;
        client.send(json!({ "do": "orbit", "by": [25, 5] })).await;
        let moved = client.frame(|frame| frame.rests() && frame.header["eye"] != first.header["eye"]).await;
        let key = client.key.clone();
        assert_eq!(key.len(), 32);
        drop(client);
        let mut again = reconnected(&viewer, &key).await;
        assert_eq!(again.key, key);
        assert!(again.frame(Frame::rests).await.bytes == moved.bytes);
        // A key that nobody has is a new visitor.
        let mut stranger = reconnected(&viewer, &"0".repeat(32)).await;
        assert_ne!(stranger.key, "0".repeat(32));
        assert!(stranger.frame(Frame::rests).await.bytes == first.bytes);
    });
}

#[test]
fn whoever_comes_when_all_places_are_taken_hears_why_and_gets_the_next_one() {
    let viewer = Viewer::with(Options { visitors: 2, ..options(cornell) });
    run(async {
        let one = Client::connect(&viewer).await;
        let mut two = Client::connect(&viewer).await;
        let three = Client::connect(&viewer).await;
        let why = three.refused.expect("there is no third place");
        assert!(why.contains("is taken (2)") && why.contains("try again"), "{why}");
        drop(one);
        // A visitor who has left makes room, even if their view is still kept.
        let begun = Instant::now();
        let mut next = Client::connect(&viewer).await;
        while next.refused.is_some() {
            assert!(begun.elapsed() < Duration::from_secs(20), "the place stays taken");
            tokio::time::sleep(Duration::from_millis(20)).await;
            next = Client::connect(&viewer).await;
        }
        next.frame(Frame::rests).await;
        two.frame(|_| true).await;
    });
}

#[test]
fn views_without_memory_for_them_are_not_opened() {
    let one = 700 * 500 * 400;
    let mut settings = options(cornell).settings;
    settings.set("size", "700x500");
    settings.set("spp", Value::Integer(1));
    let viewer = Viewer::with(Options { max_memory: one + (24 << 20), settings, ..options(cornell) });
    run(async {
        let mut first = Client::connect(&viewer).await;
        let frame = first.frame(Frame::rests).await;
        assert_eq!(frame.header["full"], json!([700, 500]));
        let second = Client::connect(&viewer).await;
        let why = second.refused.expect("there is no memory for it");
        assert!(why.contains("memory") && why.contains("--shared"), "{why}");
        // Two pictures that are compared take twice as much.
        let compare = |with: &str| json!({ "do": "compare", "with": with, "key": "seed", "value": 1 });
        first.send(compare("setting")).await;
        let frame = first.frame(|frame| frame.header["full"] != json!([700, 500])).await;
        let pixels = [0, 1].map(|side| frame.header["full"][side].as_f64().unwrap()).iter().product::<f64>();
        assert!(pixels > 160_000.0 && pixels < 210_000.0, "{pixels}");
        first.send(compare("nothing")).await;
        first.frame(|frame| frame.header["full"] == json!([700, 500])).await;
        // A window that is too large for what is left gets a smaller picture of its shape.
        first.send(json!({ "do": "size", "to": [2800, 2000] })).await;
        let frame = first.frame(|frame| frame.header["full"] != json!([700, 500])).await;
        let [width, height] = [0, 1].map(|side| frame.header["full"][side].as_f64().unwrap());
        assert!(width * height < 500_000.0 && (width / height - 1.4).abs() < 0.01, "{width} x {height}");
    });
}

/// The memory of this process, in bytes; 0 where the system does not say.
fn memory() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    pages.and_then(|text| text.split(' ').nth(1)?.parse::<u64>().ok()).unwrap_or_default() * 4096
}

/// Twenty visitors at once, each of whom moves their own camera and then waits for their picture.
#[test]
#[expect(clippy::print_stdout, reason = "the figures that the ADR states")]
fn twenty_visitors_all_get_their_picture_and_nobody_much_later_than_others() {
    const VISITORS: usize = 20;
    let mut settings = options(cornell).settings;
    settings.set("size", "96x72");
    settings.set("spp", Value::Integer(6));
    let viewer = Viewer::with(Options { settings, ..options(cornell) });
    run(async {
        let mut first = Client::connect(&viewer).await;
        first.frame(Frame::rests).await;
        let before = memory();
        let mut all = tokio::task::JoinSet::new();
        for i in 0..VISITORS {
            let mut client = Client::connect(&viewer).await;
            all.spawn(async move {
                client.frame(|_| true).await;
                let begun = Instant::now();
                client.send(json!({ "do": "orbit", "by": [3 * i + 1, 2] })).await;
                let moved = |frame: &Frame| frame.header["eye"][0][2] != json!(3.9);
                client.text("state", |state| state["moved"] == true).await;
                client.frame(moved).await;
                let seen = begun.elapsed();
                client.frame(|frame| frame.rests() && moved(frame)).await;
                (seen, begun.elapsed())
            });
        }
        let times: Vec<(Duration, Duration)> = all.join_all().await;
        let worst = |of: fn(&(Duration, Duration)) -> Duration| times.iter().map(of).max().unwrap();
        let (seen, done) = (worst(|it| it.0), worst(|it| it.1));
        let soonest = times.iter().map(|it| it.1).min().unwrap();
        let grown = memory().saturating_sub(before) / VISITORS as u64;
        println!(
            "{VISITORS} visitors: a move shows after {seen:?} at most, pictures rest after {soonest:?} to {done:?}, \
                  {grown} bytes each"
        );
        // Turns make them all end together; one after the other, the first would be done in a twentieth of the time.
        assert!(soonest * 5 > done, "{times:?}");
        assert!(grown < 16 << 20, "each takes {grown} bytes");
    });
}

/// Also where all see the same picture, each browser takes a place.
#[test]
fn those_who_share_a_view_are_counted_too() {
    let viewer = Viewer::with(Options { shared: true, visitors: 2, ..options(cornell) });
    run(async {
        let mut one = Client::connect(&viewer).await;
        let two = Client::connect(&viewer).await;
        assert!(one.refused.is_none() && two.refused.is_none());
        let three = Client::connect(&viewer).await;
        let why = three.refused.expect("there is no third place");
        assert!(why.contains("is taken (2)"), "{why}");
        one.frame(Frame::rests).await;
    });
}

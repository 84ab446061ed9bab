//! Measures the time from a camera move to its first frame, as a browser sees it, for a scene file or a built-in scene.
//!
//! ```text
//! cargo run --release -p bilux-viewer --example latency interior
//! ```
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

#[path = "../tests/suite/common/mod.rs"]
mod common;

use bilux::formats::ReadOptions;
use bilux::scene::{Parameters, SceneBuilder, Spec};
use bilux_viewer::Options;
use common::{Client, Viewer, options, run_for};
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant};

/// The moves whose median is taken.
const MOVES: usize = 30;

fn main() {
    let name = std::env::args().nth(1).unwrap_or_else(|| "interior".to_owned());
    let integrator = std::env::args().nth(2).unwrap_or_else(|| "auto".to_owned());
    let mut settings = Parameters::default();
    settings.set("integrator", integrator.as_str());
    let shown = name.clone();
    let options = Options { settings, ..options(move || open(&name)) };
    let viewer = Viewer::with(options);
    let mut times = run_for(Duration::from_secs(600), measure(&viewer));
    times.sort();
    let [least, median, most] = [0, MOVES / 2, MOVES - 1].map(|i| times[i].as_secs_f64() * 1e3);
    println!(
        "{shown}, {integrator}, 1280x720: a camera move shows after {median:.0} ms ({least:.0} to {most:.0})"
    );
}

fn open(name: &str) -> Result<SceneBuilder, String> {
    let scene = match Path::new(name).exists() {
        true => bilux::load(Path::new(name), &ReadOptions::default()),
        false => bilux::generate(&Spec::new("", name)),
    };
    scene.map_err(|error| error.to_string())
}

/// The time from each move to the first frame of another view. Between moves the picture itself begins.
async fn measure(viewer: &Viewer) -> Vec<Duration> {
    let mut client = Client::connect(viewer).await;
    client.send(json!({ "do": "size", "to": [1280, 720] })).await;
    let first = client.frame(|frame| frame.header["full"] == json!([1280, 720])).await;
    let (mut eye, mut times) = (first.header["eye"].clone(), Vec::new());
    // The first move finds out how fast this machine is.
    for i in 0..=MOVES {
        let pause = Instant::now();
        while pause.elapsed() < Duration::from_millis(150 + 37 * i as u64) {
            // Frames come meanwhile, and are seen.
            let _ = tokio::time::timeout(Duration::from_millis(20), client.next()).await;
        }
        let begun = Instant::now();
        client.send(json!({ "do": "look", "by": [if i % 2 == 0 { 3 } else { -3 }, 0] })).await;
        let moved = client.frame(|frame| frame.header["eye"] != eye).await;
        if i > 0 {
            times.push(begun.elapsed());
        }
        eye = moved.header["eye"].clone();
    }
    times
}

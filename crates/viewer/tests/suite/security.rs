//! Access to a viewer, and what no browser can do to it.

use crate::common::{Client, Frame, Said, Viewer, cornell, get, options, run};
use bilux_viewer::{Options, Server, ViewerError};
use serde_json::json;
use std::time::{Duration, Instant};
use tokio_tungstenite::tungstenite::Error;

fn is_refused(result: &Result<Client, Error>) -> bool {
    matches!(result, Err(Error::Http(response)) if response.status() == 403)
}

#[test]
fn other_hosts_and_origins_are_refused() {
    let viewer = Viewer::start();
    let own = format!("http://{}", viewer.host());
    run(async {
        for host in ["evil.example", "evil.example:80", "127.0.0.1", "localhost:1", ""] {
            let (head, _) = get(viewer.host(), "/", host, "").await;
            assert!(head.starts_with("HTTP/1.1 403") || head.starts_with("HTTP/1.1 400"), "{host}: {head}");
            assert!(is_refused(&Client::connect_as(&viewer, &[("host", host)]).await), "{host}");
        }
        for origin in ["http://evil.example", "null", "https://127.0.0.1", "http://127.0.0.1:1", "file://"] {
            assert!(is_refused(&Client::connect_as(&viewer, &[("origin", origin)]).await), "{origin}");
        }
        assert!(Client::connect_as(&viewer, &[("origin", &own)]).await.is_ok());
        for site in ["cross-site", "same-site"] {
            let other = format!("Sec-Fetch-Site: {site}\r\nSec-Fetch-Mode: no-cors\r\n");
            let (head, _) = get(viewer.host(), "/picture.png", viewer.host(), &other).await;
            assert!(head.starts_with("HTTP/1.1 403"), "{head}");
        }
    });
}

#[test]
fn the_page_is_served_with_strict_headers_and_no_other_file_is() {
    let viewer = Viewer::start();
    run(async {
        let (head, page) = get(viewer.host(), "/", viewer.host(), "").await;
        assert!(
            head.starts_with("HTTP/1.1 200") && String::from_utf8(page).unwrap().contains("<main"),
            "{head}"
        );
        for header in [
            "content-security-policy: default-src 'none'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "frame-ancestors 'none'",
        ] {
            assert!(head.contains(header), "{header}: {head}");
        }
        for path in [
            "/../Cargo.toml",
            "/%2e%2e/Cargo.toml",
            "/etc/passwd",
            "//etc/passwd",
            "/page/index.html",
            "/main.js/../../src/lib.rs",
        ] {
            let (head, _) = get(viewer.host(), path, viewer.host(), "").await;
            assert!(head.starts_with("HTTP/1.1 404"), "{path}: {head}");
        }
    });
}

#[test]
fn beyond_this_machine_nothing_is_served_without_the_token() {
    let viewer = Viewer::with(Options { address: "0.0.0.0:0".parse().unwrap(), ..options(cornell) });
    let token = viewer.address.split('/').nth(3).unwrap().to_owned();
    assert_eq!(token.len(), 32, "{}", viewer.address);
    let place = viewer.host().replace("0.0.0.0", "127.0.0.1");
    run(async {
        let wrong = "0".repeat(32);
        for path in [
            "/",
            "/style.css",
            "/socket",
            "/picture.png",
            &format!("/{wrong}/"),
            &format!("/{wrong}/socket"),
            &format!("/{}/", &token[1..]),
        ] {
            let (head, _) = get(&place, path, "any.example", "").await;
            assert!(head.starts_with("HTTP/1.1 403"), "{path}: {head}");
        }
        for path in ["", "style.css", "main.js"] {
            let (head, _) = get(&place, &format!("/{token}/{path}"), "any.example", "").await;
            assert!(head.starts_with("HTTP/1.1 200"), "{path}: {head}");
        }
        let socket = format!("ws://{place}/{token}/socket");
        assert!(is_refused(&Client::connect_to(&socket, &[("origin", "http://evil.example")]).await));
        assert!(is_refused(&Client::connect_to(&format!("ws://{place}/{wrong}/socket"), &[]).await));
        Client::connect_to(&socket, &[]).await.unwrap().frame(|_| true).await;
    });
}

#[test]
fn a_port_in_use_is_an_error() {
    let viewer = Viewer::start();
    let address = viewer.host().parse().unwrap();
    let error = Server::start(Options { address, ..options(cornell) }).err().unwrap();
    assert!(
        matches!(error, ViewerError::PortInUse { .. }) && error.to_string().contains("in use"),
        "{error}"
    );
    let broken = options(|| Err("there is no scene".to_owned()));
    assert_eq!(Server::start(broken).err().unwrap().to_string(), "there is no scene");
}

/// Random numbers that are the same each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = bilux::math::hash::hash_words([self.0, 1]);
        self.0 % below
    }
}

/// A message that may be anything: a right one with some bytes changed, cut or doubled, or none at all.
fn malformed(numbers: &mut Numbers) -> String {
    const RIGHT: &[&str] = &[
        r#"{"do":"orbit","by":[10,-2.5]}"#,
        r#"{"do":"pick","at":[0.5,0.5],"paths":64}"#,
        r#"{"do":"set","key":"integrator","value":"path"}"#,
        r#"{"do":"size","to":[640,480]}"#,
        r#"{"do":"seen","frame":18446744073709551615}"#,
        r#"{"do":"edit","part":"material","number":0,"key":"reflectance","value":[1,1,1]}"#,
        r#"{"do":"compare","with":"setting","key":"integrator","value":"cast"}"#,
        r#"{"do":"approach","by":1.5}"#,
        r#"{"do":"show","what":"ids"}"#,
        r#"{"do":"fly","by":[1e308,-1e308,0]}"#,
        "[[[[[[[[[[[[",
    ];
    let mut bytes = RIGHT[numbers.next(RIGHT.len() as u64) as usize].as_bytes().to_vec();
    for _ in 0..=numbers.next(4) {
        let at = numbers.next(bytes.len() as u64) as usize;
        match numbers.next(4) {
            0 => bytes[at] = b' ' + numbers.next(95) as u8,
            1 => bytes.truncate(at.max(1)),
            2 => bytes.insert(at, b'0' + numbers.next(10) as u8),
            _ => bytes.extend_from_within(at..),
        }
    }
    bytes.truncate(4000);
    String::from_utf8(bytes).unwrap()
}

#[test]
fn malformed_messages_are_answered_and_harm_nobody() {
    let viewer = Viewer::start();
    run(async {
        let mut other = Client::connect(&viewer).await;
        other.frame(|_| true).await;
        let mut client = Client::connect(&viewer).await;
        client.send_text("nonsense").await.unwrap();
        let error = client.text("error", |_| true).await;
        assert!(error["message"].as_str().unwrap().contains("not JSON"), "{error}");
        client.send_bytes(vec![0, 1, 2]).await.unwrap();
        client.text("error", |_| true).await;
        let mut numbers = Numbers(7);
        for _ in 0..100_000 {
            client.send_text(&malformed(&mut numbers)).await.unwrap();
        }
        // It still answers both.
        for client in [&mut client, &mut other] {
            client.send(json!({ "do": "size", "to": [32, 24] })).await;
            client.send(json!({ "do": "show", "what": "picture" })).await;
            client.frame(|frame| frame.header["full"] == json!([32, 24])).await;
        }
    });
}

#[test]
fn a_message_that_is_too_long_closes_its_own_connection_only() {
    let viewer = Viewer::start();
    run(async {
        let mut other = Client::connect(&viewer).await;
        let mut client = Client::connect(&viewer).await;
        let long = format!(r#"{{"do":"set","key":"tonemap","value":"{}"}}"#, "x".repeat(100_000));
        let _ = client.send_text(&long).await;
        while let Some(said) = client.next().await {
            assert!(!matches!(said, Said::Text(json) if json["problem"].is_string()));
        }
        other.frame(Frame::rests).await;
    });
}

#[test]
fn stalled_browsers_slow_nobody() {
    let viewer = Viewer::with(Options { shared: true, ..options(cornell) });
    run(async {
        let mut stalled = Client::connect(&viewer).await;
        stalled.sees = false;
        let mut client = Client::connect(&viewer).await;
        // One says that it has seen nothing, and one reads nothing at all.
        let _deaf = Client::connect(&viewer).await;
        let mut got = 0;
        let begun = Instant::now();
        for i in 0..40 {
            client.send(json!({ "do": "orbit", "by": [if i % 2 == 0 { 9 } else { -9 }, 0] })).await;
            let before = client.frame(|_| true).await.number("picture");
            client.frame(|frame| frame.number("picture") > before || frame.rests()).await;
            got += 1;
        }
        assert_eq!(got, 40);
        assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
        // It got two frames, and gets the newest one as soon as it has seen them.
        let mut frames = Vec::new();
        while let Ok(Some(said)) = tokio::time::timeout(Duration::from_millis(300), stalled.next()).await {
            if let Said::Frame(frame) = said {
                frames.push(frame.number("frame"));
            }
        }
        assert_eq!(frames.len(), 2, "{frames:?}");
        stalled.sees = true;
        stalled.send(json!({ "do": "seen", "frame": frames[1] })).await;
        let newest = stalled.frame(|_| true).await.number("frame");
        assert!(newest > frames[1] + 10, "{newest} after {frames:?}");
    });
}

/// The memory of this process, in bytes; 0 where the system does not say.
fn memory() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").ok();
    pages.and_then(|text| text.split(' ').nth(1)?.parse::<u64>().ok()).unwrap_or_default() * 4096
}

/// Moves the camera so often, as one client, while others watch; the time that takes.
async fn orbits(client: &mut Client, count: i32) -> Duration {
    let begun = Instant::now();
    for i in 0..count {
        client.send(json!({ "do": "orbit", "by": [if i % 2 == 0 { 9 } else { -9 }, 0] })).await;
        let before = client.frame(|_| true).await.number("picture");
        client.frame(|frame| frame.number("picture") > before || frame.rests()).await;
    }
    begun.elapsed()
}

#[test]
#[expect(clippy::print_stdout, reason = "the figures that the ADR states")]
fn twenty_browsers_of_which_one_stalls_take_no_more_memory_with_time() {
    const MOVES: i32 = 40;
    let viewer = Viewer::with(Options { shared: true, ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        orbits(&mut client, MOVES).await;
        let alone = orbits(&mut client, MOVES).await;
        let _stalled = Client::connect(&viewer).await;
        let mut watchers = tokio::task::JoinSet::new();
        for _ in 0..18 {
            let mut watcher = Client::connect(&viewer).await;
            watchers.spawn(async move {
                let mut frames = 0;
                loop {
                    match tokio::time::timeout(Duration::from_secs(3), watcher.frame(|_| true)).await {
                        Ok(_) => frames += 1,
                        Err(_) => return frames,
                    }
                }
            });
        }
        orbits(&mut client, MOVES).await;
        let early = memory();
        let crowded = orbits(&mut client, MOVES).await;
        for _ in 0..2 {
            orbits(&mut client, MOVES).await;
        }
        let grown = memory().saturating_sub(early);
        let frames: Vec<u32> = watchers.join_all().await;
        let (least, most) = (frames.iter().min().unwrap(), frames.iter().max().unwrap());
        println!("alone {alone:?}, with 20 {crowded:?}, {least} to {most} frames, {grown} bytes more");
        assert!(grown < 16 << 20, "memory grows by {grown} bytes");
        assert!(*least > 50 && *least * 2 > *most, "all get about as many frames: {frames:?}");
        // Here all twenty share the cores with the render.
        assert!(crowded < alone * 5 + Duration::from_secs(2), "{crowded:?} after {alone:?}");
    });
}

#[test]
fn browsers_that_are_lost_are_forgotten_and_the_others_go_on() {
    let viewer = Viewer::start();
    run(async {
        let mut other = Client::connect(&viewer).await;
        // More than there are places, each in the middle of something, and none says goodbye.
        for i in 0..150 {
            let mut lost = match Client::connect_as(&viewer, &[]).await {
                Ok(client) if client.refused.is_none() => client,
                _ => {
                    tokio::time::sleep(Duration::from_millis(50)).await;
                    continue;
                }
            };
            lost.send(json!({ "do": "orbit", "by": [1, 0] })).await;
            if i % 2 == 0 {
                lost.send(json!({ "do": "pick", "at": [0.5, 0.5], "paths": 64 })).await;
            }
            drop(lost);
        }
        let picture = other.frame(Frame::rests).await.number("picture");
        other.send(json!({ "do": "orbit", "by": [5, 0] })).await;
        other.frame(|frame| frame.rests() && frame.number("picture") > picture).await;
        Client::connect(&viewer).await.frame(|_| true).await;
    });
}

#[test]
fn absurd_windows_are_limited_or_refused_and_the_old_picture_stays() {
    let viewer = Viewer::start();
    run(async {
        let mut client = Client::connect(&viewer).await;
        let before = client.frame(Frame::rests).await;
        for size in
            [json!([0, 0]), json!([-640, 480]), json!("wide"), json!([1]), json!(null), json!([1e300, 1e300])]
        {
            client.send(json!({ "do": "size", "to": size })).await;
            client.text("error", |_| true).await;
        }
        client.send(json!({ "do": "show", "what": "picture" })).await;
        let after = client.frame(Frame::rests).await;
        assert_eq!(after.header["full"], before.header["full"]);
        client.send(json!({ "do": "size", "to": [1e9, 1e9] })).await;
        let largest = client.frame(|frame| frame.header["full"] != before.header["full"]).await;
        let [width, height] = [0, 1].map(|side| largest.header["full"][side].as_u64().unwrap());
        assert!(width <= 4096 && height <= 4096, "{width} x {height}");
        client.send(json!({ "do": "size", "to": [48, 40] })).await;
        client.frame(|frame| frame.header["full"] == json!([48, 40])).await;
    });
}

#[test]
fn browsers_that_are_too_many_are_refused_until_one_leaves() {
    let viewer = Viewer::start();
    run(async {
        let mut clients = Vec::new();
        for _ in 0..64 {
            clients.push(Client::connect(&viewer).await);
        }
        let refused = Client::connect(&viewer).await.refused;
        assert!(refused.is_some_and(|why| why.contains("is taken (64)") && why.contains("try again")));
        clients.truncate(10);
        let mut tries = 0;
        while Client::connect(&viewer).await.refused.is_some() {
            tokio::time::sleep(Duration::from_millis(20)).await;
            tries += 1;
            assert!(tries < 500, "their places stay taken");
        }
    });
}

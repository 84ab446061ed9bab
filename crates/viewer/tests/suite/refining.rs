//! Refinement of a picture: clean at once, never uglier than before, and in the end that of the command line.

use crate::common::{Client, Frame, Viewer, cornell, get, options, run};
use bilux::pictures::{Limits, Picture, read_bytes, write_bytes};
use bilux::scene::{Parameters, Value};
use bilux::{Denoised, Job, JobRequest, Quiet};
use bilux_viewer::Options;
use serde_json::json;

/// The settings of a viewer that says nothing of denoising.
fn settings(size: &str, samples: i64) -> Parameters {
    let mut settings = Parameters::default();
    settings.set("size", size);
    settings.set("spp", Value::Integer(samples));
    settings.set("integrator", "path");
    settings
}

fn viewer(settings: Parameters) -> Viewer {
    Viewer::with(Options { settings, ..options(cornell) })
}

/// The picture that the command line makes with these settings.
fn rendered(settings: &Parameters) -> Vec<u8> {
    let mut settings = settings.clone();
    settings.set("build", "balanced");
    let request = JobRequest::from(&settings).denoised(Denoised::ForDisplay);
    let job = Job::new(&cornell().unwrap(), request).unwrap();
    let outcome = job.render(&Quiet).unwrap();
    let picture = match job.denoiser().unwrap() {
        Some(denoiser) => outcome.denoised(denoiser).unwrap(),
        None => outcome.picture().unwrap(),
    };
    write_bytes("png", &picture, &job.write_options_for(&picture).unwrap()).unwrap()
}

/// The root of the mean squared difference of two pictures of any sizes, between 0 and 1, over a grid of places.
fn apart(a: &[u8], b: &[u8]) -> f64 {
    const GRID: usize = 96;
    let [a, b] = [a, b].map(|bytes| read_bytes(bytes, None, &Limits::default()).unwrap());
    let at = |picture: &Picture, i: usize, channel: usize| {
        let x = ((i % GRID) * picture.width() + picture.width() / 2) / GRID;
        let y = ((i / GRID) * picture.height() + picture.height() / 2) / GRID;
        f64::from(picture.rgb_planes().unwrap()[channel][y * picture.width() + x])
    };
    let differences = (0..GRID * GRID * 3).map(|i| at(&a, i / 3, i % 3) - at(&b, i / 3, i % 3));
    let squares = differences.map(|difference| difference * difference);
    (squares.sum::<f64>() / (GRID * GRID * 3) as f64).sqrt()
}

#[test]
fn pictures_are_denoised_unless_that_is_turned_off_and_rest_as_the_command_line_makes_them() {
    let all = settings("48x40", 16);
    let viewer = viewer(all.clone());
    run(async {
        let mut client = Client::connect(&viewer).await;
        let state = client.text("state", |state| state["command"].is_string()).await;
        let clean = client.frame(Frame::rests).await;
        let command = state["command"].as_str().unwrap();
        assert!(command.contains("--size 48x40 --spp 16") && command.contains("--denoise=auto"), "{command}");
        let mut denoised = all.clone();
        denoised.set("denoise", "auto");
        assert!(clean.bytes == rendered(&denoised), "the command line makes another picture");
        client.send(json!({ "do": "set", "key": "denoise", "value": "off" })).await;
        let plain = client.frame(|frame| frame.rests() && frame.bytes != clean.bytes).await;
        let mut raw = all;
        raw.set("denoise", "off");
        assert!(plain.bytes == rendered(&raw));
    });
}

/// Also while it is small: copied in the first moment, the command renders the picture as it will be.
#[test]
fn the_command_is_that_of_the_whole_picture_from_the_first_moment_on() {
    let viewer = viewer(settings("480x400", 64));
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.send(json!({ "do": "size", "to": [400, 300] })).await;
        client.send(json!({ "do": "orbit", "by": [10, 0] })).await;
        let state =
            client.text("state", |state| state["moved"] == true && state["full"] == json!([400, 300])).await;
        let command = state["command"].as_str().unwrap();
        assert!(command.contains("--size 400x300 --spp 64"), "{command}");
        let (_, overlay) = get(viewer.host(), "/overlay.toml", viewer.host(), "").await;
        let overlay = String::from_utf8(overlay).unwrap();
        assert!(overlay.contains("400x300") && overlay.contains("spp = 64"), "{overlay}");
    });
}

#[test]
fn after_an_orbit_a_clean_picture_comes_soon_and_no_later_one_is_uglier() {
    let viewer = viewer(settings("320x270", 8));
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.frame(|_| true).await;
        client.send(json!({ "do": "orbit", "by": [10, 4] })).await;
        let state = client.text("state", |state| state["moved"] == true).await;
        let mut frames = vec![client.frame(|frame| frame.header["eye"][0][0] != 0.0).await];
        while !frames.last().unwrap().rests() {
            frames.push(client.frame(|_| true).await);
        }
        let mut converged = settings("320x270", 32);
        for key in ["eye", "look_at"] {
            converged.set(key, state["settings"][key].as_str().unwrap());
        }
        converged.set("denoise", "auto");
        let truth = rendered(&converged);
        let about = |frame: &Frame| {
            (frame.header["size"].clone(), frame.number("samples"), apart(&frame.bytes, &truth))
        };
        let all: Vec<_> = frames.iter().map(about).collect();
        // In the order in which they are shown, none is farther from the truth than any before it.
        for (i, one) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|earlier| one.2 < earlier.2 * 1.1 + 0.002), "{all:?}");
        }
        // Before the picture in full size there is one of half of it, or less on a slow machine, with several samples.
        let clean =
            frames.iter().position(|frame| frame.header["preview"] == true && frame.number("samples") > 1);
        let full = frames.iter().position(|frame| frame.header["preview"] == false);
        assert!(clean.is_some_and(|clean| Some(clean) < full), "{all:?}");
    });
}

#[test]
fn it_is_said_how_far_the_picture_is() {
    let viewer = viewer(settings("320x240", 24));
    run(async {
        let mut client = Client::connect(&viewer).await;
        let full = client.text("progress", |it| it["level"] == "full" && it["samples"] != 0).await;
        assert_eq!(full["total"], 24);
        let last = client.text("progress", |it| it["rests"] == true).await;
        assert_eq!(
            (&last["samples"], &last["denoises"], &last["waits"]),
            (&json!(24), &json!(false), &json!(false))
        );
        // A comparison says what it waits for before there is anything to see.
        client
            .send(json!({ "do": "compare", "with": "setting", "key": "integrator", "value": "bdpt" }))
            .await;
        let other = client.text("progress", |it| it["other"].is_object()).await;
        assert_eq!(other["other"]["goes_on"], true);
        client.text("progress", |it| it["other"]["samples"].as_u64() > Some(0)).await;
    });
}

/// A layer shows the scene as it is now, and what guides the denoiser does too.
#[test]
fn layers_follow_an_edit() {
    let viewer = Viewer::with(Options { may_edit: true, settings: settings("48x40", 4), ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.send(json!({ "do": "show", "what": "albedo" })).await;
        let albedo = |frame: &Frame| frame.rests() && frame.header["shown"] == "albedo";
        let before = client.frame(albedo).await;
        for number in 0..3 {
            client
                .send(json!({ "do": "edit", "part": "material", "number": number, "key": "reflectance", "value": [0, 0, 1] }))
                .await;
            client
                .text("state", |state| {
                    state["parts"]["material"][number]["parameters"]["reflectance"] == json!([0, 0, 1])
                })
                .await;
        }
        let after = client.frame(|frame| albedo(frame) && frame.bytes != before.bytes).await;
        client.send(json!({ "do": "show", "what": "normal" })).await;
        client.send(json!({ "do": "show", "what": "albedo" })).await;
        client.frame(albedo).await;
        // The floor, in the middle below, is blue now: 255 of 255, whatever the light.
        let picture = read_bytes(&after.bytes, None, &Limits::default()).unwrap();
        let at = 36 * picture.width() + picture.width() / 2;
        let floor = picture.rgb_planes().unwrap().map(|plane| plane[at]);
        assert!(floor[0] < 0.01 && floor[1] < 0.01 && floor[2] > 0.99, "{floor:?}");
    });
}

/// The clean picture of half the size stays until the large one has half as many samples for each of its pixels, which are four
/// times as many.
#[test]
fn the_first_large_picture_is_no_draft() {
    let viewer = viewer(settings("160x134", 200));
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.frame(|_| true).await;
        client.send(json!({ "do": "orbit", "by": [10, 4] })).await;
        client.text("state", |state| state["moved"] == true).await;
        let mut before = client.frame(|frame| frame.header["eye"][0][0] != 0.0).await;
        loop {
            let frame = client.frame(|_| true).await;
            if frame.header["preview"] == false {
                let [small, large] = [&before, &frame].map(|frame| frame.number("samples"));
                let is_clean = before.header["preview"] == true;
                assert!(!is_clean || large >= small.div_ceil(2), "{small}, then {large}");
                return;
            }
            before = frame;
        }
    });
}

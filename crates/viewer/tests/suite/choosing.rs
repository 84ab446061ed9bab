//! Choices of a model: its animation, its variant, the light around it, and the time.

use crate::common::{Client, Frame, Viewer, cornell, options, run};
use bilux::scene::{Animation, SceneBuilder};
use bilux_viewer::{Opening, Options};
use serde_json::json;

/// A scene with two animations, two variants and two environments: each changes what is there.
fn opened(opening: &Opening) -> Result<SceneBuilder, String> {
    let mut scene = cornell()?;
    let plays = |name: &str| opening.animation.as_deref().unwrap_or("walk") == name;
    let clip = |name: &str, seconds| Animation { name: name.to_owned(), seconds, plays: plays(name) };
    scene.inventory.animations = vec![clip("walk", 1.0), clip("run", 2.0)];
    scene.inventory.variants = vec!["red".to_owned(), "green".to_owned()];
    let removed = usize::from(plays("run")) + 2 * usize::from(opening.variant.as_deref() == Some("green"));
    let removed = removed + 4 * usize::from(opening.environment.as_deref() == Some("none"));
    scene.objects.truncate(scene.objects.len() - usize::from(removed > 0));
    scene.lights[0].parameters.set("radiance", 1.0 + removed as f32);
    Ok(scene)
}

#[test]
fn animations_variants_and_environments_are_chosen_and_are_in_the_command() {
    let environments = vec!["none".to_owned(), "rooms/hall.hdr".to_owned()];
    let viewer = Viewer::with(Options { open: Box::new(opened), environments, ..options(cornell) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        let state = client.text("state", |state| state["animations"].is_array()).await;
        let first = client.frame(Frame::rests).await;
        client.send(json!({ "do": "orbit", "by": [5, 5] })).await;
        let moved = client.frame(|frame| frame.rests() && frame.header["eye"] != first.header["eye"]).await;
        let mut pictures = vec![moved.bytes.clone()];
        assert_eq!(
            state["animations"][1],
            json!({ "word": "run", "name": "run", "seconds": 2.0, "plays": false })
        );
        assert_eq!(state["environments"], json!(["none", "rooms/hall.hdr"]));
        assert_eq!(state["seconds"], 1.0);
        for (what, name, words) in [
            ("animation", "run", "--animation run"),
            ("variant", "green", "--variant green --animation run"),
            ("environment", "none", "--variant green --animation run --env none"),
        ] {
            client.send(json!({ "do": what, "name": name })).await;
            let state = client.text("state", |state| state[what] == name).await;
            let command = state["command"].as_str().unwrap();
            assert!(command.contains(words), "{command}");
            let picture = client.frame(|frame| frame.rests() && !pictures.contains(&frame.bytes)).await;
            // The scene is opened again, and the camera stays where the visitor has moved it.
            assert_eq!(picture.header["eye"], moved.header["eye"]);
            pictures.push(picture.bytes);
        }
        for (what, name) in [("animation", "jump"), ("variant", "blue"), ("environment", "/etc/passwd")] {
            client.send(json!({ "do": what, "name": name })).await;
            client.text("state", |state| state["problem"].as_str().is_some_and(|p| p.contains(name))).await;
        }
        // An empty name is what was opened.
        for what in ["animation", "variant", "environment"] {
            client.send(json!({ "do": what, "name": "" })).await;
            client.text("state", |state| state[what].is_null()).await;
        }
        client.frame(|frame| frame.rests() && frame.bytes == pictures[0]).await;
        client.send(json!({ "do": "set", "key": "time", "value": 0.5 })).await;
        let state = client.text("state", |state| state["settings"]["time"] == 0.5).await;
        assert!(state["command"].as_str().unwrap().contains("--at 0.5"), "{}", state["command"]);
        client.send(json!({ "do": "set", "key": "time", "value": "noon" })).await;
        let state = client.text("state", |state| state["problem"].is_string()).await;
        assert_eq!(state["settings"]["time"], 0.5);
    });
}

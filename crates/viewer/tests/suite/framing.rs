//! Framing that is kept: a drag begins where the picture was, in windows of any shape.

use crate::common::{Client, Frame, Viewer, options, run};
use bilux::math::{DVec3, Vec3};
use bilux::pictures::{Limits, read_bytes};
use bilux::scene::{Mesh, Object, SceneBuilder, Spec, Value};
use bilux_viewer::Options;
use serde_json::json;
use std::sync::Arc;

/// A model without a camera and without light: a box of 1 x 2 x 1 m beside the origin.
fn model() -> Result<SceneBuilder, String> {
    let mut scene = SceneBuilder::default();
    let corner = |i: u32| Vec3::new((i & 1) as f32 + 3.0, (i >> 1 & 1) as f32 * 2.0, (i >> 2 & 1) as f32);
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let mesh = Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() };
    let material = scene.add_material(Spec::new("paint", "diffuse"));
    scene.objects.push(Object::new("box", Arc::new(mesh), material));
    Ok(scene)
}

/// The box of pixels that have the colour of the middle one: left, top, right and bottom as fractions of the picture.
fn extent(frame: &Frame) -> [f64; 4] {
    let picture = read_bytes(&frame.bytes, None, &Limits::default()).unwrap();
    let (width, height) = (picture.width(), picture.height());
    let planes = picture.rgb_planes().unwrap();
    let at = |x: usize, y: usize| planes.map(|plane| plane[y * width + x].to_bits());
    let own = at(width / 2, height / 2);
    let inside: Vec<[usize; 2]> =
        (0..width * height).map(|i| [i % width, i / width]).filter(|&[x, y]| at(x, y) == own).collect();
    let of = |axis: usize, least: bool| {
        let all = inside.iter().map(|place| place[axis]);
        if least { all.min().unwrap() as f64 } else { all.max().unwrap() as f64 + 1.0 }
    };
    [
        of(0, true) / width as f64,
        of(1, true) / height as f64,
        of(0, false) / width as f64,
        of(1, false) / height as f64,
    ]
}

fn is_close(a: [f64; 4], b: [f64; 4], most: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most)
}

#[test]
fn a_drag_changes_neither_the_distance_nor_the_framing_whatever_the_shape_of_the_window() {
    let mut settings = options(model).settings;
    settings.set("spp", Value::Integer(1));
    // What is looked at are the ids: nothing is gained by a choice of techniques, or from denoising.
    settings.set("integrator", "path");
    settings.set("denoise", "off");
    let viewer = Viewer::with(Options { settings, ..options(model) });
    run(async {
        let mut client = Client::connect(&viewer).await;
        client.send(json!({ "do": "show", "what": "ids" })).await;
        for size in [[195, 422], [300, 300], [600, 150], [195, 422]] {
            client.send(json!({ "do": "home" })).await;
            client.send(json!({ "do": "size", "to": size })).await;
            let ids = |frame: &Frame| {
                frame.rests() && frame.header["full"] == json!(size) && frame.header["shown"] == "ids"
            };
            let home = client.frame(ids).await;
            let at_home = extent(&home);
            // The studio's camera shows the model whole, and as large as it may be.
            assert!(at_home.iter().all(|side| (0.02..0.98).contains(side)), "{size:?}: {at_home:?}");
            for by in [[0.0, 0.0], [0.02, 0.01]] {
                client.send(json!({ "do": "orbit", "by": by })).await;
                client.text("state", |state| state["moved"] == true).await;
                let moved = client.frame(ids).await;
                // The pictures are a few hundred pixels wide, and edges may fall into the next one.
                assert!(
                    is_close(extent(&moved), at_home, 0.012),
                    "{size:?}: {at_home:?}, then {:?}",
                    extent(&moved)
                );
            }
            // Half way round, it is as large as before, and in the middle: the camera moves around the model itself.
            client.send(json!({ "do": "orbit", "by": [180, 0] })).await;
            let behind =
                extent(&client.frame(|frame| ids(frame) && frame.header["eye"] != home.header["eye"]).await);
            let height = |it: [f64; 4]| it[3] - it[1];
            assert!(
                (height(behind) / height(at_home) - 1.0).abs() < 0.12,
                "{size:?}: {at_home:?}, then {behind:?}"
            );
            let middle = (behind[0] + behind[2]) / 2.0;
            assert!((middle - 0.5).abs() < 0.06, "{size:?}: {behind:?}");
        }
        // A window that becomes narrow keeps a moved camera's model in view, as it does the scene's own camera's, and its
        // direction.
        client.send(json!({ "do": "home" })).await;
        client.send(json!({ "do": "size", "to": [600, 150] })).await;
        client.send(json!({ "do": "orbit", "by": [10, 0] })).await;
        client.text("state", |state| state["moved"] == true && state["full"] == json!([600, 150])).await;
        let wide = client.frame(|frame| frame.rests() && frame.header["full"] == json!([600, 150])).await;
        client.send(json!({ "do": "size", "to": [150, 600] })).await;
        let narrow = client.frame(|frame| frame.rests() && frame.header["full"] == json!([150, 600])).await;
        assert!(extent(&narrow).iter().all(|side| (0.01..0.99).contains(side)), "{:?}", extent(&narrow));
        let [a, b] = [&wide, &narrow].map(direction);
        assert!(a.dot(b) > 0.999_999, "{a} {b}");
        client.send(json!({ "do": "size", "to": [600, 150] })).await;
        let again = client.frame(|frame| frame.rests() && frame.header["full"] == json!([600, 150])).await;
        assert!(is_close(extent(&again), extent(&wide), 0.012), "{:?} {:?}", extent(&again), extent(&wide));
    });
}

/// From the point that the camera moves around to the camera.
fn direction(frame: &Frame) -> DVec3 {
    let [position, pivot] = [0, 1]
        .map(|i| DVec3::from_array([0, 1, 2].map(|axis| frame.header["eye"][i][axis].as_f64().unwrap())));
    (position - pivot).normalize()
}

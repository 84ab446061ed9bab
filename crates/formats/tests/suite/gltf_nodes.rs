//! Nodes of glTF that hide something or make it flat, skins without weights, and the forms of URIs.

use crate::gltf_motion::Parts;
use crate::{read_text, warnings};
use bilux_formats::{ReadOptions, read, read_bytes};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{AccelChoice, Ray, SceneBuilder, Tracer};

const TRIANGLE: [f32; 9] = [0., 0., 0., 1., 0., 0., 0., 1., 0.];

/// A document of triangles in the plane z = 0, with these nodes, of which the first is in the scene.
fn of_nodes(nodes: &str, more: &str) -> String {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    parts.floats("VEC3", 3, &[0., 0., 1.].repeat(3));
    parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],"meshes":[{{"primitives":[{{"attributes":
        {{"POSITION":0,"NORMAL":1}}}}]}}]{more}"#
    ))
}

fn scene(text: &str) -> SceneBuilder {
    read_text("gltf", text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The projection of the triangle along the axis of no scale is seen, and its normal is that axis. [glTF 2.0, 3.5.3]
#[test]
fn a_scale_of_zero_along_one_axis_makes_a_mesh_flat() {
    // Turned a quarter about x, so that (x, y, 0) becomes (x, 0, y), and flattened along the node's y or z.
    let turn = std::f64::consts::FRAC_1_SQRT_2;
    for (node, from, toward, normal) in [
        (r#""scale":[2,3,0],"translation":[0,0,5]"#.to_owned(), [0.4, 0.6, 9.0], [0.0, 0.0, -1.0], Vec3::Z),
        (
            format!(r#""children":[1],"rotation":[{turn},0,0,{turn}],"scale":[1,1,0]"#),
            [0.2, 9.0, 0.2],
            [0.0, -1.0, 0.0],
            Vec3::Y,
        ),
        (
            r#""matrix":[2,0,0,0, 0,3,0,0, 0,0,0,0, 0,0,5,1]"#.to_owned(),
            [0.4, 0.6, 9.0],
            [0.0, 0.0, -1.0],
            Vec3::Z,
        ),
    ] {
        let text = of_nodes(&format!(r#"{{"mesh":0,{node}}},{{"translation":[9,9,9]}}"#), "");
        let read = scene(&text);
        assert_eq!(warnings(&read), "", "{node}");
        let built = read.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let seen = Tracer::new(&built, false).closest(&Ray::new(from, toward)).expect(&node);
        for found in [seen.n_geom, seen.n_shade] {
            assert!((found.dot(normal).abs() - 1.0).abs() < 1e-6, "{node}: {found}");
        }
    }
    // A sphere's shading normals would lie across the plane.
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &[0., 0., 1., 1., 0., 0.5, 0., 1., 0.5]);
    parts.floats("VEC3", 3, &[0., 0., 1., 0.8, 0., 0.6, 0., 0.8, 0.6]);
    let read = scene(&parts.document(
        r#""scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,1,0]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}]"#,
    ));
    let built = read.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let seen = Tracer::new(&built, false).closest(&Ray::new([0.3, 0.3, 5.0], [0.0, 0.0, -1.0])).unwrap();
    assert!((seen.p.z.abs() < 1e-6) && seen.n_shade.distance(Vec3::Z) < 1e-6, "{seen:?}");
}

#[test]
fn a_scale_of_zero_along_more_axes_hides_a_mesh() {
    let hidden = scene(&of_nodes(r#"{"mesh":0,"scale":[0,0,0]}"#, ""));
    assert!(
        hidden.objects.is_empty() && hidden.notes.iter().any(|note| note.message.contains("scale of zero"))
    );
    let line = scene(&of_nodes(r#"{"mesh":0,"scale":[1,0,0]}"#, ""));
    assert!(line.objects.is_empty() && warnings(&line).contains("scaled to a line"), "{}", warnings(&line));
}

/// A node is visible if it says so and all its parents are; cameras always are. [KHR_node_visibility]
#[test]
fn hidden_nodes_hide_their_children_and_lights_but_not_cameras() {
    let hidden = r#""extensions":{"KHR_node_visibility":{"visible":false}}"#;
    let shown = r#""extensions":{"KHR_node_visibility":{"visible":true}}"#;
    let lamp = r#""extensions":{"KHR_lights_punctual":{"light":0}}"#;
    let more = r#","cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},
        "extensionsUsed":["KHR_node_visibility","KHR_lights_punctual"],"extensionsRequired":["KHR_node_visibility"]"#;
    let nodes = |first: &str| {
        format!(
            r#"{{"children":[1,2,3,4],{first}}},{{"mesh":0}},{{"mesh":0,{shown}}},{{"camera":0}},{{"children":[5],{lamp}}},
            {{"mesh":0,{hidden}}}"#
        )
    };
    let counts = |first: &str| {
        let scene = scene(&of_nodes(&nodes(first), more));
        assert_eq!(
            warnings(&scene).replace("there is nothing to render in this file", "").lines().count(),
            0
        );
        (scene.objects.len(), scene.lights.len(), scene.cameras.len())
    };
    assert_eq!(counts(shown), (2, 1, 1));
    assert_eq!(counts(r#""name":"root""#), (2, 1, 1));
    let all_hidden = scene(&of_nodes(&nodes(hidden), more));
    let found = (all_hidden.objects.len(), all_hidden.lights.len(), all_hidden.cameras.len());
    assert_eq!(found, (0, 0, 1));
    assert!(all_hidden.notes.iter().any(|note| note.message.contains("KHR_node_visibility")));
}

/// The animation of the extension's example: a boolean that steps. [KHR_animation_pointer]
#[test]
fn visibility_and_nodes_are_animated_by_pointers() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    let times = parts.floats("SCALAR", 1, &[0.0, 1.0, 2.0]);
    let visible = parts.add("SCALAR", 5121, 3, &[1, 0, 1, 0]);
    let moves = parts.floats("VEC3", 3, &[0., 0., 0., 0., 0., 4., 0., 0., 8.]);
    let channel = |sampler: usize, pointer: &str| {
        format!(
            r#"{{"sampler":{sampler},"target":{{"path":"pointer","extensions":{{"KHR_animation_pointer":
            {{"pointer":"{pointer}"}}}}}}}}"#
        )
    };
    let text = parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"extensions":{{"KHR_node_visibility":{{}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"samplers":[{{"input":{times},"output":{visible},"interpolation":"STEP"}},
        {{"input":{times},"output":{moves}}}],"channels":[{},{}]}}],
        "extensionsUsed":["KHR_node_visibility","KHR_animation_pointer"]"#,
        channel(0, "/nodes/0/extensions/KHR_node_visibility/visible"),
        channel(1, "/nodes/0/translation"),
    ));
    for (time, z) in [(0.0, Some(0.0)), (0.5, Some(2.0)), (1.0, None), (1.5, None), (2.0, Some(8.0))] {
        let options = ReadOptions { time, ..ReadOptions::default() };
        let scene = read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &options).unwrap();
        let places = scene.objects.iter().map(|object| object.motion.at(0.0).matrix().w_axis.z);
        assert_eq!(places.collect::<Vec<_>>(), Vec::from_iter(z), "at {time} s");
    }
}

/// The specification leaves open where a vertex without weights is; three.js gives it to the first of its joints
/// (`normalizeSkinWeights`), so that it moves with its neighbours.
#[test]
fn a_vertex_without_weights_follows_its_first_joint() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    parts.add("VEC4", 5121, 3, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    parts.floats("VEC4", 4, &[0., 0., 0., 0., 1., 0., 0., 0., 0., 0., 0., 0.]);
    let text = parts.document(
        r#""scenes":[{"nodes":[0,1,2]}],"nodes":[{"mesh":0,"skin":0},{"translation":[5,0,0]},{"translation":[0,7,0]}],
        "skins":[{"joints":[1,2]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}]"#,
    );
    let scene = scene(&text);
    let positions = &scene.objects[0].mesh.positions;
    assert_eq!(positions[..], [Vec3::new(5., 0., 0.), Vec3::new(6., 0., 0.), Vec3::new(0., 8., 0.)]);
    assert!(warnings(&scene).contains("they follow the first joint"), "{}", warnings(&scene));
}

/// RFC 3986, 8089 and 2397; and exporters that do not escape what they should.
#[test]
fn uris_in_every_form_find_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::new(1.0, 0.0, 0.0)]).unwrap();
        bilux_pictures::write(folder.path().join(name), &picture, &Default::default()).unwrap();
    };
    for name in ["plain.png", "a b.png", "ümlaut.png", "50%25.png", "what#1.png", "q?x.png", "Wood.PNG"] {
        write(name);
    }
    let bytes = std::fs::read(folder.path().join("plain.png")).unwrap();
    let escaped: String = bytes.iter().map(|b| format!("%{b:02X}")).collect();
    use base64::Engine;
    let base64 = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let folder_uri = folder.path().display();
    for uri in [
        "plain.png".to_owned(),
        "./plain.png".to_owned(),
        "plain.png?v=12".to_owned(),
        "plain.png#top".to_owned(),
        "PLAIN.png".to_owned(),
        "wood.png".to_owned(),
        "file:plain.png".to_owned(),
        "file:///srv/elsewhere/plain.png".to_owned(),
        "FILE://localhost/srv/elsewhere/plain.png".to_owned(),
        "file:///C:/Models/me/plain.png".to_owned(),
        format!("file://{folder_uri}/plain.png"),
        "a%20b.png".to_owned(),
        "a b.png".to_owned(),
        "%C3%BCmlaut.png".to_owned(),
        "ümlaut.png".to_owned(),
        "50%2525.png".to_owned(),
        "50%25.png".to_owned(),
        "what#1.png".to_owned(),
        "what%231.png".to_owned(),
        "q?x.png".to_owned(),
        "textures\\\\plain.png".to_owned(),
        format!("data:image/png;base64,{base64}"),
        format!("DATA:image/png;BASE64,{base64}"),
        format!("data:;base64,{}", base64.replace('=', "%3D").replace('+', "%2B")),
        format!("data:,{escaped}"),
        format!("data:image/png,{escaped}"),
        format!("data:image/png;base64,{}", base64.trim_end_matches('=')),
    ] {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":"{uri}"}}],"textures":[{{"source":0}}],
            "buffers":[{{"byteLength":36,"uri":"data:,{}"}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
            "scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}]}}"#,
            TRIANGLE.iter().flat_map(|x| x.to_le_bytes()).map(|b| format!("%{b:02x}")).collect::<String>()
        );
        let path = folder.path().join("s.gltf");
        std::fs::write(&path, text).unwrap();
        let scene = read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{uri}: {error}"));
        let all = warnings(&scene);
        assert!(!all.contains("magenta"), "{uri}: {all}");
        assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(1.0, 0.0, 0.0), "{uri}: {all}");
    }
}

#[test]
fn uris_outside_the_folder_and_of_the_network_are_refused() {
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    std::fs::write(outer.path().join("secret.bin"), [0; 36]).unwrap();
    let secret = outer.path().join("secret.bin");
    for (uri, part) in [
        (format!("file://{}", secret.display()), "outside"),
        ("../secret.bin".to_owned(), "outside"),
        ("%2e%2e/secret.bin".to_owned(), "outside"),
        ("../SECRET.bin?x".to_owned(), "no file"),
        ("https://example.org/a.bin".to_owned(), "web address"),
        ("blob:https://example.org/1".to_owned(), "web address"),
        ("//example.org/a.bin".to_owned(), "web address"),
    ] {
        let text =
            format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#);
        let path = inner.join("s.gltf");
        std::fs::write(&path, text).unwrap();
        let error = read(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(part), "{uri}: {error}");
    }
}

/// Animated values take the place of what the node says, which may be that it is hidden. [KHR_animation_pointer]
#[test]
fn a_node_that_is_hidden_at_rest_is_shown_where_its_animation_says_so() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    let times = parts.floats("SCALAR", 1, &[0.0, 1.0]);
    let visible = parts.add("SCALAR", 5121, 2, &[0, 1]);
    let text = parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"extensions":{{"KHR_node_visibility":{{"visible":false}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"samplers":[{{"input":{times},"output":{visible},"interpolation":"STEP"}}],
        "channels":[{{"sampler":0,"target":{{"path":"pointer","extensions":{{"KHR_animation_pointer":
        {{"pointer":"/nodes/0/extensions/KHR_node_visibility/visible"}}}}}}}}]}}],
        "extensionsUsed":["KHR_node_visibility","KHR_animation_pointer"]"#
    ));
    for (time, count) in [(0.0, 0), (0.5, 0), (1.0, 1), (2.0, 1)] {
        let options = ReadOptions { time, ..ReadOptions::default() };
        let scene = read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &options).unwrap();
        assert_eq!(scene.objects.len(), count, "at {time} s");
    }
}

/// A vertex without weights belongs to the first joint of its first set, whatever the second set names.
#[test]
fn the_first_joint_is_that_of_the_first_set() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    parts.add("VEC4", 5121, 3, &[1, 0, 0, 0].repeat(3));
    parts.floats("VEC4", 4, &[0.; 12]);
    parts.add("VEC4", 5121, 3, &[0; 12]);
    let text = parts.document(
        r#""scenes":[{"nodes":[0,1,2]}],"nodes":[{"mesh":0,"skin":0},{"translation":[5,0,0]},{"translation":[0,7,0]}],
        "skins":[{"joints":[1,2]}],"meshes":[{"primitives":[{"attributes":
        {"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2,"JOINTS_1":3,"WEIGHTS_1":2}}]}]"#,
    );
    let scene = scene(&text);
    let positions = &scene.objects[0].mesh.positions;
    assert_eq!(positions[..], [Vec3::new(0., 7., 0.), Vec3::new(1., 7., 0.), Vec3::new(0., 8., 0.)]);
}

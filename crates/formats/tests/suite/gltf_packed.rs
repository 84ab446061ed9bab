//! glTF files whose meshes and textures were compressed by other programs decode to the original data.

use crate::{read_text, refusal, warnings};
use bilux_math::Vec3;
use bilux_scene::SceneBuilder;
use std::path::Path;

fn seed(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/scene_gltf");
    std::fs::read_to_string(folder.join(name)).unwrap()
}

fn seeds_of_draco() -> [String; 3] {
    ["draco_sequential.gltf", "draco_standard.gltf", "draco_valence.gltf"].map(seed)
}

fn read(text: &str) -> SceneBuilder {
    read_text("gltf", text).unwrap_or_else(|error| panic!("{error}"))
}

/// The seeds are a grid of 4 by 4 points over the unit square, with height x y / 2 and uv = (x, y).
#[test]
fn draco_round_trips_points_texture_coordinates_and_triangles() {
    for text in seeds_of_draco() {
        let scene = read(&text);
        let mesh = &scene.objects[0].mesh;
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), warnings(&scene)), (16, 18, String::new()));
        let mut area = 0.0;
        for (p, uv) in mesh.positions.iter().zip(&mesh.uvs) {
            assert!((p.z - p.x * p.y / 2.0).abs() < 1e-3, "{p}");
            assert!((p.x - uv.x).abs() < 1e-3 && (p.y - uv.y).abs() < 1e-3, "{p}: {uv}");
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.z > 0.0, "all are seen from above");
            area += normal.dot(Vec3::Z) / 2.0;
        }
        assert!((area - 1.0).abs() < 1e-3, "they cover the square once: {area}");
    }
}

#[test]
fn broken_draco_data_is_refused_with_its_pointer() {
    let text = &seeds_of_draco()[1];
    let cases = [
        (r#""TEXCOORD_0":0"#, r#""TEXCOORD_0":7"#, "TEXCOORD_0: the compressed data have no attribute 7"),
        (r#"{"POSITION":1"#, r#"{"NORMAL":1"#, "the primitive has no such attribute"),
        (
            r#""count":54"#,
            r#""count":51"#,
            "#/accessors/2: 54 elements of 108 bytes are compressed for these 51",
        ),
        ("\"componentType\":5123", "\"componentType\":5120", "do not fit this componentType"),
        (r#""indices":2"#, r#""indices":2,"mode":5"#, "Draco compresses only triangles"),
        ("base64,RFJBQ08", "base64,RFJBR08", "the Draco data of this primitive cannot be decompressed"),
    ];
    for (from, to, part) in cases {
        assert!(text.contains(from), "{from}");
        let message = refusal("gltf", text.replacen(from, to, 1));
        assert!(message.contains(part), "{from} → {to}: {message}");
    }
}

/// Changes the compressed data one byte at a time: the result is a scene or an error, never a panic.
#[test]
fn any_byte_of_draco_may_be_wrong() {
    for text in seeds_of_draco() {
        let start = text.find("base64,").unwrap() + 7;
        let end = start + text[start..].find('"').unwrap();
        for at in start..end {
            for letter in ['A', '/', 'g'] {
                let mut broken = text.clone();
                broken.replace_range(at..=at, &letter.to_string());
                let options = bilux_formats::ReadOptions { max_memory: 64 << 20, ..Default::default() };
                let _ = bilux_formats::read_bytes(broken.as_bytes(), "gltf", None, "x", &options);
            }
        }
    }
}

#[test]
fn textures_of_basis_universal_are_unpacked() {
    let scene = read(&seed("basisu.gltf"));
    assert!(!warnings(&scene).contains("checker"), "{}", warnings(&scene));
    let texture = &scene.textures[0];
    assert_eq!((texture.width(), texture.height()), (20, 12));
}

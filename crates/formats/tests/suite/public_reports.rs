//! Faults that people reported of other programs (`docs/lab/reports-files.md`), each with the answer of the specification.

use crate::gltf_motion::Parts;
use crate::{read_text, warnings};
use base64::Engine;
use bilux_formats::{ReadOptions, read};
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{Rgb, Vec2};
use bilux_pictures::{Picture, WriteOptions, write_bytes};
use bilux_scene::texture::Wrap;
use bilux_scene::{SceneBuilder, Spec, Value};

fn value<'s>(spec: &'s Spec, key: &str) -> Option<&'s Value> {
    spec.parameters.find(key).map(|(value, _)| value)
}

fn picture_uri(format: &str, declared: &str) -> String {
    let picture = Picture::from_rgb(8, 8, vec![Rgb::new(1.0, 0.0, 0.0); 64]).unwrap();
    let bytes = write_bytes(format, &picture, &WriteOptions::default()).unwrap();
    format!("data:{declared};base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

/// A triangle with a material, and more at the root of the document.
fn with_material(material: &str, attributes: &str, more: &str) -> SceneBuilder {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let text = parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"materials":[{{{material}}}],
        "meshes":[{{"primitives":[{{"material":0,"attributes":{{"POSITION":0{attributes}}}}}]}}]{more}"#
    ));
    read_text("gltf", &text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// three.js#34032: the order is translation · rotation · scale, which differs from others where scales are uneven.
/// [KHR_texture_transform]
#[test]
fn textures_are_scaled_before_they_are_rotated() {
    let scene = with_material(
        r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
        {"offset":[0.1,0.2],"rotation":0.5,"scale":[2,3]}}}}"#,
        "",
        &format!(
            r#","textures":[{{"source":0}}],"images":[{{"uri":"{}"}}]"#,
            picture_uri("png", "image/png")
        ),
    );
    let (sin, cos) = sin_cos_f64(0.5);
    let (u, v) = (0.3 * 2.0, 0.7 * 3.0);
    let wanted = Vec2::new((cos * u + sin * v + 0.1) as f32, (-sin * u + cos * v + 0.2) as f32);
    let found = scene.textures[0].transform.unwrap().apply(Vec2::new(0.3, 0.7));
    assert!(found.distance(wanted) < 1e-5, "{found}, not {wanted}");
}

/// gltf-rs#346: an accessor without a buffer view is all zeros. [glTF 2.0, 3.6.2.1]
#[test]
fn an_accessor_without_data_is_zero() {
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "buffers":[{"byteLength":36,"uri":"data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3F%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3F%00%00%00%00"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
        {"componentType":5126,"count":3,"type":"VEC2"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}]}"#;
    let scene = read_text("gltf", text).unwrap();
    // In Bilux, v points up.
    assert_eq!(scene.objects[0].mesh.uvs, [Vec2::Y; 3]);
}

/// Babylon.js#15557: an alpha of 0 is less than the cutoff, and so wholly transparent. [glTF 2.0, 3.9.4]
#[test]
fn a_mask_hides_a_colour_without_a_texture() {
    for (alpha, wanted) in [(0.0, Some(0.0)), (0.49, Some(0.0)), (0.5, None), (1.0, None)] {
        let material =
            format!(r#""alphaMode":"MASK","pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{alpha}]}}"#);
        let scene = with_material(&material, "", "");
        let found = value(&scene.materials[0], "opacity").cloned();
        assert_eq!(
            found.filter(|opacity| *opacity != Value::from(1.0)),
            wanted.map(Value::from),
            "alpha {alpha}"
        );
    }
}

/// three.js#15483: of an opaque material the alpha of the texture means nothing. [glTF 2.0, 3.9.4]
#[test]
fn an_opaque_material_ignores_alpha() {
    let scene = with_material(r#""pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}"#, "", "");
    assert_eq!(value(&scene.materials[0], "opacity"), None);
}

/// meshoptimizer#677: exporters declare JPEG pictures as PNG, and the other way round; the bytes say what they are.
#[test]
fn pictures_under_a_wrong_type_are_shown() {
    for (format, declared) in
        [("jpeg", "image/png"), ("png", "image/jpeg"), ("webp", "image/png"), ("png", "")]
    {
        let scene = with_material(
            r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#,
            "",
            &format!(
                r#","textures":[{{"source":0}}],"images":[{{"uri":"{}"}}]"#,
                picture_uri(format, declared)
            ),
        );
        let texel = scene.textures[0].texel(0, 0);
        assert!(
            (texel.r - 1.0).abs() < 0.02 && texel.g < 0.02,
            "{format} as {declared}: {}",
            warnings(&scene)
        );
    }
}

/// tinyobjloader-c#71, godot#110345 and AsImpL#25: options before the name of a texture, `map_Bump` with `-bm`, and
/// `map_KD` in capitals.
#[test]
fn textures_of_mtl_have_options_and_capitals() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Picture::from_rgb(1, 1, vec![Rgb::new(0.0, 1.0, 0.0)]).unwrap();
    bilux_pictures::write(folder.path().join("BodyStripe.png"), &picture, &WriteOptions::default()).unwrap();
    let blue = Picture::from_rgb(1, 1, vec![Rgb::new(0.214, 0.214, 1.0)]).unwrap();
    bilux_pictures::write(folder.path().join("Normal.png"), &blue, &WriteOptions::default()).unwrap();
    let library = "newmtl m\nmap_KD -o 0.0 -7.0 0.0 -s 1.0 10.0 1.0 -clamp on BodyStripe.png\nmap_Bump -bm 0.5 Normal.png\n";
    std::fs::write(folder.path().join("l.mtl"), library).unwrap();
    let path = folder.path().join("s.obj");
    std::fs::write(&path, "mtllib l.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n").unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    let texture = &scene.textures[0];
    assert_eq!((&*texture.name, texture.wrap), ("BodyStripe.png", [Wrap::Clamp; 2]));
    // With v upwards: u, v become u, 10 v − 7.
    let found = texture.transform.unwrap().apply(Vec2::new(0.25, 1.0 - 0.75));
    assert!(found.distance(Vec2::new(0.25, 1.0 - 0.5)) < 1e-5, "{found}");
    assert_eq!(value(&scene.materials[0], "normal_scale"), Some(&Value::from(0.5)));
}

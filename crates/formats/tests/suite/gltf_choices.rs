//! Choices that glTF leaves open: thin geometry, glass, variants, sizes of lights, texture coordinates.

use crate::{read_text, warnings};
use bilux_formats::{Glass, ReadOptions, read_bytes};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Value};

fn read(text: &str, options: &ReadOptions) -> SceneBuilder {
    read_bytes(text.as_bytes(), "gltf", None, "scene.gltf", options).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn floats(numbers: &[f32]) -> String {
    let bytes = numbers.iter().flat_map(|x| x.to_le_bytes());
    let text: String = bytes.map(|byte| format!("%{byte:02x}")).collect();
    format!("data:,{text}")
}

/// A tetrahedron with outward faces; `more` is added to the document.
fn tetrahedron(primitive: &str, more: &str) -> String {
    let positions = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    let uvs = [0., 0., 1., 0., 0., 1., 1., 1.];
    let others = [0., 0., 0., 1., 1., 0., 1., 1.];
    let indices: Vec<f32> = [0u16, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
        .chunks(2)
        .map(|pair| f32::from_bits(u32::from(pair[0]) | u32::from(pair[1]) << 16))
        .collect();
    let all = [positions.as_slice(), &uvs, &others, &indices].concat();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2}},{primitive}}}]}}],
        "accessors":[
        {{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
        {{"bufferView":0,"byteOffset":48,"componentType":5126,"count":4,"type":"VEC2"}},
        {{"bufferView":0,"byteOffset":80,"componentType":5126,"count":4,"type":"VEC2"}},
        {{"bufferView":0,"byteOffset":112,"componentType":5123,"count":12,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":136}}],{more}
        "buffers":[{{"byteLength":136,"uri":"{}"}}]}}"#,
        floats(&all)
    )
}

#[test]
fn points_and_lines_are_no_triangles() {
    let points = read(&tetrahedron(r#""mode":0"#, ""), &ReadOptions::default());
    let mesh = &points.objects[0].mesh;
    assert_eq!((mesh.points.len(), mesh.triangles.len(), mesh.positions.len()), (4, 0, 4));
    assert_eq!(mesh.uvs.len(), mesh.positions.len());
    assert_eq!(mesh.bounds().extent(), Vec3::splat(1.0));
    assert_eq!(warnings(&points), "");
    for (mode, lines) in [(1, 2), (2, 4), (3, 3)] {
        let scene = read(&tetrahedron(&format!(r#""mode":{mode}"#), ""), &ReadOptions::default());
        let mesh = &scene.objects[0].mesh;
        assert_eq!((mesh.lines.len(), mesh.triangles.len()), (lines, 0), "mode {mode}");
        scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    }
}

const GLASS: &str =
    r#""materials":[{"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}}],"#;

#[test]
fn glass_without_a_thickness_is_what_was_asked_for() {
    let closed = tetrahedron(r#""indices":3,"material":0"#, GLASS);
    let open = tetrahedron(r#""material":0,"mode":5"#, GLASS);
    let cases = [
        (&closed, Glass::Auto, false),
        (&closed, Glass::Thin, true),
        (&closed, Glass::Solid, false),
        (&open, Glass::Auto, true),
        (&open, Glass::Thin, true),
        (&open, Glass::Solid, false),
    ];
    for (text, glass, thin) in cases {
        let scene = read(text, &ReadOptions { glass, ..ReadOptions::default() });
        let spec = &scene.materials[scene.objects[0].material];
        assert_eq!(spec.parameters.find("thin_walled").unwrap().0, &Value::Bool(thin), "{glass:?}");
        assert_eq!(warnings(&scene).contains("is shown as solid glass"), glass == Glass::Auto && !thin);
    }
}

#[test]
fn variants_change_materials() {
    let text = tetrahedron(
        r#""indices":3,"material":0,"extensions":{"KHR_materials_variants":{"mappings":[
        {"material":1,"variants":[0,2]},{"material":2,"variants":[1]}]}}"#,
        r#""materials":[{"name":"plain"},{"name":"gold"},{"name":"tin"}],
        "extensions":{"KHR_materials_variants":{"variants":[{"name":"rich"},{"name":"poor"},{"name":"vain"}]}},"#,
    );
    let shown = |variant: Option<&str>| {
        let scene =
            read(&text, &ReadOptions { variant: variant.map(str::to_owned), ..ReadOptions::default() });
        assert_eq!(scene.inventory.variants, ["rich", "poor", "vain"]);
        assert_eq!(warnings(&scene), "");
        scene.materials[scene.objects[0].material].name.clone()
    };
    assert_eq!([None, Some("rich"), Some("1"), Some("vain")].map(shown), ["plain", "gold", "tin", "gold"]);
    let wrong = ReadOptions { variant: Some("reich".to_owned()), ..ReadOptions::default() };
    let error = read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &wrong).unwrap_err().to_string();
    assert!(error.contains("no variant 'reich'") && error.contains("rich, poor, vain"), "{error}");
}

#[test]
fn textures_are_looked_up_by_two_sets_of_coordinates() {
    let pixel = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";
    let text = tetrahedron(
        r#""indices":3,"material":0"#,
        &format!(
            r#""materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"texCoord":1}}}},
            "normalTexture":{{"index":0}},"emissiveTexture":{{"index":0,"texCoord":1}},"emissiveFactor":[1,1,1]}}],
            "textures":[{{"source":0}}],"images":[{{"uri":"{pixel}"}}],"#
        ),
    );
    let scene = read(&text, &ReadOptions::default());
    let mesh = &scene.objects[0].mesh;
    // The first texture's set becomes the first set, so the two sets are swapped.
    assert_eq!((mesh.uvs[1], mesh.uvs2[1]), (Vec2::new(0.0, 0.0), Vec2::new(1.0, 1.0)));
    let second: Vec<bool> = scene.textures.iter().map(|texture| texture.second_uv).collect();
    assert_eq!(second, [false, false, true]);
    assert!(!mesh.tangents.is_empty(), "a normal map needs tangents");
    assert_eq!(warnings(&scene), "");
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    let without = text.replace(r#""TEXCOORD_0":1,"#, "");
    let reported = warnings(&read(&without, &ReadOptions::default()));
    assert!(reported.contains("texture coordinates that its mesh does not have"), "{reported}");
}

#[test]
fn lights_get_a_size_and_areas_shine_forwards() {
    let text = tetrahedron("\"mode\":4", "").replace(
        r#"[{"mesh":0}]"#,
        r#"[{"mesh":0,"scale":[2,1,1],"extensions":{"KHR_lights_punctual":{"light":0},"EXT_lights_area":{"light":0}},"children":[1]},
        {"extensions":{"EXT_lights_area":{"light":1}}}]"#,
    );
    let text = text.replace(
        r#""buffers""#,
        r#""extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":4}]},
        "EXT_lights_area":{"lights":[{"type":"rect","intensity":3,"size":2,"rect":{"aspect":2}},{"type":"disk"}]}},"buffers""#,
    );
    let scene = read(&text, &ReadOptions { light_radius: 0.5, ..ReadOptions::default() });
    let [ball, panel] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    let value = |spec: &bilux_scene::Spec, key: &str| spec.parameters.find(key).unwrap().0.clone();
    assert_eq!((&*ball.kind, value(ball, "radius")), ("sphere", 0.5f32.into()));
    assert_eq!(value(ball, "intensity"), Rgb::grey(4.0).into(), "of the same power");
    assert_eq!(
        (value(panel, "edge_u"), value(panel, "edge_v")),
        (Vec3::new(8., 0., 0.).into(), Vec3::new(0., -4., 0.).into())
    );
    let disk = scene.objects.iter().find(|object| object.mesh.name == "disk light").unwrap();
    let [a, b, c] = disk.mesh.triangles[0].map(|i| disk.mesh.positions[i as usize]);
    assert!((b - a).cross(c - a).z < 0.0, "forwards");
    assert!((disk.mesh.bounds().extent().x - 2.0).abs() < 1e-2);
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    let plain = read(&text, &ReadOptions::default());
    assert_eq!(plain.lights[0].kind, "point");
}

#[test]
fn glossiness_is_one_minus_roughness() {
    let text = tetrahedron(
        r#""indices":3,"material":0"#,
        r#""materials":[{"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0,0,0,1],
        "specularFactor":[1,0.8,0.3],"glossinessFactor":0.75}}}],"#,
    );
    let scene = read_text("gltf", &text).unwrap();
    let spec = &scene.materials[scene.objects[0].material];
    let number = |key: &str| match spec.parameters.find(key).unwrap().0 {
        Value::Number(x) => *x,
        ref other => panic!("{other:?}"),
    };
    assert!(number("base_metalness") > 0.99 && (number("specular_roughness") - 0.25).abs() < 1e-6);
}

//! glTF files as exporters write them.

use crate::{read_text, refusal, warnings};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Value;

/// A document with one triangle; tests replace parts of it.
const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

fn read(text: &str) -> bilux_scene::SceneBuilder {
    read_text("gltf", text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Little-endian floats as a data URI that needs no base64.
fn floats(numbers: &[f32]) -> String {
    let bytes = numbers.iter().flat_map(|x| x.to_le_bytes());
    let text: String = bytes.map(|byte| format!("%{byte:02x}")).collect();
    format!("data:application/octet-stream,{text}")
}

/// A document with a list of triangles and extra parts.
fn document(primitive: &str, accessors: &str, views: &str, bytes: usize, uri: &str, node: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],
        "meshes":[{{"primitives":[{primitive}]}}],"accessors":[{accessors}],"bufferViews":[{views}],
        "buffers":[{{"byteLength":{bytes},"uri":"{uri}"}}]}}"#
    )
}

#[test]
fn a_triangle_is_that_triangle() {
    let scene = read(TRIANGLE);
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert!(mesh.normals.is_empty(), "flat without normals");
    assert_eq!(warnings(&scene), "");
    assert_eq!(read_text("", TRIANGLE).unwrap().objects[0].mesh, *mesh, "by its first bytes");
}

#[test]
fn strips_and_fans_keep_their_side() {
    let square = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.]);
    let accessor = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}"#;
    let view = r#"{"buffer":0,"byteLength":48}"#;
    let of_mode = |mode: u32| {
        let primitive = format!(r#"{{"mode":{mode},"attributes":{{"POSITION":0}}}}"#);
        read(&document(&primitive, accessor, view, 48, &square, ""))
    };
    assert_eq!(of_mode(5).objects[0].mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(of_mode(6).objects[0].mesh.triangles, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn interleaved_normalised_and_sparse_elements_are_read() {
    // Position as shorts (three, and two bytes of padding), colour as four bytes, uv as normalised bytes with
    // padding.
    let vertex = |x: i16, y: i16, rgb: [u8; 3], uv: [u8; 2]| {
        let mut bytes = [x.to_le_bytes(), y.to_le_bytes(), [0; 2], [0; 2]].concat();
        bytes.extend([rgb[0], rgb[1], rgb[2], 255, uv[0], uv[1], 0, 0]);
        bytes
    };
    let bytes = [
        vertex(0, 0, [255, 0, 0], [0, 0]),
        vertex(100, 0, [0, 255, 0], [255, 0]),
        vertex(0, -100, [0, 0, 255], [51, 255]),
    ]
    .concat();
    let uri: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    // The first position becomes (7, 0, 0); both sparse views use zeros and ones of the same buffer.
    let sparse =
        r#","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}}"#;
    let text = document(
        r#"{"attributes":{"POSITION":0,"COLOR_0":1,"TEXCOORD_0":2}}"#,
        &format!(
            r#"{{"bufferView":0,"componentType":5122,"count":3,"type":"VEC3"{sparse}}},
            {{"bufferView":0,"byteOffset":8,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"}},
            {{"bufferView":0,"byteOffset":12,"componentType":5121,"normalized":true,"count":3,"type":"VEC2"}}"#
        ),
        r#"{"buffer":0,"byteLength":48,"byteStride":16},{"buffer":0,"byteOffset":48,"byteLength":1},
        {"buffer":0,"byteOffset":49,"byteLength":6}"#,
        55,
        &format!("data:,{uri}%00%07%00%00%00%00%00"),
        "",
    );
    let scene = read(&text);
    let mesh = &scene.objects[0].mesh;
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    assert_eq!(mesh.positions, [at(7.0, 0.0), at(100.0, 0.0), at(0.0, -100.0)]);
    assert_eq!(mesh.vertex_kd[1], Rgb::new(0.0, 1.0, 0.0));
    assert_eq!(mesh.uvs[2], Vec2::new(0.2, 0.0), "v upwards");
    assert_eq!(warnings(&scene), "");
}

#[test]
fn nodes_are_placed_below_their_parents() {
    let text = TRIANGLE.replace(
        r#"[{"mesh":0}]"#,
        r#"[{"translation":[1,0,0],"scale":[-2,2,2],"children":[1,2]},
        {"mesh":0,"name":"left","rotation":[0,0,0.7071067811865476,0.7071067811865476]},
        {"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}]"#,
    );
    let scene = read(&text);
    let [left, right] = &scene.objects[..] else { panic!("{:?}", scene.objects) };
    assert_eq!(left.name, "left");
    assert!((left.motion.at(0.0).point(Vec3::X) - Vec3::new(1.0, 2.0, 0.0)).length() < 1e-6);
    assert!((right.motion.at(0.0).point(Vec3::X) - Vec3::new(-1.0, 0.0, 10.0)).length() < 1e-6);
    assert!(left.motion.at(0.0).mirrors() && std::sync::Arc::ptr_eq(&left.mesh, &right.mesh));
}

#[test]
fn morph_targets_have_the_weights_that_the_file_gives() {
    let uri = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 4.]);
    let accessors = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
        {"bufferView":0,"byteOffset":12,"componentType":5126,"count":3,"type":"VEC3"}"#;
    let text = document(
        r#"{"attributes":{"POSITION":0},"targets":[{"POSITION":1}]}"#,
        accessors,
        r#"{"buffer":0,"byteLength":48}"#,
        48,
        &uri,
        r#","weights":[0.5]"#,
    );
    let scene = read(&text);
    assert_eq!(
        scene.objects[0].mesh.positions,
        [Vec3::X * 0.5, Vec3::new(1.0, 0.5, 0.0), Vec3::new(0., 1., 2.)]
    );
}

#[test]
fn cameras_and_lights_stand_at_their_nodes() {
    let text = TRIANGLE.replace(
        r#"[{"mesh":0}]"#,
        r#"[{"mesh":0,"camera":0,"translation":[0,0,3],"extensions":{"KHR_lights_punctual":{"light":0}}}]"#,
    );
    let text = text.replace(
        r#""buffers""#,
        r#""cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","color":[1,0,0],"intensity":4,"range":9}]}},"buffers""#,
    );
    let scene = read(&text);
    let camera = &scene.cameras[0].spec;
    assert_eq!(camera.parameters.find("position").unwrap().0, &Vec3::new(0.0, 0.0, 3.0).into());
    let light = &scene.lights[0];
    assert_eq!(
        (&*light.kind, light.parameters.find("intensity").unwrap().0),
        ("point", &Rgb::new(4., 0., 0.).into())
    );
    assert!(warnings(&scene).contains("lights/0: a light's range is ignored"));
}

#[test]
fn broken_content_is_refused_with_its_pointer() {
    let cases = [
        (
            "POSITION\":0",
            "POSITION\":7",
            "#/meshes/0/primitives/0/attributes/POSITION: this refers to number 7",
        ),
        ("\"count\":3", "\"count\":4", "#/accessors/0: 4 elements, 12 bytes apart"),
        ("\"count\":3", "\"count\":1000000000", "#/accessors/0: 1000000000 elements"),
        ("\"count\":3", "\"count\":4611686018427387904", "#/accessors/0: 4611686018427387904 elements"),
        (
            "\"bufferView\":0,\"componentType\":5126,\"count\":3",
            "\"componentType\":5126,\"count\":999999999",
            "without data",
        ),
        ("\"count\":3", "\"count\":-3", "#/accessors/0/count: this is -3"),
        ("5126", "5124", "is not a componentType"),
        ("VEC3", "VEC5", "'VEC5' is not an element type"),
        ("VEC3", "VEC2", "its elements have 2 numbers, but 3 are needed"),
        ("\"byteLength\":36}],", "\"byteLength\":37}],", "#/bufferViews/0: 37 bytes from byte 0"),
        ("\"byteLength\":36}],", "\"byteLength\":36,\"byteStride\":8}],", "are only 8 bytes apart"),
        ("base64,AAAA", "base64,A!AA", "#/buffers/0/uri: the base64"),
        (
            "data:application/octet-stream;base64",
            "https://example.org/a.bin?",
            "nothing is loaded from the network",
        ),
        ("{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}", "#/nodes/0/children/0: this node has two parents"),
        ("{\"nodes\":[0]}", "{\"nodes\":[0,0]}", "#/scenes/0/nodes/1: this node has two parents"),
        (
            "{\"mesh\":0}",
            "{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,null,1]}",
            "#/nodes/0/matrix/14: this is null",
        ),
        (
            "{\"mesh\":0}",
            "{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}",
            "#/nodes/0/matrix: the last row of this matrix",
        ),
        ("{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1e300,1,1]}", "finite in 32 bits"),
        ("{\"mesh\":0}", "{\"mesh\":0,\"rotation\":[0,0,0,0]}", "#/nodes/0/rotation: this rotation is zero"),
        ("\"2.0\"", "\"1.0\"", "this is glTF 1.0"),
        ("\"2.0\"", "\"two\"", "a version is two numbers"),
        (
            "\"scene\":0",
            "\"scene\":0,\"extensionsRequired\":[\"KHR_texture_procedurals\"]",
            "requires the extension KHR_texture_procedurals",
        ),
        ("]}]}", "]}]", ""),
    ];
    for (from, to, part) in cases {
        let text = TRIANGLE.replacen(from, to, 1);
        assert!(text != TRIANGLE || from == "]}]}", "{from}");
        if text != TRIANGLE {
            let message = refusal("gltf", &text);
            assert!(message.contains(part), "{from} → {to}: {message}");
        }
    }
    assert!(refusal("gltf", &TRIANGLE[..300]).contains("this is not JSON"));
    let indexed = TRIANGLE
        .replace("\"POSITION\":0}", "\"POSITION\":0},\"indices\":1")
        .replace("\"VEC3\"}]", "\"VEC3\"},{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]");
    assert!(
        refusal("gltf", &indexed).contains("index 2 is 128, but there are 3 vertices"),
        "{}",
        refusal("gltf", &indexed)
    );
}

#[test]
fn unknown_content_is_reported_with_its_location() {
    let text = TRIANGLE.replace(r#"{"mesh":0}"#, r#"{"mesh":0,"extensions":{"EXT_odd":{}}}"#);
    let reported = warnings(&read(&text));
    assert!(
        reported.contains("scene.gltf#/nodes/0/extensions/EXT_odd: the extension EXT_odd is not supported"),
        "{reported}"
    );
}

#[test]
fn containers_are_taken_apart() {
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
    let json = format!("{json:width$}", width = json.len().next_multiple_of(4));
    let floats: Vec<u8> =
        [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut glb = [b"glTF".as_slice(), &word(2), &word(12 + 8 + json.len() + 8 + 36)].concat();
    glb.extend([word(json.len()).as_slice(), b"JSON", json.as_bytes()].concat());
    glb.extend([word(36).as_slice(), b"BIN\0", &floats].concat());
    let scene = read_text("", &glb).unwrap();
    assert_eq!(scene.objects[0].mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(warnings(&scene), "");
    for length in 0..glb.len() {
        assert!(read_text("glb", &glb[..length]).is_err(), "{length}");
    }
}

/// The triangle with a material and everything that the material refers to.
fn with_material(material: &str, more: &str) -> String {
    TRIANGLE
        .replace("\"POSITION\":0}}", "\"POSITION\":0},\"material\":0}")
        .replace("\"buffers\"", &format!("\"materials\":[{material}],{more}\"buffers\""))
}

fn spec_of(scene: &bilux_scene::SceneBuilder) -> &bilux_scene::Spec {
    &scene.materials[scene.objects[0].material]
}

#[test]
fn materials_are_in_the_terms_of_principled() {
    let material = r#"{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":0.5,
        "roughnessFactor":7},"extensions":{"KHR_materials_ior":{"ior":1.25}}}"#;
    let scene = read(&with_material(material, ""));
    let spec = spec_of(&scene);
    let value = |key: &str| spec.parameters.find(key).unwrap().0.clone();
    assert_eq!((&*spec.name, &*spec.kind), ("paint", "principled"));
    assert_eq!(value("base_color"), Rgb::new(0.5, 0.25, 1.0).into());
    assert_eq!((value("base_metalness"), value("specular_ior")), (0.5f32.into(), 1.25f32.into()));
    assert_eq!(value("specular_roughness"), 1.0f32.into());
    let reported = warnings(&scene);
    assert!(
        reported
            .contains("#/materials/0/pbrMetallicRoughness: specular_roughness of a material is out of range"),
        "{reported}"
    );
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
}

#[test]
fn dispersion_is_of_what_is_solid() {
    for (thickness, dispersion, wanted) in
        [(1, 0.5, [Some(0.5), None]), (1, 4.0, [Some(1.0), Some(5.0)]), (0, 0.5, [None; 2])]
    {
        let material = format!(
            r#"{{"extensions":{{"KHR_materials_transmission":{{"transmissionFactor":1}},"KHR_materials_volume":
            {{"thicknessFactor":{thickness}}},"KHR_materials_dispersion":{{"dispersion":{dispersion}}}}}}}"#
        );
        let scene = read(&with_material(&material, ""));
        let value = |key: &str| spec_of(&scene).parameters.find(key).map(|(value, _)| value.clone());
        let keys = ["transmission_dispersion_scale", "transmission_dispersion_abbe_number"];
        assert_eq!(
            keys.map(value),
            wanted.map(|number: Option<f32>| number.map(bilux_scene::Value::from)),
            "{material}"
        );
        let built = scene.build(&Default::default(), [0.0, 0.0], 1.0).unwrap();
        assert_eq!(built.disperses(), thickness == 1, "{material}");
    }
}

#[test]
fn single_sided_materials_emit_from_that_side_and_glass_is_double_sided() {
    let sides = |material: &str| {
        let scene = read(&with_material(material, ""));
        let said = |key| match scene.materials[scene.objects[0].material].parameters.find(key) {
            Some((Value::Text(side), _)) => side.clone(),
            _ => "both".to_owned(),
        };
        [said("visible_sides"), said("emission_sides")]
    };
    assert_eq!(sides("{}"), ["front", "both"]);
    assert_eq!(sides(r#"{"emissiveFactor":[0,0,1]}"#), ["front", "front"]);
    assert_eq!(sides(r#"{"doubleSided":true,"emissiveFactor":[0,0,1]}"#), ["both", "both"]);
    let glass = r#"{"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}}"#;
    assert_eq!(sides(glass), ["both", "both"]);
    let unlit = r#"{"extensions":{"KHR_materials_unlit":{}}}"#;
    assert_eq!(sides(unlit), ["front", "front"]);
}

#[test]
fn colours_of_highlights_above_one_are_a_greater_index() {
    let of = |factor: f32| {
        let material = format!(
            r#"{{"pbrMetallicRoughness":{{"metallicFactor":0}},
            "extensions":{{"KHR_materials_specular":{{"specularColorFactor":[{factor},{},0]}}}}}}"#,
            0.5 * factor
        );
        let scene = read(&with_material(&material, ""));
        let spec = &scene.materials[scene.objects[0].material];
        let ior = match spec.parameters.find("specular_ior") {
            Some((Value::Number(ior), _)) => *ior,
            _ => 1.5f64,
        };
        let root = (ior - 1.0) / (ior + 1.0);
        (root * root, spec.parameters.find("specular_color").unwrap().0.clone())
    };
    for (factor, normal_incidence_reflectance) in [(1.0, 0.04), (4.0, 0.16), (25.0, 0.669)] {
        let (found, colour) = of(factor);
        assert!((found - normal_incidence_reflectance).abs() < 1e-3, "{factor}: {found}");
        assert_eq!(colour, Rgb::new(1.0, 0.5, 0.0).into(), "{factor}");
    }
}

/// Textures of directions and of thicknesses are converted at every texel, as the extensions specify.
#[test]
fn directions_and_thicknesses_come_from_their_textures() {
    let folder = tempfile::TempDir::new().unwrap();
    // Along +x, +y, -x and -y; with the minimum thickness, the maximum, and in between.
    let texels = [[255, 128, 255, 255], [128, 255, 255, 255], [0, 128, 255, 255], [128, 0, 255, 255]];
    let plane = |c: usize| texels.iter().map(|t: &[u8; 4]| f32::from(t[c]) / 255.0).collect::<Vec<f32>>();
    let mut picture = bilux_pictures::Picture::new(4, 1).unwrap();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        picture.push_channel(name, plane(c)).unwrap();
    }
    picture.colour_space = bilux_pictures::ColourSpace::Srgb;
    let path = folder.path().join("a.png");
    bilux_pictures::write(&path, &picture, &bilux_pictures::WriteOptions::default()).unwrap();
    let material = r#"{"occlusionTexture":{"index":0},"extensions":{
        "KHR_materials_anisotropy":{"anisotropyStrength":0.8,"anisotropyTexture":{"index":0}},
        "KHR_materials_iridescence":{"iridescenceFactor":1,"iridescenceThicknessMinimum":100,
            "iridescenceThicknessMaximum":500,"iridescenceThicknessTexture":{"index":0}}}}"#;
    let more = r#""textures":[{"source":0}],"images":[{"uri":"a.png"}],"#;
    let file = folder.path().join("a.gltf");
    std::fs::write(&file, with_material(material, more)).unwrap();
    let scene = bilux_formats::read(&file, &bilux_formats::ReadOptions::default()).unwrap();
    let numbers = |key: &str| {
        let Some((bilux_scene::Value::Texture(i), _)) = spec_of(&scene).parameters.find(key) else {
            panic!("{key}: {:?}", spec_of(&scene))
        };
        [0.125, 0.375, 0.625, 0.875].map(|u| scene.textures[*i].number(bilux_math::Vec2::new(u, 0.5)))
    };
    let (turns, thickness) = (numbers("anisotropy_rotation"), numbers("thin_film_thickness"));
    for (found, wanted) in turns.into_iter().zip([0.25, 0.5, 0.75, 0.0]) {
        assert!((found - wanted).abs().min(1.0 - (found - wanted).abs()) < 0.005, "{turns:?}");
    }
    for (found, wanted) in thickness.into_iter().zip([0.3, 0.5, 0.3, 0.1]) {
        assert!((found - wanted).abs() < 0.002, "{thickness:?}");
    }
    // Light transport computes the occlusion, so that nothing is missing from the picture.
    let notes: Vec<String> = scene.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes.iter().filter(|w| w.contains("occlusion textures are not used")).count(),
        1,
        "{notes:?}"
    );
    let said: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    assert!(said.iter().all(|w| w.contains("texture coordinates that its mesh does not have")), "{said:?}");
}

#[test]
fn every_extension_gives_a_material_that_can_be_built() {
    let extensions = [
        r#""KHR_materials_transmission":{"transmissionFactor":1}"#,
        r#""KHR_materials_transmission":{"transmissionFactor":0.5},"KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":0.1,"attenuationColor":[1,0.5,0]}"#,
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatRoughnessFactor":0.1}"#,
        r#""KHR_materials_sheen":{"sheenColorFactor":[1,0.5,0],"sheenRoughnessFactor":0.3}"#,
        r#""KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[2,1,1]}"#,
        r#""KHR_materials_anisotropy":{"anisotropyStrength":0.8,"anisotropyRotation":1}"#,
        r#""KHR_materials_emissive_strength":{"emissiveStrength":5}"#,
        r#""KHR_materials_unlit":{}"#,
        "",
    ];
    for extension in extensions {
        for mode in ["", r#","alphaMode":"BLEND""#, r#","alphaMode":"MASK""#] {
            let material = format!(
                r#"{{"pbrMetallicRoughness":{{"baseColorFactor":[1,1,0,0.5],"metallicFactor":0}},
                "emissiveFactor":[0,0,1],"extensions":{{{extension}}}{mode}}}"#
            );
            let scene = read(&with_material(&material, ""));
            scene
                .build(&Default::default(), [0.0, 0.0], 1.0)
                .map(drop)
                .unwrap_or_else(|e| panic!("{material}: {e}"));
        }
    }
}

#[test]
fn textures_lie_beside_the_scene_and_missing_ones_are_seen() {
    use bilux_pictures::{Picture, WriteOptions, write as write_picture};
    let folder = tempfile::tempdir().unwrap();
    let texels = vec![Rgb::BLACK, Rgb::WHITE, Rgb::BLACK, Rgb::WHITE];
    let picture = Picture::from_rgb(2, 2, texels).unwrap();
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    write_picture(folder.path().join("inner/für alle.png"), &picture, &WriteOptions::default()).unwrap();
    let material = r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
        {"offset":[0.5,0]}}},"metallicRoughnessTexture":{"index":1}}}"#;
    let more = r#""textures":[{"source":0,"sampler":0},{"source":1}],"samplers":[{"wrapS":33071,"magFilter":9728}],
        "images":[{"uri":"f%C3%BCr%20alle.png"},{"uri":"gone.png"}],"#;
    let path = folder.path().join("inner").join("scene.gltf");
    std::fs::write(&path, with_material(material, more)).unwrap();
    let scene = bilux_formats::read(&path, &Default::default()).unwrap();
    let base = &scene.textures[0];
    assert_eq!((&*base.name, base.width()), ("für alle.png", 2));
    assert_eq!(base.at(Vec2::new(0.1, 0.5)), Rgb::WHITE, "shifted by half");
    assert_eq!(base.at(Vec2::new(0.9, 0.5)), Rgb::WHITE, "held at the edge");
    assert_eq!(scene.textures[1].width(), 8);
    let reported = warnings(&scene);
    assert!(reported.contains("#/images/1: a texture is replaced by a magenta checker"), "{reported}");
    let climbing = with_material(material, &more.replace("gone.png", "../gone.png"));
    std::fs::write(folder.path().join("gone.png"), b"x").unwrap();
    std::fs::write(&path, climbing).unwrap();
    let scene = bilux_formats::read(&path, &Default::default()).unwrap();
    assert!(warnings(&scene).contains("lies outside the scene's folder"), "{}", warnings(&scene));
}

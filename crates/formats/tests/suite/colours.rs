//! Colours of vertices and faces: one rule for all formats (ADR 0043), against the sRGB curve of IEC 61966-2-1.

use crate::{read_text, warnings};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_math::transcendental::exp_f64;
use bilux_scene::{Mesh, SceneBuilder, Value};

fn kd(scene: &SceneBuilder) -> Vec<Rgb> {
    scene.objects.iter().flat_map(|object| object.mesh.vertex_kd.clone()).collect()
}

/// The reflectances of colours that displays show, from 0 to 1.
fn shown(colours: &[[f32; 3]]) -> Vec<Rgb> {
    colours.iter().map(|c| Rgb::from_array(c.map(srgb_decode))).collect()
}

#[track_caller]
fn assert_near(found: &[Rgb], wanted: &[Rgb], within: f32, name: &str) {
    assert_eq!(found.len(), wanted.len(), "{name}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((*a - *b).map(f32::abs).max_channel() <= within, "{name}: {found:?}, not {wanted:?}");
    }
}

/// A triangle of a format, whose vertices have these colours.
fn triangle(format: &str, kind: &str, colours: &[[&str; 3]; 3]) -> String {
    let [a, b, c] = colours.each_ref().map(|c| c.join(" "));
    match format {
        "ply" => format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property {kind} red\nproperty {kind} green\nproperty {kind} blue\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n3 0 1 2\n"
        ),
        "obj" => format!("v 0 0 0 {a}\nv 1 0 0 {b}\nv 0 1 0 {c}\nf 1 2 3\n"),
        "off" => format!("COFF\n3 1 0\n0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n3 0 1 2\n"),
        _ => format!("0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n"),
    }
}

#[test]
fn the_same_numbers_mean_the_same_colours_in_every_format() {
    let unit = [["0", "0.25", "0.5"], ["0.1", "0.9", "0"], ["1", "0", "0.75"]];
    let bytes = [["0", "51", "128"], ["26", "255", "0"], ["255", "0", "102"]];
    let words = [["0", "13107", "32768"], ["256", "65535", "0"], ["300", "0", "1"]];
    let cases = [("float", unit, 1.0), ("float", bytes, 255.0), ("double", words, 65535.0)];
    let numbers = |c: [&str; 3], one: f32| c.map(|c| c.parse::<f32>().unwrap() / one);
    for format in ["ply", "obj", "off", "xyz"] {
        for (kind, stored, one) in cases {
            let scene = read_text(format, triangle(format, kind, &stored)).unwrap();
            let wanted = shown(&stored.map(|c| numbers(c, one)));
            assert_near(&kd(&scene), &wanted, 1e-6, &format!("{format} of {one}"));
            assert_eq!(warnings(&scene), "", "{format}");
        }
    }
    for (kind, stored, one) in [
        ("int", bytes, 255.0),
        ("uint", words, 65535.0),
        ("short", bytes, 255.0),
        ("ushort", bytes, 255.0),
        ("ushort", words, 65535.0),
        ("uchar", bytes, 255.0),
        // Bytes are bytes, however dark.
        ("uchar", [["0", "1", "1"]; 3], 255.0),
    ] {
        let scene = read_text("ply", triangle("ply", kind, &stored)).unwrap();
        assert_near(&kd(&scene), &shown(&stored.map(|c| numbers(c, one))), 1e-6, kind);
    }
}

/// The first rows are dark; only the last one tells that white is 255, or 65535.
#[test]
fn what_is_white_is_decided_by_the_whole_file() {
    const ROWS: usize = 100_000;
    for (last, one) in [("255 255 255", 255.0), ("65535 0 300", 65535.0), ("1 1 1", 1.0)] {
        let row = |i: usize| if i + 1 < ROWS { "1 0 1" } else { last };
        let mut cloud = String::new();
        let mut obj = String::new();
        for i in 0..ROWS {
            cloud.push_str(&format!("{i} 0 0 {}\n", row(i)));
            obj.push_str(&format!("v {i} 0 0 {}\n", row(i)));
        }
        obj.push_str("f 1 2 3\np 1\n");
        let first = Rgb::new(srgb_decode(1.0 / one), 0.0, srgb_decode(1.0 / one));
        let of_cloud = kd(&read_text("xyz", cloud).unwrap());
        assert_near(&of_cloud[..1], &[first], 1e-7, last);
        let of_obj = kd(&read_text("obj", obj).unwrap());
        assert_near(&of_obj[..1], &[first], 1e-7, last);
    }
}

/// A LAS file of version 1.2 and point format 2 with these colours. [LAS 1.4 R15]
fn las(colours: &[[u16; 3]]) -> Vec<u8> {
    let mut file = vec![0u8; 227];
    file[..4].copy_from_slice(b"LASF");
    (file[24], file[25], file[104]) = (1, 2, 2);
    file[96..100].copy_from_slice(&227u32.to_le_bytes());
    file[105..107].copy_from_slice(&26u16.to_le_bytes());
    file[107..111].copy_from_slice(&(colours.len() as u32).to_le_bytes());
    for axis in 0..3 {
        file[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&0.01f64.to_le_bytes());
    }
    for (i, colour) in colours.iter().enumerate() {
        let mut record = [0u8; 26];
        record[..4].copy_from_slice(&(i as i32).to_le_bytes());
        for (channel, c) in colour.iter().enumerate() {
            record[20 + 2 * channel..22 + 2 * channel].copy_from_slice(&c.to_le_bytes());
        }
        file.extend(record);
    }
    file
}

#[test]
fn las_colours_are_16_bits_unless_none_is_above_255() {
    let mut dark = vec![[1, 2, 200]; 1000];
    let scene = read_text("las", las(&dark)).unwrap();
    assert_near(&kd(&scene)[..1], &shown(&[[1.0 / 255.0, 2.0 / 255.0, 200.0 / 255.0]]), 1e-7, "bytes");
    dark.push([0, 40000, 0]);
    let scene = read_text("las", las(&dark)).unwrap();
    assert_near(&kd(&scene)[..1], &shown(&[[1.0 / 65535.0, 2.0 / 65535.0, 200.0 / 65535.0]]), 1e-7, "words");
}

#[test]
fn vertices_without_a_colour_are_white_whatever_white_is() {
    let scene = read_text("obj", "v 0 0 0 128 0 0\nv 1 0 0\nv 0 1 0 0 0 255\nf 1 2 3\n").unwrap();
    assert_near(&kd(&scene), &shown(&[[128.0 / 255.0, 0.0, 0.0], [1.0; 3], [0.0, 0.0, 1.0]]), 1e-6, "obj");
}

/// Colours of every brightness, written and read through every format that stores them.
#[test]
fn colours_come_back_within_a_255th() {
    let folder = tempfile::tempdir().unwrap();
    let colour = |i: usize| Rgb::new(i as f32 / 299.0, (i * 7 % 300) as f32 / 299.0, 0.001 * i as f32);
    let mut original = SceneBuilder::default();
    original.add_material(bilux_scene::Spec::new("vertices", "phong").with("kd", 1.0f32));
    let mesh = Mesh {
        positions: (0..300).map(|i| bilux_math::Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect(),
        vertex_kd: (0..300).map(colour).collect(),
        triangles: (0..298).map(|i| [i, i + 1, i + 2]).collect(),
        ..Mesh::default()
    };
    original.objects.push(bilux_scene::Object::new("a", std::sync::Arc::new(mesh), 0));
    for (name, ascii) in [
        ("a.obj", false),
        ("a.ply", false),
        ("a.ply", true),
        ("a.off", false),
        ("a.glb", false),
        ("a.toml", false),
    ] {
        let path = folder.path().join(name);
        write(&path, &original, &WriteOptions { ascii }).unwrap();
        let back = read(&path, &ReadOptions::default()).unwrap();
        // Readers may order vertices by their use.
        let mesh = &back.objects[0].mesh;
        let wanted: Vec<Rgb> = mesh.positions.iter().map(|p| colour(p.x as usize)).collect();
        assert_near(&mesh.vertex_kd, &wanted, 1e-5, name);
        assert_eq!(mesh.positions.len(), 300, "{name}");
    }
}

/// Two triangles with an edge in common, each with a colour of its own.
#[test]
fn faces_of_ply_and_off_have_colours_of_their_own() {
    let ply = |vertex: &str, values: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{vertex}\
             element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n\
             property uchar blue\nend_header\n0 0 0{values}\n1 0 0{values}\n1 1 0{values}\n0 1 0{values}\n\
             3 0 1 2 220 30 51\n3 0 2 3 0 128 255\n"
        )
    };
    let off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 220 30 51\n3 0 2 3 0 128 255 255 # last\n";
    let unit =
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 0.862745 .117647 .2\n3 0 2 3 0 0.5019608 1 .5\n";
    let wanted = shown(&[[220.0 / 255.0, 30.0 / 255.0, 0.2], [0.0, 128.0 / 255.0, 1.0]]);
    for (format, text) in [("ply", &ply("", "")[..]), ("off", off), ("off", unit)] {
        let scene = read_text(format, text).unwrap();
        let mesh = &scene.objects[0].mesh;
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2, 6), "{format}: vertices are shared");
        for (triangle, wanted) in mesh.triangles.iter().zip(&wanted) {
            for corner in triangle {
                assert_near(&[mesh.vertex_kd[*corner as usize]], &[*wanted], 1e-6, format);
            }
        }
        // The colours are the reflectances.
        let kd =
            scene.materials[scene.objects[0].material].parameters.find("kd").map(|(value, _)| value.clone());
        assert_eq!(kd, Some(Value::from(1.0f32)));
        assert_eq!(warnings(&scene), "");
    }
    let both = ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", " 255 0 0");
    let scene = read_text("ply", both).unwrap();
    assert_near(&kd(&scene), &[Rgb::new(1.0, 0.0, 0.0); 4], 0.0, "both");
    let said = warnings(&scene);
    assert!(
        said.contains("more than the picture shows: colours of faces, since vertices have colours"),
        "{said}"
    );
    let indexed = read_text("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 7\n").unwrap();
    assert!(warnings(&indexed).contains("indices into a table"), "{}", warnings(&indexed));
    assert_eq!(kd(&indexed), []);
}

/// A binary STL of triangles with these two bytes each.
fn stl(header: &[u8], attributes: &[u16]) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file[..header.len()].copy_from_slice(header);
    file.extend((attributes.len() as u32).to_le_bytes());
    for attribute in attributes {
        let facet = [0f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.];
        file.extend(facet.into_iter().flat_map(f32::to_le_bytes));
        file.extend(attribute.to_le_bytes());
    }
    file
}

/// Red, green and blue of 5 bits with red in the lowest bits.
const fn packed(r: u16, g: u16, b: u16) -> u16 {
    r | g << 5 | b << 10
}

#[test]
fn stl_has_colours_by_both_conventions() {
    const VALID: u16 = 1 << 15;
    let of = |c: [u16; 3]| Rgb::from_array(c.map(|c| srgb_decode(f32::from(c) / 31.0)));
    let each = |scene: &SceneBuilder| kd(scene).chunks(3).map(|corners| corners[0]).collect::<Vec<_>>();
    // VisCAM: blue is lowest, the highest bit says that there is a colour.
    let scene =
        read_text("stl", stl(b"binary", &[VALID | packed(3, 2, 31), packed(1, 2, 3), VALID])).unwrap();
    assert_near(&each(&scene), &[of([31, 2, 3]), Rgb::WHITE, Rgb::BLACK], 1e-6, "viscam");
    assert_eq!(warnings(&scene), "");
    // Magics: red is lowest, the highest bit says that the triangle has the colour of the whole.
    let header = b"COLOR=\xff\x80\x00\xff";
    let scene = read_text("stl", stl(header, &[packed(3, 2, 31), VALID | packed(9, 9, 9)])).unwrap();
    let whole = shown(&[[1.0, 128.0 / 255.0, 0.0]])[0];
    assert_near(&each(&scene), &[of([3, 2, 31]), whole], 1e-6, "magics");
    assert_eq!(warnings(&scene), "");
    // Where no triangle has a colour of its own, all have that of the whole.
    let header = b"made by COLOR=\xff\x80\x00\x80,MATERIAL=\xff\x80\x00\xff\x00\x00\x00\xff\x00\x00\x00\xff";
    let scene = read_text("stl", stl(header, &[0, 0])).unwrap();
    assert_near(&each(&scene), &[whole; 2], 1e-6, "magics, whole");
    assert!(warnings(&scene).contains("the opacity and the material"), "{}", warnings(&scene));
    // Other data are no colours.
    let scene = read_text("stl", stl(b"binary", &[7, 7])).unwrap();
    assert_eq!((kd(&scene), warnings(&scene)), (Vec::new(), String::new()));
    assert!(scene.notes.iter().any(|note| note.message.contains("two bytes after each triangle")));
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let text =
        format!("solid a\ncolor 0.5 0 1\n{facet}color 1 1 0\n{facet}endsolid\nsolid b\n{facet}endsolid\n");
    let scene = read_text("stl", text).unwrap();
    assert_near(&each(&scene), &shown(&[[0.5, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0; 3]]), 1e-6, "text");
}

/// [Kerbl 2023]: colour 0.5 + C0 f_dc, scale and opacity through exp and the logistic function.
#[test]
fn gaussian_splats_are_balls_of_their_colour_size_and_opacity() {
    let mut names = String::new();
    for name in ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"] {
        names.push_str(&format!("property float {name}\n"));
    }
    (0..45).for_each(|i| names.push_str(&format!("property float f_rest_{i}\n")));
    for name in ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"] {
        names.push_str(&format!("property float {name}\n"));
    }
    let rest = "9 ".repeat(45);
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{names}end_header\n1 2 3 0 1 -5 {rest}2 -1 -2 -3 1 0 0 0\n\
         4 5 6 .5 -.5 9 {rest}-1 0 0 0 1 0 0 0\n"
    );
    let scene = read_text("ply", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    let dc = |f: f64| (0.5 + f / (2.0 * std::f64::consts::PI.sqrt())).clamp(0.0, 1.0) as f32;
    let wanted = shown(&[[dc(0.0), dc(1.0), dc(-5.0)], [dc(0.5), dc(-0.5), dc(9.0)]]);
    assert_near(&mesh.vertex_kd, &wanted, 1e-5, "splats");
    assert_eq!(mesh.points, [0, 1]);
    let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-5;
    assert!(near(mesh.point_widths[0], 2.0 * exp_f64(-2.0)) && near(mesh.point_widths[1], 2.0));
    assert!(near(mesh.vertex_opacity[0], 1.0 / (1.0 + exp_f64(-2.0))));
    assert!(near(mesh.vertex_opacity[1], 1.0 / (1.0 + exp_f64(1.0))));
    let said = warnings(&scene);
    assert!(said.contains("how Gaussian splats fade") && said.lines().count() == 1, "{said}");
    scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    let packed = "ply\nformat ascii 1.0\nelement vertex 1\nproperty uint packed_position\nend_header\n7\n";
    assert!(crate::refusal("ply", packed).contains("compressed Gaussian splats"));
}

/// A triangle in glTF with bytes as colours, each with an alpha. [glTF 2.0, 3.7.2.1]
fn gltf(material: &str, normalized: bool, colours: [[u8; 4]; 3]) -> SceneBuilder {
    let numbers = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
    let bytes = numbers.iter().flat_map(|x| x.to_le_bytes()).chain(colours.into_iter().flatten());
    let uri: String = bytes.map(|byte| format!("%{byte:02x}")).collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "extensionsUsed":["KHR_materials_unlit"],"materials":[{{{material}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":1}},"material":0}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5121,"normalized":{normalized},"count":3,"type":"VEC4"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":12}}],
        "buffers":[{{"byteLength":48,"uri":"data:application/octet-stream,{uri}"}}]}}"#
    );
    read_text("gltf", text).unwrap()
}

#[test]
fn colours_of_gltf_are_linear_tint_what_is_unlit_and_have_an_alpha() {
    let colours = [[255, 51, 0, 0], [0, 102, 255, 51], [255, 255, 255, 255]];
    let unit = |c: [u8; 4]| Rgb::new(f32::from(c[0]), f32::from(c[1]), f32::from(c[2])) * (1.0 / 255.0);
    let alphas = [0.0, 0.2, 1.0];
    for (material, emits, fades, threshold) in [
        (r#""doubleSided":true"#, false, false, None),
        (r#""extensions":{"KHR_materials_unlit":{}}"#, true, false, None),
        (r#""alphaMode":"BLEND""#, false, true, None),
        (r#""alphaMode":"MASK","alphaCutoff":0.25"#, false, true, Some(0.25)),
        (r#""alphaMode":"MASK","extensions":{"KHR_materials_unlit":{}}"#, true, true, Some(0.5)),
    ] {
        let scene = gltf(material, true, colours);
        let mesh = &scene.objects[0].mesh;
        assert_near(&mesh.vertex_kd, &colours.map(unit), 1e-6, material);
        assert_eq!((mesh.emission_by_kd, mesh.opacity_threshold), (emits, threshold), "{material}");
        let near = mesh.vertex_opacity.iter().zip(alphas).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near && mesh.vertex_opacity.len() == if fades { 3 } else { 0 }, "{material}");
        // With a threshold of its own, the material would round before the vertices have a say.
        let opacity = scene.materials[0].parameters.find("opacity").map(|(value, _)| value.clone());
        assert_eq!(opacity, fades.then(|| Value::from(1.0f32)), "{material}");
        assert!(!warnings(&scene).contains("alpha"), "{}", warnings(&scene));
        scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap();
    }
    // Opaque vertices need nothing.
    let opaque = gltf(r#""alphaMode":"BLEND""#, true, colours.map(|[r, g, b, _]| [r, g, b, 255]));
    assert!(opaque.objects[0].mesh.vertex_opacity.is_empty());
    let scene = gltf(r#""doubleSided":true"#, false, colours);
    assert_near(&kd(&scene), &colours.map(unit), 1e-6, "not normalised");
    assert!(warnings(&scene).contains("without 'normalized'"), "{}", warnings(&scene));
}

/// [Kerbl 2023], with plain colours in place of spherical harmonics.
#[test]
fn splats_may_have_plain_colours() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float opacity\n\
                property float scale_0\nproperty float scale_1\nproperty float scale_2\nproperty float rot_0\n\
                property float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n\
                0 0 0 255 51 0 0 -1 -1 -1 1 0 0 0\n";
    let scene = read_text("ply", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_near(&mesh.vertex_kd, &shown(&[[1.0, 0.2, 0.0]]), 1e-6, "plain");
    assert_eq!(mesh.vertex_opacity, [0.5]);
    assert!((f64::from(mesh.point_widths[0]) - 2.0 * exp_f64(-1.0)).abs() < 1e-6);
}

#[test]
fn each_face_of_a_ply_has_the_texture_of_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let colours = [("red.ppm", [255u8, 0, 0]), ("blue.ppm", [0, 0, 255])];
    for (name, texel) in colours {
        std::fs::write(folder.path().join(name), [b"P6\n1 1\n255\n", &texel[..]].concat()).unwrap();
    }
    let text = |property: &str, numbers: [&str; 4]| {
        let faces: Vec<String> = numbers.iter().map(|n| format!("3 0 1 2 6 0 0 1 0 0 1 {n}\n")).collect();
        format!(
            "ply\nformat ascii 1.0\ncomment TextureFile red.ppm\ncomment TextureFile blue.ppm\nelement vertex 3\n\
             property float x\nproperty float y\nproperty float z\nelement face 4\n\
             property list uchar int vertex_indices\nproperty list uchar float texcoord\n{property}end_header\n\
             0 0 0\n1 0 0\n0 1 0\n{}",
            faces.concat()
        )
    };
    let path = folder.path().join("a.ply");
    std::fs::write(&path, text("property int texnumber\n", ["1", "0", "1", "-1"])).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let of = |i: usize| {
        let spec = &scene.materials[scene.objects[i].material];
        match spec.parameters.find("kd").map(|(value, _)| value) {
            Some(Value::Texture(texture)) => Some(scene.textures[*texture].texel(0, 0)),
            _ => None,
        }
    };
    let counts: Vec<usize> = scene.objects.iter().map(|object| object.mesh.triangles.len()).collect();
    assert_eq!(counts, [1, 2, 1]);
    assert_eq!(of(0), Some(Rgb::new(1.0, 0.0, 0.0)));
    assert_eq!(of(1), Some(Rgb::new(0.0, 0.0, 1.0)));
    assert_eq!(of(2), None, "a face without a texture");
    std::fs::write(&path, text("", [""; 4])).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(scene.objects.len(), 1);
    assert!(warnings(&scene).contains("textures after the first"), "{}", warnings(&scene));
}

/// Flat splats, as of 2D Gaussian splatting, have two scales, whose geometric mean is the radius. Where no opacity is stated,
/// splats are opaque.
#[test]
fn splats_may_be_flat_and_need_no_opacity() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float scale_0\n\
                property float scale_1\nproperty float rot_0\nend_header\n0 0 0 0 0 0 -1 -3 1\n";
    let scene = read_text("ply", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    let width = f64::from(mesh.point_widths[0]);
    assert!((width - 2.0 * exp_f64(-2.0)).abs() < 1e-6, "{width}");
    assert!(mesh.vertex_opacity.is_empty(), "opaque");
}

/// `COLOR=` is the diffuse colour of the whole, also where `MATERIAL=`, whose first colour is diffuse too, says another.
#[test]
fn the_colour_of_a_magics_header_counts_before_its_material() {
    let header = b"MATERIAL=\x00\x00\xff\xff\x00\x00\x00\xff\x00\x00\x00\xff,COLOR=\xff\x80\x00\xff";
    let scene = read_text("stl", stl(header, &[0])).unwrap();
    assert_near(&kd(&scene), &[shown(&[[1.0, 128.0 / 255.0, 0.0]])[0]; 3], 1e-6, "both");
    let alone = read_text("stl", stl(&header[..21], &[0])).unwrap();
    assert_near(&kd(&alone), &[Rgb::new(0.0, 0.0, 1.0); 3], 1e-6, "the material alone");
}

/// A line is no face: the colours of the faces after it stay with them.
#[test]
fn colours_of_off_stay_with_their_faces_where_others_are_left_out() {
    let text = "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1 0 255 0\n3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
    let scene = read_text("off", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    let faces = mesh.triangles.iter().map(|triangle| mesh.vertex_kd[triangle[0] as usize]);
    assert_near(
        &faces.collect::<Vec<_>>(),
        &[Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 1.0)],
        1e-6,
        "red and blue",
    );
}

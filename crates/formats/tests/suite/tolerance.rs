//! Irregularities that all readers of text and of binary files put up with: byte order marks, UTF-16, padding, decimal
//! commas, wrong counts, and coordinates far from zero.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read};
use bilux_math::{DVec3, Vec3};
use bilux_scene::SceneBuilder;
use std::fs;

/// A triangle of a unit's side in each format of text. Its corners begin with `{a}`, `{b}` and `{c}`, three numbers each.
const TRIANGLES: [(&str, &str); 8] = [
    ("obj", "v {a}\nv {b}\nv {c}\nf 1 2 3\n"),
    (
        "ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{a}\n{b}\n{c}\n3 0 1 2\n",
    ),
    ("off", "OFF\n3 1 0\n{a}\n{b}\n{c}\n3 0 1 2\n"),
    (
        "stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\nendsolid\n",
    ),
    ("asc", "triangle\n{a} 0 0 1 0 0\n{b} 0 0 1 0 0\n{c} 0 0 1 0 0\n"),
    ("xyz", "{a}\n{b}\n{c}\n"),
    (
        "pbrt",
        "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ {a} {b} {c} ] \"integer indices\" [ 0 1 2 ]\n",
    ),
    (
        "gltf",
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[TRANSLATION]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#,
    ),
];

fn triangle(template: &str, corners: [&str; 3]) -> String {
    let [a, b, c] = corners;
    template.replace("{a}", a).replace("{b}", b).replace("{c}", c).replace("TRANSLATION", "0,0,0")
}

const UNIT: [&str; 3] = ["0 0 0", "1 0 0", "0 1 0"];

fn positions(scene: &SceneBuilder) -> Vec<Vec3> {
    let place = |p: &Vec3| scene.objects[0].motion.at(0.0).point(*p);
    scene.objects[0].mesh.positions.iter().map(place).collect()
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn every_format_of_text_may_have_a_byte_order_mark_or_be_utf_16() {
    let toml = ("toml", "[[model]]\nshape = \"quad\"\nu = [1, 0, 0]\nv = [0, 1, 0]\n");
    for (format, template) in TRIANGLES.into_iter().chain([toml]) {
        let text = triangle(template, UNIT);
        let plain = read_text(format, &text).unwrap();
        let (little, big) = (utf16(&text, u16::to_le_bytes), utf16(&text, u16::to_be_bytes));
        for (name, bytes) in [
            ("UTF-8", [b"\xef\xbb\xbf", text.as_bytes()].concat()),
            ("UTF-16, little", [b"\xff\xfe", &little[..]].concat()),
            ("UTF-16, big", [b"\xfe\xff", &big[..]].concat()),
            ("UTF-16 without a mark", little),
        ] {
            let scene = read_text(format, &bytes).unwrap_or_else(|error| panic!("{format}, {name}: {error}"));
            assert_eq!(positions(&scene), positions(&plain), "{format}, {name}");
            assert_eq!(warnings(&scene), warnings(&plain), "{format}, {name}");
            // The format is recognised too.
            let bare = bilux_formats::read_bytes(&bytes, "", None, "a", &ReadOptions::default());
            let is_recognised =
                bilux_formats::read_bytes(text.as_bytes(), "", None, "a", &ReadOptions::default());
            assert_eq!(bare.is_ok(), is_recognised.is_ok(), "{format}, {name}");
        }
    }
}

#[test]
fn files_beside_a_scene_may_be_marked_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let marked = |text: &str| [b"\xef\xbb\xbf", text.as_bytes()].concat();
    let of_m = |scene: &SceneBuilder, key: &str| {
        let spec = scene.materials.iter().find(|spec| spec.name == "m").expect("the material m");
        spec.colour(key)
    };
    let red = bilux_math::Rgb::new(0.8, 0.1, 0.1);
    fs::write(at("a.mtl"), marked("newmtl m\nKd 0.8 0.1 0.1\n")).unwrap();
    fs::write(at("a.obj"), marked("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")).unwrap();
    let scene = read(&at("a.obj"), &ReadOptions::default()).unwrap();
    assert_eq!((of_m(&scene, "kd"), warnings(&scene)), (Some(red), String::new()));
    let material = "[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = [0.8, 0.1, 0.1]\n";
    fs::write(at("m.toml"), marked(material)).unwrap();
    fs::write(at("a.toml"), "include = [\"m.toml\"]\n[[model]]\nshape = \"quad\"\nmaterial = \"m\"\n")
        .unwrap();
    assert_eq!(of_m(&read(&at("a.toml"), &ReadOptions::default()).unwrap(), "reflectance"), Some(red));
    let shape = "Shape \"sphere\"\n";
    fs::write(at("b.pbrt"), [b"\xff\xfe", &utf16(shape, u16::to_le_bytes)[..]].concat()).unwrap();
    fs::write(at("a.pbrt"), "WorldBegin\nInclude \"b.pbrt\"\n").unwrap();
    assert_eq!(read(&at("a.pbrt"), &ReadOptions::default()).unwrap().objects.len(), 1);
}

#[test]
fn decimal_commas_and_exponents_of_fortran_are_numbers() {
    let wanted = [Vec3::new(0.5, -0.25, 0.0), Vec3::new(1.5, 0.0, 20.0), Vec3::new(0.0, 1.25, 0.0)];
    for corners in
        [["0,5 -0,25 0", "1,5 0 2,0E1", "0 1,25 0"], ["0.5D0 -2.5d-01 0", "1.5 0 2D+1", "0 1.25 0"]]
    {
        for (format, template) in TRIANGLES.into_iter().filter(|(name, _)| !matches!(*name, "pbrt" | "gltf"))
        {
            let scene = read_text(format, triangle(template, corners));
            let scene = scene.unwrap_or_else(|error| panic!("{format}: {error}"));
            assert_eq!(positions(&scene), wanted, "{format}: {corners:?}");
            assert_eq!(warnings(&scene), "", "{format}");
        }
    }
    assert!(refusal("pbrt", "WorldBegin\nShape \"sphere\" \"float radius\" [ 1,5 ]\n").contains("1,5"));
}

#[test]
fn commas_of_xyz_separate_or_are_decimal_as_its_lines_show() {
    let points = |text: &str| positions(&read_text("xyz", text).unwrap());
    let wanted = [Vec3::new(0.5, 0.25, 1.0), Vec3::new(1.5, 0.25, 2.0)];
    for text in [
        "0,5;0,25;1,0;220;30;30\n1,5;0,25;2,0;220;30;30\n",
        "0,5 0,25 1\n1,5 0,25 2\n",
        "0,5\t0,25\t1,0\n1,5\t0,25\t2,0\n",
        "X;Y;Z\n0,5;0,25;1,0\n1,5;0,25;2,0\n",
        "0.5,0.25,1\n1.5,0.25,2\n",
        "0.5, 0.25, 1\n1.5, 0.25, 2\n",
        "X,Y,Z\n0.5,0.25,1.0\n1.5,0.25,2.0\n",
    ] {
        assert_eq!(points(text), wanted, "{text}");
    }
    // The first rows have no commas.
    let text = format!("{}0,5 0,25 1\n", "0 0 0\n".repeat(100));
    assert_eq!(points(&text).last(), Some(&wanted[0]));
    let coloured = read_text("xyz", "0,5;0,25;1,0;220;30;30\n1,5;0,25;2,0;220;30;30\n").unwrap();
    assert!(
        (coloured.objects[0].mesh.vertex_kd[0].r - bilux_math::colour::srgb_decode(220.0 / 255.0)).abs()
            < 1e-6
    );
}

/// Coordinates of a national grid, whose millimetres are beyond 32-bit floats.
#[test]
fn every_format_keeps_the_digits_of_coordinates_far_from_zero() {
    let corners = [
        "500123.251 4649777.502 200.003",
        "500124.251 4649777.502 200.003",
        "500123.251 4649778.502 200.003",
    ];
    let wide: Vec<DVec3> = corners
        .iter()
        .map(|c| {
            let numbers: Vec<f64> = c.split(' ').map(|word| word.parse().unwrap()).collect();
            DVec3::from_slice(&numbers)
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    for (format, template) in TRIANGLES.into_iter().filter(|(name, _)| *name != "pbrt") {
        let text = template.replace("TRANSLATION", "500123.251,4649777.502,200.003");
        let text = triangle(&text, corners);
        let path = folder.path().join(format!("far.{format}"));
        fs::write(&path, &text).unwrap();
        for scene in [read(&path, &ReadOptions::default()).unwrap(), read_text(format, &text).unwrap()] {
            assert_ne!(scene.origin, DVec3::ZERO, "{format}");
            for (p, wanted) in positions(&scene).iter().zip(&wide) {
                let off = (scene.origin + p.as_dvec3() - *wanted).length();
                // Half a unit in the last place of 200 in 32 bits.
                assert!(off < 1e-5, "{format}: off by {off}");
            }
        }
    }
}

/// Scanners write zeros where nothing came back; the first point decides nothing.
#[test]
fn a_cloud_keeps_its_digits_even_if_its_first_points_are_elsewhere() {
    let at = |i: usize| 500_000.001 + i as f64 * 0.002;
    let rows = |zeros: usize| -> String {
        let zeros = "0 0 0\n".repeat(zeros);
        zeros + &(0..100).map(|i| format!("{:.3} 4600000.125 30\n", at(i))).collect::<String>()
    };
    for zeros in [0, 1, 20] {
        let scene = read_text("xyz", rows(zeros)).unwrap();
        for (i, p) in positions(&scene).iter().skip(zeros).enumerate() {
            let off = (scene.origin + p.as_dvec3() - DVec3::new(at(i), 4_600_000.125, 30.0)).length();
            assert!(off < 1e-4, "after {zeros}: off by {off}");
        }
    }
}

fn binary_stl(header: &str, claimed: u32, triangles: usize) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header.as_bytes());
    bytes.extend(claimed.to_le_bytes());
    for _ in 0..triangles {
        let facet = [0f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.];
        bytes.extend(facet.into_iter().flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

#[test]
fn a_binary_stl_may_begin_with_solid_and_be_wrong_about_its_size() {
    let count = |bytes: &[u8]| {
        let scene = read_text("stl", bytes).unwrap_or_else(|error| panic!("{error}"));
        (scene.objects.iter().map(|o| o.mesh.triangles.len()).collect::<Vec<_>>(), warnings(&scene))
    };
    for header in ["solid part", "anything", "solid"] {
        let trailing = |more: &[u8]| [&binary_stl(header, 5, 5)[..], more].concat();
        assert_eq!(count(&trailing(b"")), (vec![5], String::new()));
        let (found, said) = count(&trailing(b"1234567"));
        assert!(found == [5] && said.contains("bytes after the last triangle"), "{found:?} {said}");
        for claimed in [0, 3, 7, u32::MAX] {
            let (found, said) = count(&binary_stl(header, claimed, 5));
            assert!(found == [5] && said.contains(&format!("says {claimed} triangles")), "{found:?} {said}");
        }
        // Several files in one.
        assert_eq!(count(&trailing(&binary_stl("solid b", 2, 2))), (vec![5, 2], String::new()));
        let message = refusal("stl", &binary_stl(header, 5, 5)[..84 + 4 * 50 + 20]);
        assert!(message.contains("says 5 triangles, but there are bytes for only 4"), "{message}");
    }
}

#[test]
fn marks_of_joined_files_are_blanks() {
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nend loop\nendfacet\n";
    let stl = format!("solid a\n{facet}endsolida\n\u{feff}solid b\n{facet}end solid b\n");
    assert_eq!(read_text("stl", stl).unwrap().objects.len(), 2);
    let obj = read_text("obj", "v 0 0 0\n\u{feff}v 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!((positions(&obj).len(), warnings(&obj)), (3, String::new()));
    let ply = triangle(TRIANGLES[1].1, UNIT).replace("end_header\n", "end_header\n\u{feff}");
    assert_eq!(positions(&read_text("ply", ply).unwrap()), [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn a_text_stl_may_begin_with_comments_and_lack_its_first_line() {
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    for text in [
        format!("; made by tool\nsolid cube\n{facet}endsolid cube\n"),
        format!("# a\n\n// b\nsolid UNITS=mm\n# c\n{facet}; d\nendsolid\n"),
        facet.to_owned(),
        format!("solid\u{e9}\u{e8}\n{facet}endsolid\n"),
        format!("solid {}\n{facet}endsolid\n\0\0\u{1a}", " ".repeat(2000)),
    ] {
        let scene = read_text("stl", &text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(scene.objects[0].mesh.triangles.len(), 1, "{text}");
        assert_eq!(warnings(&scene), "", "{text}");
    }
    let inches = format!("; a comment\nsolid part UNITS=inch\n{facet}endsolid\n");
    assert_eq!(read_text("stl", inches).unwrap().unit, 0.0254);
}

/// The first coordinate of the body begins with the byte 0a.
#[test]
fn a_ply_header_of_crs_ends_before_a_body_that_begins_with_a_line_feed() {
    let x = f32::from_le_bytes([0x0a, 0, 0, 0x3f]);
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mut body: Vec<u8> =
        [x, 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes).collect();
    body.push(3);
    body.extend([0i32, 1, 2].into_iter().flat_map(i32::to_le_bytes));
    for end in ["\r", "\n", "\r\n"] {
        let bytes = [header.replace('\n', end).as_bytes(), &body[..]].concat();
        let scene = read_text("ply", bytes).unwrap_or_else(|error| panic!("{end:?}: {error}"));
        assert_eq!(positions(&scene)[0], Vec3::new(x, 0.0, 0.0), "{end:?}");
    }
}

#[test]
fn the_json_of_a_glb_may_be_padded_with_zeros() {
    let json = triangle(TRIANGLES[7].1, UNIT).into_bytes();
    for (before, padding) in
        [(&b""[..], &b"\0"[..]), (b"", b" "), (b"\xef\xbb\xbf", b"\0\0"), (b"", b"\r\n\x1a\0")]
    {
        let mut chunk = [before, &json, padding].concat();
        while chunk.len() % 4 != 0 {
            chunk.push(padding[padding.len() - 1]);
        }
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((20 + chunk.len() as u32).to_le_bytes());
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(&chunk);
        let scene = read_text("glb", &file).unwrap_or_else(|error| panic!("{padding:?}: {error}"));
        assert_eq!(positions(&scene)[1], Vec3::X);
        let text = [&json, padding].concat();
        assert!(read_text("gltf", text).is_ok(), "{padding:?}");
    }
}

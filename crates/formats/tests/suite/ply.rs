//! PLY files as exporters write them.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read_bytes};
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec2, Vec3};

const BODY: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

fn header(format: &str, extra: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment hello\nobj_info 7\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{extra}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

/// The square in binary, in either byte order.
fn binary(big: bool) -> Vec<u8> {
    let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }, "").into_bytes();
    for number in [0f32, 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.] {
        bytes.extend(if big { number.to_be_bytes() } else { number.to_le_bytes() });
    }
    bytes.push(4);
    for index in 0..4i32 {
        bytes.extend(if big { index.to_be_bytes() } else { index.to_le_bytes() });
    }
    bytes
}

#[test]
fn text_and_both_byte_orders_and_line_ends_are_alike() {
    let text = header("ascii", "") + BODY;
    let mesh = read_text("ply", &text).unwrap().objects[0].mesh.clone();
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let crlf = binary(false).windows(1).take(header("binary_little_endian", "").len()).fold(
        Vec::new(),
        |mut all: Vec<u8>, b| {
            all.extend(if b == b"\n" { &b"\r\n"[..] } else { b });
            all
        },
    );
    let crlf = [crlf, binary(false)[header("binary_little_endian", "").len()..].to_vec()].concat();
    for bytes in [
        text.replace('\n', "\r\n").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        binary(false),
        binary(true),
        crlf,
    ] {
        assert_eq!(read_text("ply", bytes).unwrap().objects[0].mesh, mesh);
    }
}

#[test]
fn normals_uvs_and_colours_by_all_their_names() {
    let extra = "property float nx\nproperty float ny\nproperty float nz\nproperty double texture_u\nproperty float32 texture_v\nproperty uint8 red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty list uchar int junk\n";
    let rows = "0 0 0 0 0 1 .5 .25 255 128 0 9 2 7 7\n1 0 0 0 0 1 0 0 0 0 0 9 0\n1 1 0 0 0 1 0 0 0 0 0 9 0\n0 1 0 0 0 1 0 0 0 0 0 9 0\n";
    let scene = read_text("ply", format!("{}{rows}3 0 1 2\n", header("ascii", extra))).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!((mesh.normals[0], mesh.uvs[0]), (Vec3::Z, Vec2::new(0.5, 0.25)));
    assert_eq!(mesh.vertex_kd[0], Rgb::new(1.0, srgb_decode(128.0 / 255.0), 0.0));
    assert_eq!(warnings(&scene), "");
    let floats = header("ascii", "property float red\nproperty float green\nproperty float blue\n");
    let scene =
        read_text("ply", format!("{floats}0 0 0 .5 .5 .5\n1 0 0 1 1 1\n1 1 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n"))
            .unwrap();
    assert_eq!(scene.objects[0].mesh.vertex_kd[0], Rgb::grey(srgb_decode(0.5)));
}

#[test]
fn uvs_of_corners_and_strips_of_triangles() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 .5 .5 1 1 0 1\n";
    let mesh = read_text("ply", text).unwrap().objects[0].mesh.clone();
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.uvs[mesh.triangles[1][0] as usize], Vec2::splat(0.5));
    let strips = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n";
    let scene = read_text("ply", strips).unwrap();
    assert_eq!(scene.objects[0].mesh.triangles, [[0, 1, 2], [2, 1, 3], [0, 1, 2]]);
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let good = header("ascii", "") + BODY;
    let cases = [
        ("plx\n".to_owned(), "scene.ply:1:1: a PLY file begins with"),
        ("ply\nformat ascii 1.0\n".to_owned(), "scene.ply:3:1: the file ends within its header"),
        (good.replace("ascii", "utf8"), "scene.ply:2:8: 'utf8' is not a PLY format"),
        (good.replace("float x", "real x"), "scene.ply:6:10: 'real' is not a PLY type"),
        (good.replace("vertex 4", "vertex many"), "scene.ply:5:1: an element has a name and a count"),
        (good.replace("element vertex 4\n", ""), "a property belongs to an element"),
        (good.replace("property float z", "property float w"), "no properties x, y and z"),
        (good.replace("vertex_indices", "corners"), "no list 'vertex_indices'"),
        (
            good.replace("0 1 2 3", "0 1 2 4"),
            "scene.ply:16:1: this face refers to vertex 4, but the file has only 4, counted from 0",
        ),
        (good.replace("0 1 2 3", "0 1 2 -1"), "scene.ply:16:1: this face refers to vertex -1"),
        (good.replace("1 1 0", "1 one 0"), "scene.ply:14:3: 'one' is not a number"),
        (
            good.replace("vertex 4", "vertex 4000000000"),
            "scene.ply:5:1: the header says 4000000000 of the element 'vertex'",
        ),
        (good.replace("4 0 1 2 3", "4 0 1 2"), "the file ends before everything"),
        (good.replace("4 0 1 2 3", "4000000000 0 1 2"), "the file ends before everything"),
        (good.replace("element", "elements"), "'elements' is not a keyword of a PLY header"),
    ];
    for (text, part) in cases {
        let message = refusal("ply", &text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
    let whole = binary(false);
    for length in 0..whole.len() {
        assert!(read_text("ply", &whole[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn a_missing_texture_is_hard_to_overlook() {
    let text = "ply\nformat ascii 1.0\ncomment TextureFile gone.png\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ply");
    std::fs::write(&path, text).unwrap();
    let scene = bilux_formats::read(&path, &ReadOptions::default()).unwrap();
    let said = warnings(&scene);
    assert!(
        said.contains("scene.ply:3:1: a texture is replaced by a magenta checker: there is no file"),
        "{said}"
    );
    assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(1.0, 0.0, 1.0));
    let kd = scene.materials[scene.objects[0].material].parameters.find("kd");
    assert_eq!(kd.map(|(value, _)| value), Some(&bilux_scene::Value::Texture(0)));
}

#[test]
fn headers_that_promise_the_world_take_nothing() {
    let little = ReadOptions { max_memory: 100_000, ..ReadOptions::default() };
    for text in [
        "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nend_header\n",
        "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty float x\nend_header\n",
        "ply\nformat binary_little_endian 1.0\nelement face 3\nproperty list uint int vertex_indices\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}\u{7f}",
    ] {
        assert!(read_bytes(text.as_bytes(), "ply", None, "x.ply", &little).is_err());
    }
}

/// Vertices with normals, the last of them unused, and a triangle, a square and a line; `extra` adds a property to
/// faces.
fn with_normals(encoding: &str, extra: bool) -> Vec<u8> {
    let property = if extra { "property uchar flags\n" } else { "" };
    let mut file = format!(
        "ply\nformat {encoding} 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n\
         element face 3\nproperty list uchar int vertex_indices\n{property}end_header\n"
    )
    .into_bytes();
    let (big, text) = (encoding.contains("big"), encoding == "ascii");
    let word = |file: &mut Vec<u8>, number: f32, is_index: bool| match (text, is_index) {
        (true, _) => file.extend(format!("{number} ").bytes()),
        (_, true) => {
            let bytes = (number as i32).to_le_bytes();
            file.extend(if big { [bytes[3], bytes[2], bytes[1], bytes[0]] } else { bytes });
        }
        _ => {
            let bytes = number.to_le_bytes();
            file.extend(if big { [bytes[3], bytes[2], bytes[1], bytes[0]] } else { bytes });
        }
    };
    for i in 0..6 {
        let corner = [(i % 2) as f32, (i / 2) as f32, 0.25];
        corner.iter().chain(&[0.0, 0.0, 1.0, 0.5, i as f32]).for_each(|&x| word(&mut file, x, false));
        file.extend(if text { &b"\n"[..] } else { b"" });
    }
    for face in [&[1.0f32, 3.0, 2.0][..], &[0.0, 1.0, 3.0, 2.0], &[0.0, 1.0]] {
        let count = face.len() as u8;
        file.extend(if text { format!("{count} ").into_bytes() } else { vec![count] });
        face.iter().for_each(|&index| word(&mut file, index, true));
        file.extend(if extra { if text { &b"7 "[..] } else { &[7] } } else { b"" });
        file.extend(if text { &b"\n"[..] } else { b"" });
    }
    file
}

#[test]
fn triangles_are_the_same_whether_anything_was_welded_or_not() {
    let corners = |bytes: &[u8]| {
        let scene = crate::read_text("ply", bytes).unwrap_or_else(|error| panic!("{error}"));
        let mesh = &scene.objects[0].mesh;
        assert_eq!(
            (mesh.positions.len(), mesh.normals.len(), mesh.uvs.len()),
            (4, 4, 4),
            "what no face has is left out"
        );
        assert!(crate::warnings(&scene).contains("fewer than 3 corners"), "{}", crate::warnings(&scene));
        let of = |corner: u32| {
            let corner = corner as usize;
            format!("{} {} {}", mesh.positions[corner], mesh.normals[corner], mesh.uvs[corner])
        };
        mesh.triangles.iter().map(|triangle| triangle.map(of)).collect::<Vec<_>>()
    };
    let welded = corners(&with_normals("ascii", true));
    assert_eq!(welded.len(), 3);
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for extra in [false, true] {
            assert_eq!(corners(&with_normals(encoding, extra)), welded, "{encoding} {extra}");
        }
    }
}

#[test]
fn faces_of_vertices_that_are_not_there_are_refused_in_every_form() {
    for encoding in ["binary_little_endian", "binary_big_endian"] {
        let mut file = with_normals(encoding, false);
        let first = file.len() - (1 + 8) - (1 + 16) - 12;
        for bytes in [[0x7f; 4], [0xff; 4]] {
            file[first..first + 4].copy_from_slice(&bytes);
            let message = crate::refusal("ply", &file);
            assert!(message.contains("this face refers to vertex"), "{message}");
        }
    }
}

/// Writers put comments after the header too; a line of one holds no number.
#[test]
fn comments_between_rows_are_no_numbers() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\ncomment 9 9 9\n0 0 0\ncomment a b\n4 0 0\n0 2 0\n\
                obj_info 1\n3 0 1 2\ncomment end\n";
    let scene = crate::read_text("ply", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!(mesh.bounds().max, bilux_math::Vec3::new(4.0, 2.0, 0.0));
    assert_eq!((mesh.triangles.len(), crate::warnings(&scene)), (1, String::new()));
}

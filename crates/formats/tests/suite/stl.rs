//! STL, as text and as binary.

use crate::{read_text, refusal, warnings};
use bilux_math::Vec3;

const FACET: &str =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

fn binary(header: &str, claimed: u32, triangles: usize) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header.as_bytes());
    bytes.extend(claimed.to_le_bytes());
    for _ in 0..triangles {
        bytes.extend(
            [0f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes),
        );
        bytes.extend([7, 7]);
    }
    bytes
}

#[test]
fn text_and_binary_are_alike_even_where_binary_begins_with_solid() {
    let text = read_text("stl", format!("solid a name\n{FACET}endsolid a name\n")).unwrap();
    assert_eq!(text.objects[0].name, "a name");
    assert_eq!(text.objects[0].mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    for header in ["solid", "anything"] {
        let scene = read_text("stl", binary(header, 1, 1)).unwrap();
        assert_eq!(scene.objects[0].mesh.positions, text.objects[0].mesh.positions);
        assert_eq!(warnings(&scene), "");
    }
    let loud = format!("SOLID\r\n{}ENDSOLID", FACET.to_uppercase().replace('\n', "\r\n"));
    assert_eq!(read_text("stl", loud).unwrap().objects[0].mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn each_solid_is_an_object_and_empty_ones_are_none() {
    let scene = read_text(
        "stl",
        format!("solid a\n{FACET}{FACET}endsolid\nsolid nothing\nendsolid\nsolid b\n{FACET}endsolid"),
    )
    .unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| &*o.name).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!(scene.objects[0].mesh.triangles.len(), 2);
}

#[test]
fn false_counts_are_reported() {
    let cut_off = &binary("x", 4_000_000_000, 2)[..84 + 99];
    let message = refusal("stl", cut_off);
    assert!(message.contains("says 4000000000 triangles, but there are bytes for only 1"), "{message}");
    let scene = read_text("stl", binary("x", 1, 2)).unwrap();
    assert_eq!(scene.objects[0].mesh.triangles.len(), 2);
    assert!(warnings(&scene).contains("says 1 triangles, but the file has 2"), "{}", warnings(&scene));
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let cases = [
        ("solid x\nendsolid\n".to_owned(), "it contains no triangles"),
        (
            format!("solid x\n{FACET}facet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
            "scene.stl:9:1: the file ends within this facet",
        ),
        (format!("solid x\n{}", FACET.replace("1 0 0", "1 0")), "scene.stl:5:13: a vertex has three numbers"),
        (format!("solid x\n{}", FACET.replace("1 0 0", "1 O 0")), "scene.stl:5:12: 'O' is not a number"),
        (
            format!("solid x\n{}", FACET.replace("  vertex 1 0 0\n", "")),
            "scene.stl:7:1: a facet with 2 corners",
        ),
        ("solid x\nv 0 0 0\n".to_owned(), "scene.stl:2:1: 'v' is not expected here"),
        ("\u{1}\u{2}".to_owned(), "a binary STL file has 84 bytes"),
    ];
    for (text, part) in cases {
        let message = refusal("stl", &text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
}

#[test]
fn lengths_are_millimetres_unless_the_first_line_says_otherwise() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    for (name, unit) in [
        ("part", 0.001),
        ("part UNITS=inch", 0.0254),
        ("unit: cm", 0.01),
        ("Units = m", 1.0),
        ("unity", 0.001),
    ] {
        let scene = crate::read_text("stl", format!("solid {name}\n{facet}")).unwrap();
        assert_eq!(scene.unit, unit, "{name}");
        assert_eq!(scene.up, bilux_scene::UpHint::Usually(bilux_scene::Axis::Z));
    }
}

//! OFF files as exporters write them.

use crate::{read_text, refusal, round_trips, warnings};
use bilux_formats::{ReadOptions, read, write};
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec2, Vec3};

const SQUARE: &str = "OFF\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

#[test]
fn every_spelling_of_a_square_is_that_square() {
    let mesh = read_text("off", SQUARE).unwrap().objects[0].mesh.clone();
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let spellings = [
        SQUARE.replace('\n', "\r\n"),
        SQUARE.replace('\n', "\r"),
        SQUARE.replace("OFF\n", "# made by hand\n\nOFF # of one face\n"),
        SQUARE.replace("OFF\n4 1 4", "OFF 4 1 4"),
        // As in a well-known collection of shapes.
        SQUARE.replace("OFF\n4 1 4", "OFF4 1 4"),
        SQUARE.replace("4 1 4", "4 1"),
        // As in the data of libigl's tutorial.
        SQUARE.replace("4 0 1 2 3", "4 0\n1 # here\n\n2\n3"),
        SQUARE.trim_end().replace("0 1 0\n", "\n\t0  1 0 # the last\n\n"),
    ];
    for text in spellings {
        let scene = read_text("off", &text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!((&scene.objects[0].mesh, warnings(&scene)), (&mesh, String::new()), "{text:?}");
    }
    assert_eq!(read_text("", SQUARE).unwrap().objects[0].mesh, mesh, "by its first bytes");
}

#[test]
fn normals_colours_and_uvs_come_in_this_order() {
    let text = "STCNOFF\n3 1 0\n0 0 0  0 0 1  1 0.5 0  .25 .75\n1 0 0  0 0 1  0 0 0 1  0 0\n0 1 0  0 0 1  0 0 0  0 0\n3 0 1 2\n";
    let scene = read_text("off", text).unwrap();
    let mesh = &scene.objects[0].mesh;
    assert_eq!((mesh.normals[0], mesh.uvs[0]), (Vec3::Z, Vec2::new(0.25, 0.75)));
    assert_eq!(mesh.vertex_kd[0], Rgb::new(1.0, srgb_decode(0.5), 0.0));
    assert_eq!(warnings(&scene), "");
    let bytes = "COFF\n3 1 0\n0 0 0  255 128 0 255\n1 0 0  1 1 1 255\n0 1 0  0 0 0 255\n3 0 1 2\n";
    let scene = read_text("off", bytes).unwrap();
    assert_eq!(scene.objects[0].mesh.vertex_kd[0], Rgb::new(1.0, srgb_decode(128.0 / 255.0), 0.0), "sRGB");
}

#[test]
fn diagnostics_that_can_be_drawn_give_a_warning() {
    let cases = [
        (
            SQUARE.replace("4 0 1 2 3", "4 0 1 2 3 red"),
            "scene.off:7:1: a face has more than vertices and a colour",
        ),
        (SQUARE.replace("1 1 0", "1 1 0 9 9"), "scene.off:5:1: a vertex has more numbers"),
        (SQUARE.replace("4 1 4", "4 2 4") + "2 0 1\n", "scene.off:8:1: a face has fewer than 3 corners"),
        (SQUARE.replace("1 1 0", "1 nan 0"), "scene.off:5:1: a vertex has numbers that are infinite"),
    ];
    for (text, part) in cases {
        let reported = warnings(&read_text("off", &text).unwrap());
        assert!(reported.contains(part), "{text:?}: {reported}");
    }
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let cases = [
        (SQUARE.replace("OFF", "OBJ"), "scene.off:1:1: 'OBJ' is not expected here: an OFF file begins with"),
        (SQUARE.replace("OFF", "4OFF"), "scene.off:1:1: '4OFF' has other columns or dimensions"),
        (SQUARE.replace("OFF\n", "OFF BINARY\n"), "scene.off:1:1: this OFF file is binary"),
        (SQUARE.replace("4 1 4", "4"), "scene.off:2:1: this line gives the numbers of vertices"),
        (SQUARE.replace("4 1 4", "-4 1 4"), "scene.off:2:1: this line gives the numbers of vertices"),
        (SQUARE.replace("4 1 4", "4000000000 1 4"), "the file ends before all of its vertices"),
        (SQUARE.replace("4 1 4", "5000000000 1 4"), "scene.off:2:1: there are more than 4 billion"),
        (SQUARE.replace("4 1 4", "4 7000000000 4"), "the file ends before all of its faces: it was cut off"),
        (SQUARE.replace("4 1 4", "4 0 0"), "it contains no faces"),
        (SQUARE.replace("1 1 0", "1 one 0"), "scene.off:5:3: 'one' is not expected here"),
        (SQUARE.replace("1 1 0", "1 1"), "scene.off:5:1: a vertex has 3 numbers here, but this line has 2"),
        (SQUARE.replace("2 3\n", "2 4\n"), "scene.off:7:1: this face refers to vertex"),
        (SQUARE.replace("2 3\n", "2 -1\n"), "scene.off:7:9: '-1' is not expected here"),
        (SQUARE.replace("2 3\n", "2\n"), "the file ends before all of its faces: it was cut off"),
        (SQUARE.replace("4 0 1", "4000000000 0 1"), "the file ends before all of its faces: it was cut off"),
        (SQUARE.replace("4 0 1 2 3", ""), "the file ends before all of its faces: it was cut off"),
    ];
    for (text, part) in cases {
        let message = refusal("off", &text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
    for length in 0..SQUARE.len() - "2 3\n".len() {
        assert!(read_text("off", &SQUARE[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn supported_content_round_trips() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.off");
    let coloured = "STCNOFF\n3 1 0\n.1 .2 .3 0 0 1 .1 .2 .3 .4 .5\n1 0 0 0 .6 .8 .7 .8 .9 0 0\n0 1 0 0 0 1 0 0 0 0 0\n3 0 1 2\n";
    // Flat: two faces that meet at a small angle, which would otherwise be smoothed.
    let flat = "OFF\n# shading flat\n4 2 0\n0 0 0\n1 0 0\n1 1 .1\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    for text in [coloured, flat] {
        let original = read_text("off", text).unwrap();
        assert_eq!(write(&path, &original, &Default::default()).unwrap(), []);
        let back = read(&path, &ReadOptions::default()).unwrap();
        let corners = |scene: &bilux_scene::SceneBuilder| round_trips::corners(&scene.objects[0].mesh);
        assert_eq!(corners(&original), corners(&back));
        round_trips::assert_same_colours(&original.objects[0].mesh, &back.objects[0].mesh);
    }
    assert!(read_text("off", flat).unwrap().objects[0].mesh.normals.is_empty());
}

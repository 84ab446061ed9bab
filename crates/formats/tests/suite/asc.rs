//! Every variant of `.asc`.

use crate::{read_text, refusal, warnings};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Value;

const CORNERS: [&str; 3] = ["0 0 0 0 0 1 0 0", "1 0 0 0 0 2 1 0", "-0 1e0 0 0 0 -1 0 1"];

fn triangle(keyword: &str, separator: &str, end: &str) -> String {
    let lines = CORNERS.map(|c| c.replace(' ', separator));
    format!("{keyword}{end}{}{end}", lines.join(end))
}

#[test]
fn every_line_end_keyword_and_layout_gives_the_same_triangle() {
    let expected = read_text("asc", triangle("triangle", " ", "\n")).unwrap();
    let mesh = &expected.objects[0].mesh;
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert!(mesh.positions[2].x.is_sign_negative());
    assert_eq!(mesh.normals[1], Vec3::new(0.0, 0.0, 2.0));
    assert_eq!(mesh.uvs[1], Vec2::X);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    let long = format!("triangle{}comment", "-".repeat(700));
    let mut variants = vec![
        triangle("triangle", " ", "\n").trim_end().to_owned(),
        format!("{}  \t", triangle("triangle", " ", "\n").trim_end()),
        format!("\n\n# a comment\n{}", triangle("x", "   ", "\n\n\n")),
        format!("triangle {}\n", CORNERS.join(" ")),
        format!("triangle\n{}\n", CORNERS.join(" ")),
        format!("triangle\n{}\n", CORNERS.join(" ").replace(' ', "\n")),
        format!("triangle 12 of the lid\n{}\n", CORNERS.join("\n")),
        format!("object\nobject lid\n{}", triangle("triangle", " ", "\n")).replace("object lid\n", ""),
    ];
    for end in ["\n", "\r", "\r\n", "\n\r"] {
        for keyword in ["triangle", "triangle1", &long, "5", "triangle two words", "dreieck-ä"] {
            variants.push(triangle(keyword, "\t", end));
        }
    }
    for text in variants {
        let scene = read_text("asc", &text).unwrap_or_else(|e| panic!("{text:?}: {e}"));
        assert_eq!(scene.objects.len(), 1, "{text:?}");
        let found = &scene.objects[0].mesh;
        assert_eq!(
            (&found.positions, &found.normals, &found.uvs),
            (&mesh.positions, &mesh.normals, &mesh.uvs),
            "{text:?}"
        );
        assert!(found.positions[2].x.is_sign_negative());
    }
}

#[test]
fn object_and_config_lines_make_groups_with_materials() {
    let text = format!(
        "object lid\nconfig .8 .6 .4 .2 .9 .5 .75\n{t}object ---a comment\nconfig .8 .6 .4 .2 .9 .5 .75\n{t}object\n{t}",
        t = triangle("triangle", " ", "\n")
    );
    let scene = read_text("asc", text).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| &*o.name).collect();
    assert_eq!(names, ["lid", "", ""]);
    let materials: Vec<usize> = scene.objects.iter().map(|o| o.material).collect();
    assert_eq!(materials, [0, 0, 1]);
    let parameters = &scene.materials[0].parameters;
    assert_eq!(parameters.find("kd").unwrap().0, &Value::triple([0.2, 0.9, 0.5]));
    assert_eq!(parameters.find("ks").unwrap().0, &Value::triple([0.8, 0.6, 0.4]));
    assert_eq!(parameters.find("reflectivity").unwrap().0, &Value::Number(0.75));
    assert_eq!(parameters.find("kd").unwrap().1.line, 2);
    assert_eq!(warnings(&scene), "");
}

#[test]
fn vertices_may_bring_kd_and_ks() {
    let coloured = CORNERS.map(|c| format!("{c} .1 .2 .3 .4 .5 .6")).join("\n");
    let text = format!("triangle\n{coloured}\n{}", triangle("triangle", " ", "\n"));
    let scene = read_text("asc", text).unwrap();
    assert_eq!(scene.objects.len(), 2, "a mesh has colours at all its vertices or at none");
    assert_eq!(scene.objects[0].mesh.vertex_kd, [Rgb::new(0.1, 0.2, 0.3); 3]);
    assert_eq!(scene.objects[0].mesh.vertex_ks, [Rgb::new(0.4, 0.5, 0.6); 3]);
    assert!(scene.objects[1].mesh.vertex_kd.is_empty());
    let material = &scene.materials[scene.objects[0].material];
    assert_eq!(material.parameters.find("kd").unwrap().0, &Value::Number(1.0));
}

#[test]
fn a_ninth_number_is_left_out_with_a_warning() {
    let scene = read_text("asc", format!("triangle\n{} 7\n", CORNERS.join(" 7\n"))).unwrap();
    assert_eq!(scene.objects[0].mesh.uvs[1], Vec2::X);
    assert_eq!(warnings(&scene), "scene.asc:2:1: a ninth number per vertex is ignored");
}

#[test]
fn nans_are_kept_and_counted() {
    let text = triangle("triangle", " ", "\n").replace("1e0", "nan").repeat(3);
    let scene = read_text("asc", text).unwrap();
    assert!(scene.objects[0].mesh.positions[2].y.is_nan());
    assert!(warnings(&scene).contains("(3 times; this is the first)"), "{}", warnings(&scene));
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let good = triangle("triangle", " ", "\n");
    let cases = [
        (String::new(), "the file is empty"),
        ("\n\n".to_owned(), "no triangles"),
        ("\0\u{1}binary\u{2}".to_owned(), "no triangles"),
        (format!("{good}triangle\n"), "scene.asc:5:1: the file ends after this line"),
        (
            format!("{good}triangle\n0 0 0 0 0 1 0 0\n"),
            "scene.asc:7:1: the file ends after 8 of a triangle's 24 numbers",
        ),
        (
            format!("{good}triangle\n0 0 0 0 0 1 0 0\n0 0 0 0"),
            "scene.asc:7:1: this vertex has 4 numbers, but 8",
        ),
        (good.replace("1 0 0 0 0 2", "1 0 x 0 0 2"), "scene.asc:3:5: 'x' is not a number"),
        (good.replace("1 0 0 0 0 2 1 0", "1 0 0 0 0 2 1"), "scene.asc:3:1: this vertex has 7 numbers"),
        (good.replace("0 0 0 0 0 1 0 0", "0 0 0 0 0 1 0 0 0 0"), "scene.asc:2:1: a vertex has 8 numbers"),
        (format!("{good}0 0 0 0 0 1 0 0\n"), "scene.asc:5:1: a triangle begins with a line of one word"),
        (format!("object\nconfig 1 2 3\n{good}"), "scene.asc:2:1: 'config' takes 7 numbers"),
    ];
    for (text, part) in cases {
        let message = refusal("asc", &text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
}

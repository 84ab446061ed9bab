//! STEP files: small ones with areas and volumes that formulas give, and hostile ones.

use crate::step_truth::{Measures, measures};
use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read_bytes};
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_scene::SceneBuilder;
use std::f64::consts::PI;
use std::path::Path;

/// A seed of the fuzz target, or a solid with many triangles from the folder beside this file.
fn seed(name: &str) -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let seed = std::fs::read_to_string(here.join("../../fuzz/corpus/scene_step").join(name));
    seed.unwrap_or_else(|_| std::fs::read_to_string(here.join("tests/suite/step").join(name)).unwrap())
}

fn scene(text: &str) -> SceneBuilder {
    read_text("step", text).unwrap_or_else(|error| panic!("{error}"))
}

/// The length of a unit, and what the scene measures in millimetres.
fn measured(name: &str) -> Measures {
    let scene = scene(&seed(name));
    assert_eq!((warnings(&scene), scene.unit), (String::new(), 1e-3), "{name}");
    measures(&scene)
}

/// The same within a hundredth: chords are shorter than arcs.
#[track_caller]
fn assert_near(here: f64, there: f64) {
    assert!((here / there - 1.0).abs() < 0.01, "{here}, not {there}");
}

#[test]
fn solids_have_the_areas_and_volumes_that_formulas_give() {
    let drilled = (600.0 - 8.0 * PI + 40.0 * PI, 1000.0 - 40.0 * PI);
    for (name, (area, volume)) in [
        ("cube_hole.step", drilled),
        ("cube_hole_seam.step", drilled),
        ("sphere.step", (100.0 * PI, 500.0 * PI / 3.0)),
        ("hemisphere.step", (75.0 * PI, 250.0 * PI / 3.0)),
        ("cone.step", (24.0 * PI, 12.0 * PI)),
        ("turned.step", (99.0 * PI, 250.0 * PI / 3.0 + 12.0 * PI)),
        ("spline_ball.step", (64.0 * PI, 256.0 * PI / 3.0)),
        ("torus.step", (48.0 * PI * PI, 48.0 * PI * PI)),
        ("tessellated.step", (6.0, 1.0)),
        ("mapped_items.step", (18.0, 3.0)),
    ] {
        let found = measured(name);
        println!("{name}: {:.4} of the area, {:.4} of the volume", found.area / area, found.volume / volume);
        assert_near(found.area, area);
        assert_near(found.volume, volume);
    }
    // Half of a cylinder with radius 2 and height 7 in four ways, and a quarter with radius 3.
    assert_near(measured("swept_and_splines.step").area, 4.0 * 14.0 * PI + 10.5 * PI);
}

/// How often each edge of a scene's triangles is used one way and not the other.
fn open_edges(scene: &SceneBuilder) -> usize {
    let mut count = std::collections::HashMap::new();
    for object in &scene.objects {
        for corners in &object.mesh.triangles {
            let p = corners.map(|i| object.mesh.positions[i as usize].to_array().map(f32::to_bits));
            for (a, b) in [(p[0], p[1]), (p[1], p[2]), (p[2], p[0])] {
                *count.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
            }
        }
    }
    count.values().filter(|&&count| count != 0).count()
}

#[test]
fn solids_are_closed_and_their_normals_point_outwards() {
    for name in [
        "cube_hole.step",
        "cube_hole_seam.step",
        "sphere.step",
        "hemisphere.step",
        "cone.step",
        "turned.step",
        "spline_ball.step",
        "torus.step",
    ] {
        let scene = scene(&seed(name));
        assert_eq!(open_edges(&scene), 0, "{name}");
        let (mut all, mut wrong) = (0.0, 0.0);
        for object in &scene.objects {
            let mesh = &object.mesh;
            for corners in &mesh.triangles {
                let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
                let flat = (b - a).cross(c - a);
                let smooth: DVec3 = corners.iter().map(|&i| mesh.normals[i as usize].as_dvec3()).sum();
                all += flat.length();
                if smooth.normalize_or_zero().dot(flat) < 0.9 * flat.length() {
                    wrong += flat.length();
                }
            }
        }
        // Slivers along a rim may lean any way.
        assert!(wrong < 1e-6 * all, "{name}: the normals of {} of the area", wrong / all);
    }
    let ball = scene(&seed("sphere.step"));
    let mesh = &ball.objects[0].mesh;
    let off = |i: usize| (mesh.positions[i] / 5.0 - mesh.normals[i]).length();
    assert!(
        (0..mesh.positions.len()).all(|i| off(i) < 1e-5),
        "the normals of a sphere are those of the surface"
    );
}

#[test]
fn assemblies_have_places_colours_names_and_units() {
    let scene = scene(&seed("assembly_inches.step"));
    assert_eq!((warnings(&scene), scene.unit), (String::new(), 0.0254));
    assert_eq!(scene.written_by, "Bolts à la carte");
    assert!(scene.objects.iter().all(|object| object.name == "Blöck"));
    let found = measures(&scene);
    let inch = 25.4;
    assert_near(found.area, 2.0 * 22.0 * inch * inch);
    assert_near(found.volume, 12.0 * inch * inch * inch);
    // The second part lies along x: its z axis is the whole's x axis, and its x axis the whole's y axis.
    let [low, high] = found.bounds.map(|p| p / inch);
    assert!(low.distance(DVec3::new(0.0, 0.0, 100.0)) < 1e-4, "{low}");
    assert!(high.distance(DVec3::new(13.0, 2.0, 103.0)) < 1e-4, "{high}");
    // Four faces and the bottom have the solid's colour, encoded as sRGB; the top is red, and lets a quarter through.
    let purple = Rgb::new(srgb_decode(0.5), srgb_decode(0.25), 1.0);
    let key = |rgb: Rgb| format!("{:.3},{:.3},{:.3}", rgb.r, rgb.g, rgb.b);
    assert_near(found.areas[&key(purple)], 40.0 * inch * inch);
    assert_near(found.areas[&key(Rgb::new(1.0, 0.0, 0.0))], 4.0 * inch * inch);
    let red = scene.materials.iter().find(|spec| spec.number("opacity").is_some()).unwrap();
    assert_eq!(red.number("opacity"), Some(0.75));
    let one = &scene.objects[0].mesh;
    assert_eq!(
        scene.objects.iter().filter(|o| std::sync::Arc::ptr_eq(&o.mesh, one)).count(),
        2,
        "one mesh, twice"
    );
}

#[test]
fn a_circle_of_assemblies_ends_with_a_warning() {
    let scene = scene(&seed("cycle.step"));
    assert!(warnings(&scene).contains("an assembly contains itself"), "{}", warnings(&scene));
    assert!(!scene.objects.is_empty());
}

#[test]
fn what_cannot_be_trimmed_is_counted_and_said_once() {
    let text = seed("cube_hole.step");
    let changes = [
        // A missing surface, a missing edge, a number that is none, and a surface that nobody knows.
        text.replacen("PLANE('',#", "PLANE('',#9", 1),
        text.replacen("CYLINDRICAL_SURFACE", "CYLINDRICAL_SURFACES", 1),
        text.replacen(",2.)", ",1.#QNAN)", 3),
    ];
    for text in changes {
        let reported = warnings(&scene(&text));
        assert!(reported.contains("of 7 faces"), "{reported}");
    }
    let lost = warnings(&scene(&text.replacen("CYLINDRICAL_SURFACE", "CONE_OF_SILENCE", 1)));
    assert!(lost.contains("1 of 7 faces"), "{lost}");
}

/// Assemblies of some programs have each part in a file of its own.
#[test]
fn parts_in_other_files_are_named() {
    let other = "#9001=DOCUMENT_FILE('HEAD.STP','','',#9002,'','');\n#9003=DOCUMENT_FILE('notes.pdf','','',#9002,'','');";
    let with = |text: &str, what: &str| text.replacen("DATA;", &format!("DATA;\n{what}"), 1);
    let empty = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
    assert!(refusal("step", with(empty, other)).contains("such as 'HEAD.STP'"));
    assert!(!refusal("step", with(empty, "#1=DIRECTION('',(0.,0.,1.));")).contains("other files"));
    let cut = with(empty, other).replace("END-ISO-10303-21;", "");
    assert!(refusal("step", cut).contains("it was cut off"));
    let solid = seed("cube_hole.step");
    assert!(warnings(&scene(&with(&solid, other))).contains("parts in other files, such as 'HEAD.STP'"));
    assert_eq!(warnings(&scene(&solid)), "");
}

#[test]
fn every_spelling_of_a_file_is_that_file() {
    let text = seed("cube_hole.step");
    let mesh = scene(&text).objects[0].mesh.clone();
    for text in [
        text.replace('\n', "\r\n"),
        text.replace(",", " ,\n  "),
        text.replace(";\n", ";/* a comment; with #1=('' */"),
        text.replace("DATA;", "DATA('first',('AUTOMOTIVE_DESIGN'));"),
        text.replace("ENDSEC;\nEND-ISO", "ENDSEC;\nSIGNATURE;\nabc=\nENDSEC;\nEND-ISO"),
    ] {
        assert_eq!(scene(&text).objects[0].mesh, mesh, "{}", &text[..300]);
    }
    let cut = text.split("END-ISO").next().unwrap();
    assert!(warnings(&scene(cut)).contains("may be cut off"));
}

#[test]
fn hostile_files_end_soon_with_an_error() {
    let head = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n";
    let end = "ENDSEC;\nEND-ISO-10303-21;\n";
    let deep = format!("{head}#1=A({});\n", "(".repeat(1_000_000));
    assert!(refusal("step", deep).contains("no DATA section"));
    assert!(
        refusal("step", format!("{head}#1=CLOSED_SHELL('',(#1,#1));\n{end}")).contains("no solid or surface")
    );
    // Each assembly has the next one twice: 2^40 parts.
    let text = seed("assembly_inches.step");
    let mut grown = text.replace("ENDSEC;\nEND-ISO", "");
    for i in 1000..1040 {
        grown.push_str(&format!("#{i}=PRODUCT_DEFINITION('','',$,$);\n"));
        for j in [2000, 3000] {
            let (usage, whole, part) = (i + j, i, i + 1);
            grown.push_str(&format!(
                "#{usage}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{whole},#{part},$);\n"
            ));
        }
    }
    let small = ReadOptions { max_memory: 4 << 20, ..ReadOptions::default() };
    let error = read_bytes(grown.as_bytes(), "step", None, "grown.step", &small).unwrap_err().to_string();
    assert!(error.contains("more than the 4194304 bytes"), "{error}");
    let circle = format!("{head}#1=STYLED_ITEM('',(#1),#1);\n#2=MANIFOLD_SOLID_BREP('',#2);\n{end}");
    assert!(refusal("step", circle).contains("no solid or surface"));
}

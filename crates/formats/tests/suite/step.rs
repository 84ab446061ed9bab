//! STEP files: small ones with areas and volumes that formulas give, and hostile ones.

use crate::step_truth::{Measures, measures};
use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, read_bytes};
use bilux_math::colour::srgb_decode;
use bilux_math::transcendental::{cos_f64, sin_f64};
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

/// Measures of a scene without warnings, in units of a millimetre.
fn measured(name: &str) -> Measures {
    let scene = scene(&seed(name));
    assert_eq!((warnings(&scene), scene.unit), (String::new(), 1e-3), "{name}");
    measures(&scene)
}

/// Asserts equality within a hundredth: chords are shorter than arcs.
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

/// Number of edges that a scene's triangles use more often one way than the other.
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

/// A part in millimetres stands in an assembly in inches, by a point of it that is not its origin.
#[test]
fn parts_stand_in_assemblies_of_other_units() {
    let text = seed("assembly_inches.step")
        .replace("(#168,#160),#7);", "(#168,#160),#900);")
        .replace("#165=CARTESIAN_POINT('',(0.,0.,0.));", "#165=CARTESIAN_POINT('',(1.,2.,0.));")
        .replace(
            "#8=APPLICATION_CONTEXT",
            "#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#5,#6))REPRESENTATION_CONTEXT('','3D'));\n\
             #8=APPLICATION_CONTEXT",
        );
    let scene = scene(&text);
    assert_eq!((warnings(&scene), scene.unit), (String::new(), 1e-3));
    // Blocks of 1 × 2 × 3 mm, of which the point (1, 2, 0) is at (0, 0, 100) inches, and in one that lies along x at (10, 0, 100).
    let found = measures(&scene);
    assert_near(found.volume, 12.0);
    let [low, high] = found.bounds;
    assert!(low.distance(DVec3::new(-1.0, -2.0, 2538.0)) < 1e-3, "{low}");
    assert!(high.distance(DVec3::new(257.0, 0.0, 2543.0)) < 1e-3, "{high}");
}

/// Normals are of the points that a face counts, one by one, or one of all. [ISO 10303-42, triangulated_face]
#[test]
fn tessellated_faces_have_the_normals_of_their_points() {
    let points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    // From the middle of the cube on.
    let outwards = |numbers: &[usize]| {
        let normal = |i: &usize| {
            let [x, y, z] = points[i - 1].map(|x| f64::from(2 * x - 1) / 3f64.sqrt());
            format!("({x:.9},{y:.9},{z:.9})")
        };
        numbers.iter().map(normal).collect::<Vec<_>>().join(",")
    };
    let all = outwards(&[1, 2, 3, 4, 5, 6, 7, 8]);
    let some = outwards(&[3, 4, 7, 8, 1, 5]);
    let text = seed("tessellated.step")
        .replace("=TRIANGULATED_FACE('',#8,8,()", &format!("=TRIANGULATED_FACE('',#8,8,({all})"))
        .replace(
            "COMPLEX_TRIANGULATED_FACE('',#8,8,()",
            &format!("COMPLEX_TRIANGULATED_FACE('',#8,8,({some})"),
        );
    let scene = scene(&text);
    let corners = scene.objects.iter().flat_map(|o| o.mesh.positions.iter().zip(&o.mesh.normals));
    let mut count = 0;
    for (p, normal) in corners {
        let wanted = (p.as_dvec3() - DVec3::splat(0.5)).normalize();
        assert!(normal.as_dvec3().distance(wanted) < 1e-5, "{p}: {normal}");
        count += 1;
    }
    assert!(count >= 8);
    let flat = seed("tessellated.step")
        .replace("=TRIANGULATED_FACE('',#8,8,()", "=TRIANGULATED_FACE('',#8,8,((0.,0.6,0.8))");
    let one = bilux_math::Vec3::new(0.0, 0.6, 0.8);
    let scene = self::scene(&flat);
    let has = |normal: &bilux_math::Vec3| normal.distance(one) < 1e-6;
    let with = scene.objects.iter().flat_map(|o| &o.mesh.normals).filter(|normal| has(normal)).count();
    assert!(with > 0 && with < scene.objects.iter().map(|o| o.mesh.normals.len()).sum());
}

/// [ISO 10303-46: an overriding styled item replaces the style of the item that it names.] In whatever order they stand.
#[test]
fn a_colour_that_overrides_another_counts() {
    let text = seed("tessellated.step");
    let style = |first: u32, [r, g, b]: [f32; 3]| {
        let [a, b_, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(|i| first + i);
        format!(
            "#{a}=COLOUR_RGB('',{r:?},{g:?},{b:?});\n#{b_}=FILL_AREA_STYLE_COLOUR('',#{a});\n\
             #{c}=FILL_AREA_STYLE('',(#{b_}));\n#{d}=SURFACE_STYLE_FILL_AREA(#{c});\n\
             #{e}=SURFACE_SIDE_STYLE('',(#{d}));\n#{f}=SURFACE_STYLE_USAGE(.BOTH.,#{e});\n"
        )
    };
    let below = "#220=PRESENTATION_STYLE_ASSIGNMENT((#205));\n#221=PRESENTATION_STYLE_ASSIGNMENT((#215));\n";
    let [plain, over] =
        ["#230=STYLED_ITEM('',(#220),#11);\n", "#231=OVER_RIDING_STYLED_ITEM('',(#221),#11,#230);\n"];
    let styles = [style(200, [1.0, 0.0, 0.0]), style(210, [0.0, 1.0, 0.0]), below.to_owned()].concat();
    let base = text.lines().filter(|line| !line.contains("STYLED_ITEM")).collect::<Vec<_>>().join("\n");
    for items in [[plain, over].concat(), [over, plain].concat()] {
        let scene = scene(&base.replacen("DATA;", &format!("DATA;\n{styles}{items}"), 1));
        let spec = &scene.materials[scene.objects[0].material];
        let colour = spec.colour("base_color").or(spec.colour("kd"));
        assert_eq!(colour, Some(Rgb::new(0.0, 1.0, 0.0)), "{spec:?}");
    }
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
    assert!(refusal("step", with(empty, other)).contains("in other files ('HEAD.STP'), which"));
    // By what is assigned to documents that have a number for a name. [CAx-IF, External References]
    let assigned = "#9010=DOCUMENT_FILE('D-17','','',#9002,'','');\n\
        #9011=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('left.stp',#1,(#9010),#2);\n\
        #9012=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('right.step',#1,(#9010),#2);\n\
        #9013=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('left.stp',#1,(#9010),#2);";
    assert!(
        refusal("step", with(empty, assigned)).contains("in other files ('left.stp', 'right.step'), which")
    );
    assert!(!refusal("step", with(empty, "#1=DIRECTION('',(0.,0.,1.));")).contains("other files"));
    let cut = with(empty, other).replace("END-ISO-10303-21;", "");
    assert!(refusal("step", cut).contains("it was cut off"));
    let solid = seed("cube_hole.step");
    assert!(warnings(&scene(&with(&solid, other))).contains("parts in other files ('HEAD.STP')"));
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

/// A torus of radii 30 and 8 about z in faces between circles: at these angles around the tube, or around the axis.
fn torus(tube: &[f64], axis: &[f64]) -> String {
    const RADII: [f64; 2] = [30.0, 8.0];
    let mut lines = vec!["#5=TOROIDAL_SURFACE('',#4,30.,8.);".to_owned()];
    let mut last = 100;
    let mut add = |text: String, lines: &mut Vec<String>| {
        last += 1;
        lines.push(format!("#{last}={text};"));
        last
    };
    let triple = |p: DVec3| format!("({:.12},{:.12},{:.12})", p.x, p.y, p.z);
    // Closed edges: a circle about a direction, and where it begins.
    let mut edges = Vec::new();
    let mut circle = |centre: DVec3, normal: DVec3, start: DVec3, lines: &mut Vec<String>| {
        let point = add(format!("CARTESIAN_POINT('',{})", triple(start)), lines);
        let vertex = add(format!("VERTEX_POINT('',#{point})"), lines);
        let middle = add(format!("CARTESIAN_POINT('',{})", triple(centre)), lines);
        let up = add(format!("DIRECTION('',{})", triple(normal)), lines);
        let x = add(format!("DIRECTION('',{})", triple((start - centre).normalize())), lines);
        let place = add(format!("AXIS2_PLACEMENT_3D('',#{middle},#{up},#{x})"), lines);
        let curve = add(format!("CIRCLE('',#{place},{:.12})", start.distance(centre)), lines);
        add(format!("EDGE_CURVE('',#{vertex},#{vertex},#{curve},.T.)"), lines)
    };
    let at = |u: f64, v: f64| {
        let across = RADII[0] + RADII[1] * cos_f64(v);
        DVec3::new(across * cos_f64(u), across * sin_f64(u), RADII[1] * sin_f64(v))
    };
    for &v in tube {
        edges.push(circle(DVec3::Z * RADII[1] * sin_f64(v), DVec3::Z, at(0.3, v), &mut lines));
    }
    for &u in axis {
        let centre = DVec3::new(cos_f64(u), sin_f64(u), 0.0) * RADII[0];
        edges.push(circle(centre, DVec3::new(sin_f64(u), -cos_f64(u), 0.0), at(u, 0.4), &mut lines));
    }
    let faces: Vec<String> = (0..edges.len())
        .map(|i| {
            let mut bound = |edge: usize, way: &str, lines: &mut Vec<String>| {
                let oriented = add(format!("ORIENTED_EDGE('',*,*,#{edge},{way})"), lines);
                let around = add(format!("EDGE_LOOP('',(#{oriented}))"), lines);
                add(format!("FACE_BOUND('',#{around},.T.)"), lines)
            };
            // The face is on the left: above a line that goes around the axis, and before one that goes around the tube.
            let [low, high] = if axis.is_empty() { [".T.", ".F."] } else { [".F.", ".T."] };
            let low = bound(edges[i], low, &mut lines);
            let high = bound(edges[(i + 1) % edges.len()], high, &mut lines);
            format!("#{}", add(format!("ADVANCED_FACE('',(#{low},#{high}),#5,.T.)"), &mut lines))
        })
        .collect();
    let shell = add(format!("CLOSED_SHELL('',({}))", faces.join(",")), &mut lines);
    let solid = add(format!("MANIFOLD_SOLID_BREP('',#{shell})"), &mut lines);
    in_file(&lines.join("\n"), solid)
}

/// A file with a solid, in millimetres; #4 is a placement at the origin with z up.
fn in_file(lines: &str, solid: usize) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('a','2026-01-01T00:00:00',(''),(''),'','Bilux tests','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=DIRECTION('',(0.,0.,1.));\n\
         #3=DIRECTION('',(1.,0.,0.));\n#4=AXIS2_PLACEMENT_3D('',#1,#2,#3);\n\
         #10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n\
         #13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('','3D'));\n{lines}\n\
         #20=APPLICATION_CONTEXT('design');\n#21=PRODUCT_CONTEXT('',#20,'mechanical');\n#22=PRODUCT('a','a','',(#21));\n\
         #23=PRODUCT_DEFINITION_FORMATION('','',#22);\n#24=PRODUCT_DEFINITION_CONTEXT('part definition',#20,'design');\n\
         #25=PRODUCT_DEFINITION('design','',#23,#24);\n#26=PRODUCT_DEFINITION_SHAPE('','',#25);\n\
         #27=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#4,#{solid}),#13);\n#28=SHAPE_DEFINITION_REPRESENTATION(#26,#27);\nENDSEC;\n\
         END-ISO-10303-21;\n"
    )
}

/// A torus has the area 4 π² R r and the volume 2 π² R r², however it is divided into faces: by two circles along the tube, wherever
/// they are, across it, and by several.
#[test]
fn a_torus_has_its_area_however_it_is_divided() {
    let (area, volume) = (4.0 * PI * PI * 30.0 * 8.0, 2.0 * PI * PI * 30.0 * 64.0);
    for (tube, axis) in [
        (&[0.0, PI][..], &[][..]),
        (&[0.5 * PI, 1.5 * PI], &[]),
        (&[0.7, 2.9], &[]),
        (&[0.2, 2.0, 4.4], &[]),
        (&[], &[0.0, PI]),
        (&[], &[0.9, 5.1]),
        (&[], &[0.1, 1.3, 2.2, 4.0]),
    ] {
        let scene = scene(&torus(tube, axis));
        assert_eq!(warnings(&scene), "", "{tube:?} {axis:?}");
        let found = measures(&scene);
        let off = [found.area / area - 1.0, found.volume / volume - 1.0];
        assert!(off.iter().all(|off| off.abs() < 0.01), "{tube:?} {axis:?}: {off:?}");
        assert_eq!(open_edges(&scene), 0, "{tube:?} {axis:?}");
    }
}

/// Every item of a list of invisible ones is hidden, not its first alone: of four solids the second and the fourth are left.
#[test]
fn all_items_of_a_list_of_invisible_ones_are_hidden() {
    let text = seed("tessellated.step");
    let solids: String = (0..4)
        .map(|i| {
            let [list, face, solid] = [30, 40, 50].map(|first| first + i);
            let x = 10 * i;
            format!(
                "#{list}=COORDINATES_LIST('',4,(({x}.,0.,0.),({}.,0.,0.),({x}.,1.,0.),({x}.,0.,1.)));\n\
                 #{face}=TRIANGULATED_FACE('',#{list},4,(),$,(),((1,3,2),(1,2,4),(2,3,4),(3,1,4)));\n#{solid}=TESSELLATED_SOLID('',(#{face}),$);\n",
                x + 1
            )
        })
        .collect();
    let with = |hidden: &str| {
        let text = text.replace(
            "#20=TESSELLATED_SHAPE_REPRESENTATION('',(#19,#11),#4);",
            "#20=TESSELLATED_SHAPE_REPRESENTATION('',(#19,#50,#51,#52,#53),#4);",
        );
        scene(&text.replacen("DATA;", &format!("DATA;\n{solids}{hidden}"), 1))
    };
    let lefts = |scene: &SceneBuilder| -> Vec<f32> {
        scene.objects.iter().map(|object| object.mesh.bounds().min.x).collect()
    };
    assert_eq!(lefts(&with("")), [0.0, 10.0, 20.0, 30.0]);
    let styled = "#60=STYLED_ITEM('',(),#50);\n#61=STYLED_ITEM('',(),#52);\n#62=INVISIBILITY((#60,#61));\n";
    assert_eq!(lefts(&with(styled)), [10.0, 30.0]);
}

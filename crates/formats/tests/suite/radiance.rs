//! Scenes of Radiance: what is read, where it stands, and what is said about everything else.

use crate::{read_text, refusal, warnings};
use bilux_formats::{FormatError, ReadOptions, read};
use bilux_math::transcendental::{acos, atan, exp, sin, tan};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value, Visibility};

/// Lumens of 1 W in Radiance over those here.
const LUMENS: f32 = 179.0 / 683.0;

fn scene(text: &str) -> SceneBuilder {
    built(read_text("rad", text).unwrap_or_else(|error| panic!("{text}: {error}")), text)
}

fn built(scene: SceneBuilder, what: &str) -> SceneBuilder {
    if let Err(error) = scene.build(&Default::default(), [0.0, 1.0], 1.0) {
        panic!("{what}: {error}");
    }
    scene
}

/// A scene of several files; the first is read.
fn files(files: &[(&str, &str)]) -> Result<SceneBuilder, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    read(&folder.path().join(files[0].0), &ReadOptions::default())
}

fn notes(scene: &SceneBuilder) -> String {
    scene.notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

fn square(x: f32) -> f32 {
    x * x
}

const SQUARE: &str = "0 0 12  0 0 0  1 0 0  1 1 0  0 1 0";

/// The material of a square.
fn material(definition: &str) -> (SceneBuilder, Spec) {
    let scene = scene(&format!("{definition}\nm polygon p {SQUARE}"));
    let spec = scene.materials[scene.objects[0].material].clone();
    (scene, spec)
}

fn plain(definition: &str) -> Spec {
    let (scene, spec) = material(definition);
    assert_eq!(warnings(&scene), "", "{definition}");
    spec
}

fn part<'s>(scene: &'s SceneBuilder, spec: &Spec, key: &str) -> &'s Spec {
    match spec.parameters.find(key) {
        Some((Value::Material(index), _)) => &scene.materials[*index],
        other => panic!("{key}: {other:?}"),
    }
}

#[track_caller]
fn near(found: Option<Rgb>, wanted: [f32; 3]) {
    let found = found.unwrap().to_array();
    let off = found.iter().zip(wanted).map(|(a, b)| (a - b).abs() / b.abs().max(1e-3)).fold(0.0, f32::max);
    assert!(off < 1e-4, "{found:?}, not {wanted:?}");
}

/// The corners of a triangle in the world.
fn corners(object: &Object, triangle: usize) -> [Vec3; 3] {
    let place = object.motion.at(0.0);
    object.mesh.triangles[triangle]
        .map(|i| place.matrix().transform_point3(object.mesh.positions[i as usize]))
}

fn front(object: &Object) -> Vec3 {
    let [a, b, c] = corners(object, 0);
    (b - a).cross(c - a).normalize()
}

fn area(mesh: &Mesh) -> f32 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(one).sum()
}

#[track_caller]
fn at(found: Vec3, wanted: [f32; 3]) {
    assert!(found.distance(Vec3::from(wanted)) < 1e-4, "{found}, not {wanted:?}");
}

/// z is up in the files, and y north: here y is up, and -z north.
#[test]
fn surfaces_stand_where_the_file_says_and_face_that_way() {
    let made = scene(
        "# two materials\nvoid plastic m 0 0 5 .5 .3 .1 0 0\nvoid plastic other 0 0 5 .1 .3 .5 0 0\n\
         m polygon p 0 0 9  1 2 3  2 2 3  1 4 3  other ring r 0 0 8  0 0 5  0 0 -2  .5 2\n\
         other sphere s 0 0 4 1 2 3 .5\nm bubble b 0 0 4 1 2 3 4\n\
         m cylinder c 0 0 7 0 0 1  3 0 1  .25\nm tube t 0 0 7 0 0 1  3 0 1  .25\n\
         other cone k 0 0 8 0 0 0  0 0 2  .5 0\nother cup u 0 0 8 0 0 0  0 0 2  .5 1.5",
    );
    assert_eq!(warnings(&made), "");
    let named = |name: &str| made.objects.iter().find(|object| object.name == name).unwrap();
    let polygon = named("m");
    at(corners(polygon, 0)[0], [1.0, 3.0, -2.0]);
    at(corners(polygon, 0)[2], [1.0, 3.0, -4.0]);
    at(front(polygon), [0.0, 1.0, 0.0]);
    at(front(named("r")), [0.0, -1.0, 0.0]);
    // Away from the centre, or the axis, of those that face outwards.
    let outwards = |name: &str, axis: fn(Vec3) -> Vec3| {
        let object = named(name);
        let [a, b, c] = corners(object, 100);
        (b - a).cross(c - a).dot(a - axis(a))
    };
    for (name, axis, is_outwards) in [
        ("s", (|_| Vec3::new(1.0, 3.0, -2.0)) as fn(Vec3) -> Vec3, true),
        ("b", |_| Vec3::new(1.0, 3.0, -2.0), false),
        ("c", |p| Vec3::new(p.x, 1.0, 0.0), true),
        ("t", |p| Vec3::new(p.x, 1.0, 0.0), false),
        ("k", |p| Vec3::new(0.0, p.y, 0.0), true),
        ("u", |p| Vec3::new(0.0, p.y, 0.0), false),
    ] {
        assert_eq!(outwards(name, axis) > 0.0, is_outwards, "{name}");
    }
    let extent = |name: &str| {
        let object = named(name);
        let bounds = object.motion.at(0.0).bounds(&object.mesh.bounds());
        (bounds.min, bounds.max)
    };
    let (low, high) = extent("c");
    at(low, [0.0, 0.75, -0.25]);
    at(high, [3.0, 1.25, 0.25]);
    let (low, high) = extent("u");
    at(low, [-1.5, 0.0, -1.5]);
    at(high, [1.5, 2.0, 1.5]);
    let (low, high) = extent("k");
    at(low, [-0.5, 0.0, -0.5]);
    at(high, [0.5, 2.0, 0.5]);
    let (low, high) = extent("r");
    at(low, [-2.0, 5.0, -2.0]);
    at(high, [2.0, 5.0, 2.0]);
}

/// A polygon's hole is reached along a seam, whose corners the outline has twice.
#[test]
fn holes_of_polygons_stay_open() {
    let made = scene(
        "void plastic m 0 0 5 .5 .5 .5 0 0\n\
         m polygon wall 0 0 33  0 0 0  0 5 0  0 5 3  0 0 3  0 0 0  0 1 1  0 1 2  0 3 2  0 3 1  0 1 1  0 0 0",
    );
    assert_eq!(warnings(&made), "");
    let object = &made.objects[0];
    assert!((area(&object.mesh) - 13.0).abs() < 1e-4, "{}", area(&object.mesh));
    // The middle of the hole.
    let hole = Vec3::new(0.0, 1.5, -2.0);
    for i in 0..object.mesh.triangles.len() {
        let [a, b, c] = corners(object, i);
        let side = |p: Vec3, q: Vec3| (q - p).cross(hole - p).x;
        let sides = [side(a, b), side(b, c), side(c, a)];
        assert!(!(sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)), "{sides:?}");
    }
}

#[test]
fn plastic_is_diffuse_below_gloss_of_beckmann() {
    let spec = plain("void plastic m 0 0 5 .5 .3 .1 0 .2");
    assert_eq!(spec.kind, "diffuse");
    near(spec.colour("reflectance"), [0.5, 0.3, 0.1]);
    let (made, spec) = material("void plastic m 0 0 5 .5 .3 .1 .07 .2");
    assert_eq!((warnings(&made).as_str(), &*spec.kind, &*spec.name), ("", "mix", "m"));
    assert!((spec.number("amount").unwrap() - 0.07).abs() < 1e-6);
    near(part(&made, &spec, "a").colour("reflectance"), [0.5, 0.3, 0.1]);
    let gloss = part(&made, &spec, "b");
    near(gloss.colour("reflectance"), [1.0; 3]);
    assert!((gloss.number("roughness").unwrap() - 0.2f32.sqrt()).abs() < 1e-6);
    // Without roughness it is a boundary that reflects as much straight on.
    let spec = plain("void plastic m 0 0 5 .5 .3 .1 .07 0");
    let root = (spec.number("specular_ior").unwrap() - 1.0) / (spec.number("specular_ior").unwrap() + 1.0);
    assert!((root * root - 0.07).abs() < 1e-5);
}

#[test]
fn metal_tints_its_gloss_and_trans_parts_its_light() {
    let (made, spec) = material("void metal m 0 0 5 .8 .5 .2 .9 .1");
    near(part(&made, &spec, "b").colour("reflectance"), [0.8, 0.5, 0.2]);
    near(part(&made, &spec, "a").colour("reflectance"), [0.8, 0.5, 0.2]);
    assert!((spec.number("amount").unwrap() - 0.9).abs() < 1e-6);
    // Of .8: .1 is gloss, .6 of the rest passes, a quarter of that straight on.
    let (made, spec) = material("void trans m 0 0 7 .8 .8 .4 .1 0 .6 .25");
    assert_eq!(warnings(&made), "");
    assert!((spec.number("amount").unwrap() - 0.1).abs() < 1e-6);
    let base = part(&made, &spec, "a");
    assert!((base.number("amount").unwrap() - 0.15).abs() < 1e-6);
    let spread = part(&made, base, "a");
    near(spread.colour("reflectance"), [0.8 * 0.4 / 0.85, 0.8 * 0.4 / 0.85, 0.4 * 0.4 / 0.85]);
    near(spread.colour("transmittance"), [0.8 * 0.45 / 0.85, 0.8 * 0.45 / 0.85, 0.4 * 0.45 / 0.85]);
    let straight = part(&made, base, "b");
    near(straight.colour("tint"), [0.8, 0.8, 0.4]);
    assert_eq!(straight.number("eta"), Some(1.0));
}

#[test]
fn glass_is_a_pane_and_dielectrics_absorb_by_the_metre() {
    let spec = plain("void glass m 0 0 3 .96 .9 .8");
    near(spec.colour("tint"), [0.96, 0.9, 0.8]);
    assert!((spec.number("eta").unwrap() - 1.52).abs() < 1e-6);
    assert!((plain("void glass m 0 0 4 .96 .9 .8 1.6").number("eta").unwrap() - 1.6).abs() < 1e-6);
    let spec = plain("void dielectric m 0 0 5 .5 .8 1 1.5 0");
    near(spec.colour("absorption"), [std::f32::consts::LN_2, 0.223_144, 0.0]);
    assert!(spec.parameters.find("dispersion").is_none());
    // Of Hartmann's equation with a slope of 10 nm: n - 1 at the line d, over its difference from F to C.
    let spec = plain("void dielectric m 0 0 5 1 1 1 1.5 10");
    let abbe = (0.5 + 10.0 / 587.56) / (10.0 / 486.13 - 10.0 / 656.27);
    assert!((spec.number("dispersion").unwrap() - 20.0 / abbe).abs() < 1e-4);
    let spec = plain("void interface m 0 0 8 .5 .8 1 1.5  1 1 1 1.33");
    assert!((spec.number("eta").unwrap() - 1.5 / 1.33).abs() < 1e-6);
    let spec = plain("void mist m 0 0 7 2 4 8 .25 .5 .75 .6");
    near(spec.colour("scattering"), [0.5, 2.0, 6.0]);
    near(spec.colour("absorption"), [1.5, 2.0, 2.0]);
    // The same glass twice as large lets as much through.
    let made = files(&[
        ("a.rad", "!xform -s 2 -ry 30 b.rad"),
        ("b.rad", &format!("void dielectric m 0 0 5 .5 .8 1 1.5 0\nm polygon p {SQUARE}")),
    ]);
    let made = made.unwrap();
    near(made.materials[0].colour("absorption"), [0.346_574, 0.111_572, 0.0]);
}

/// Lumens stay what they are: 179 of 1 W there, 683 here.
#[test]
fn lamps_have_as_many_lumens() {
    let made = scene(&format!(
        "void light m 0 0 3 10 20 30\nvoid glow n 0 0 4 1 2 3 5\nm polygon p {SQUARE}\nn polygon q {SQUARE}\nm sphere s 0 0 4 1 2 3 .5"
    ));
    let emission = |name: &str| {
        let object = made.objects.iter().find(|object| object.name == name).unwrap();
        let spec = &made.materials[object.material];
        assert_eq!(
            spec.parameters.find("emission_sides").map(|(value, _)| value.clone()),
            Some("front".into())
        );
        near(spec.colour("reflectance"), [0.0; 3]);
        spec.colour("emission")
    };
    near(emission("m"), [10.0 * LUMENS, 20.0 * LUMENS, 30.0 * LUMENS]);
    near(emission("n"), [LUMENS, 2.0 * LUMENS, 3.0 * LUMENS]);
    let [ball] = &made.lights[..] else { panic!("{:?}", made.lights) };
    assert_eq!((&*ball.kind, &*ball.name), ("sphere", "s"));
    at(ball.vector("position").unwrap(), [1.0, 3.0, -2.0]);
    near(ball.colour("radiance"), [10.0 * LUMENS, 20.0 * LUMENS, 30.0 * LUMENS]);
    assert!(made.describes_all_light && !made.environment_unspecified);
    let dark = scene(&format!("void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon p {SQUARE}"));
    assert!(!dark.describes_all_light && dark.environment_unspecified);
}

#[test]
fn spotlights_shine_in_their_cones() {
    let made = files(&[
        ("a.rad", "!xform -rx 90 -t 0 0 3 b.rad"),
        (
            "b.rad",
            "void spotlight m 0 0 7 10 20 30  40  0 0 -2\nm polygon p 0 0 12  0 0 0  0 2 0  3 2 0  3 0 0",
        ),
    ]);
    let made = built(made.unwrap(), "spotlight");
    let [spot] = &made.lights[..] else { panic!("{:?}", made.lights) };
    // The square faces down; turned, it faces north, which is y, and looks along it.
    at(spot.vector("position").unwrap(), [1.5, 4.0, 0.0]);
    let aim = spot.vector("look_at").unwrap() - spot.vector("position").unwrap();
    at(aim.normalize(), [0.0, 0.0, -1.0]);
    assert_eq!((spot.number("angle"), spot.number("inner_angle")), (Some(20.0), Some(20.0)));
    near(spot.colour("intensity"), [60.0 * LUMENS, 120.0 * LUMENS, 180.0 * LUMENS]);
    assert!(notes(&made).contains("a spotlight is a point"), "{}", notes(&made));
}

#[test]
fn eyes_see_the_other_material_of_an_illum() {
    let made = scene(&format!(
        "void glass pane 0 0 3 .9 .9 .9\nvoid illum m 1 pane 0 3 1 2 3\nvoid illum n 0 0 3 4 5 6\nm polygon p {SQUARE}\nn polygon q {SQUARE}"
    ));
    let of = |name: &str| made.objects.iter().find(|object| object.name == name).unwrap();
    assert_eq!(of("m").visibility, Visibility::NoCamera);
    assert_eq!(of("n").visibility, Visibility::NoCamera);
    assert_eq!(of("pane").visibility, Visibility::Full);
    near(made.materials[of("m").material].colour("emission"), [LUMENS, 2.0 * LUMENS, 3.0 * LUMENS]);
    assert_eq!(made.objects.len(), 3);
}

#[test]
fn aliases_mixtures_and_patterns_come_to_a_material() {
    let made = scene(&format!(
        "void plastic red 0 0 5 .8 .1 .1 0 0\nvoid plastic blue 0 0 5 .1 .1 .8 0 0\nvoid alias same red\n\
         void colorpict bricks 7 red green blue bricks.hdr . u v 0 0\nbricks alias bricked red\ninherit alias again bricked\n\
         void mixfunc both 4 red blue f f.cal 0 0\nvoid mixtext sign 4 void red f.fnt sign.txt 0 9 0 0 0 1 0 0 0 1 0\n\
         red polygon a {SQUARE}\nsame polygon b {SQUARE}\nagain polygon c {SQUARE}\nboth polygon d {SQUARE}\nsign polygon e {SQUARE}\n\
         void polygon f {SQUARE}"
    ));
    let said = warnings(&made);
    for what in ["the pattern 'bricks'", "the colorpict 'bricks'", "the mixfunc 'both'", "the mixtext 'sign'"]
    {
        assert_eq!(said.contains(what), what != "the pattern 'bricks'", "{what}: {said}");
    }
    assert!(notes(&made).contains("surfaces without a material"), "{}", notes(&made));
    let find = |name: &str| made.objects.iter().find(|object| object.name == name);
    let spec = |name: &str| &made.materials[find(name).unwrap_or_else(|| panic!("{name}")).material];
    assert_eq!(spec("both").kind, "mix");
    assert_eq!(spec("sign").number("opacity"), Some(0.5));
    near(spec("sign").colour("reflectance"), [0.8, 0.1, 0.1]);
    // a, b and c: two of them have the same material, the third one has it under another pattern.
    let red = made.objects.iter().filter(|object| object.name == "red");
    assert_eq!(red.map(|object| object.mesh.triangles.len()).collect::<Vec<_>>(), [4, 2]);
}

#[test]
fn undefined_modifiers_are_grey_and_said() {
    let made = scene(&format!(
        "void plastic wall 0 0 5 .8 .1 .1 0 0\nwal polygon p {SQUARE}\nwal polygon q {SQUARE}"
    ));
    let said = warnings(&made);
    assert!(
        said.contains("scene.rad:2:1") && said.contains("'wal'") && said.contains("did you mean 'wall'?"),
        "{said}"
    );
    assert!(said.contains("2 times"), "{said}");
    near(made.materials[made.objects[0].material].colour("reflectance"), [0.5; 3]);
}

/// A box that a command makes, in an array that another one makes of it.
#[test]
fn commands_are_read_and_never_run() {
    let made = files(&[
        (
            "a.rad",
            "void plastic m 0 0 5 .5 .5 .5 0 0\nvoid plastic paint 0 0 5 .1 .2 .3 0 0\n\
             !genbox m crate 1 2 3 | xform -rz 90 -t 10 0 0\n\
             !/usr/local/bin/xform -n shelf -m paint -t 0 0 1 -a 3 -t 0 0 2 -a 2 \\\n -mx parts/shelf.rad\n\
             !touch ran.txt\n!genworm m w 'a' 'b' 'c' .1 5\n!sh -c \"echo > ran.txt\"",
        ),
        ("parts/shelf.rad", "!xform -rx 0 board.rad\n"),
        (
            "parts/board.rad",
            "void plastic wood 0 0 5 .8 .8 .8 0 0\nwood polygon b 0 0 9  1 0 0  2 0 0  1 1 0\n",
        ),
    ]);
    let made = built(made.unwrap(), "commands");
    let crates = made.objects.iter().find(|object| object.name == "m").unwrap();
    let bounds = crates.mesh.bounds();
    at(bounds.min, [8.0, 0.0, -1.0]);
    at(bounds.max, [10.0, 3.0, 0.0]);
    assert_eq!(crates.mesh.positions.len(), 8, "its faces close");
    let shelves: Vec<&Object> =
        made.objects.iter().filter(|object| object.name.starts_with("shelf.")).collect();
    assert_eq!(shelves.len(), 6);
    let shelf = |name: &str| *shelves.iter().find(|object| object.name == name).unwrap();
    at(corners(shelf("shelf.2.0.paint"), 0)[0], [1.0, 5.0, 0.0]);
    // Mirrored, it faces up nevertheless.
    let mirrored = shelf("shelf.1.1.paint");
    assert!(mirrored.mesh.bounds().min.distance(Vec3::new(-2.0, 3.0, -1.0)) < 1e-5);
    at(front(mirrored), [0.0, 1.0, 0.0]);
    near(made.materials[mirrored.material].colour("reflectance"), [0.1, 0.2, 0.3]);
    let said = warnings(&made);
    for program in ["!touch", "!genworm", "!sh"] {
        assert!(said.contains(program), "{said}");
    }
}

#[test]
fn an_inverted_box_is_a_room() {
    let made = scene(
        "void plastic m 0 0 5 .5 .5 .5 0 0\n!genbox m room 4 6 3 -i\n!genbox m table 1 1 1 -b .1 | xform -I -t 1 1 0",
    );
    assert_eq!(warnings(&made), "");
    let mesh = &made.objects[0].mesh;
    // The polygons of both face inwards: what they enclose is negative.
    let volume: f32 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    let table = 1.0 - 0.005 * 9.6 - 8.0 * (0.001 - 0.001 / 6.0);
    assert!((volume + 72.0 + table).abs() < 1e-3, "{volume}");
    // So does what has a direction of its own.
    let lamps = files(&[
        ("a.rad", "!xform lamp.rad\n!xform -I -t 0 0 5 lamp.rad"),
        ("lamp.rad", "void light l 0 0 3 9 9 9\nl ring r 0 0 8  0 0 3  0 0 -1  .5 2"),
    ]);
    let lamps = built(lamps.unwrap(), "lamps");
    at(front(&lamps.objects[0]), [0.0, -1.0, 0.0]);
    at(front(&lamps.objects[1]), [0.0, 1.0, 0.0]);
}

fn sky(text: &str) -> (SceneBuilder, Spec) {
    let made = scene(text);
    let light = made.lights[0].clone();
    (made, light)
}

const DOME: &str = "skyfunc glow sky_mat 0 0 4 .9 .9 1.15 0\nsky_mat source sky 0 0 4 0 0 1 180\n\
                    skyfunc glow ground_glow 0 0 4 1.4 .9 .6 0\nground_glow source ground 0 0 4 0 0 -1 180\n";

/// By the numbers that Radiance's own programs print.
#[test]
fn skies_and_suns_of_gensky_are_ours() {
    let (made, light) = sky(&format!("!gensky 6 21 10 +s\n{DOME}"));
    assert_eq!(warnings(&made), "");
    assert_eq!((made.lights.len(), &*light.kind), (1, "cie-sky"));
    assert_eq!(light.parameters.find("standard").map(|(value, _)| value.clone()), Some(Value::Integer(12)));
    let close = |key: &str, wanted: [f32; 3], off: f32| {
        let found = light.colour(key).unwrap().to_array();
        let most = found.iter().zip(wanted).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f32::max);
        assert!(most < off, "{key}: {found:?}, not {wanted:?}");
    };
    close("zenith", [0.9, 0.9, 1.15].map(|c| c * 14.6 * LUMENS), 1e-3);
    let sun = 7.033e6 * std::f32::consts::PI * square(sin(0.25f32.to_radians()));
    close("sun", [sun * LUMENS; 3], 1e-3);
    assert_eq!(light.number("sun_diameter"), Some(0.5));
    assert!((light.number("elevation").unwrap() - 58.9).abs() < 0.1, "{light:?}");
    // From the south 71.9 degrees to the east.
    assert!((light.number("azimuth").unwrap() - 108.1).abs() < 0.1, "{light:?}");
    // What the ground gives back is what the program says, but for 2%: it takes a polynomial for an integral.
    let received = light.colour("irradiance").unwrap() + light.colour("sun").unwrap() * 0.85598;
    let ground = light.colour("ground").unwrap();
    for (i, tint) in [1.4, 0.9, 0.6].into_iter().enumerate() {
        let found = ground[i] * received[i] / std::f32::consts::PI;
        let wanted = 26.07 * tint * LUMENS;
        assert!((found / wanted - 1.0).abs() < 0.02, "{i}: {found}, not {wanted}");
    }
}

#[test]
fn overcast_and_turned_skies_and_those_that_were_measured() {
    let (made, light) = sky(&format!("!gensky 6 21 10 -c -g .3\n{DOME}"));
    assert_eq!((warnings(&made).as_str(), made.lights.len()), ("", 1));
    assert_eq!(light.parameters.find("standard").map(|(value, _)| value.clone()), Some(Value::Integer(16)));
    near(light.colour("sun"), [0.0; 3]);
    // By 0.3 of what falls on it, in the colours of both halves.
    near(light.colour("ground"), [0.3 * 1.4 / 0.9, 0.3, 0.3 * 0.6 / 1.15]);
    let (made, light) = sky(&format!("!gendaylit 6 21 10 -W 600 150 | xform -rz 30\n{DOME}"));
    assert_eq!((warnings(&made).as_str(), made.lights.len(), &*light.kind), ("", 1, "perez-sky"));
    assert!((light.number("clearness").unwrap() - 4.4276).abs() < 5e-3);
    assert!((light.number("brightness").unwrap() - 0.1324).abs() < 1e-4);
    // Turned from the north to the west.
    assert!((light.number("azimuth").unwrap() - 78.1).abs() < 0.1, "{light:?}");
    let sun = 4.977e6 * std::f32::consts::PI * square(sin(0.2665f32.to_radians())) * LUMENS;
    let found = light.colour("direct").unwrap();
    assert!((found.g / sun - 1.0).abs() < 2e-3, "{found:?}, not {sun}");
    // Of level ground the sun gives the sine of its altitude of that.
    let level = 600.0 * sin(light.number("elevation").unwrap().to_radians());
    let (_, of_level) = sky(&format!("!gendaylit 6 21 10 -G {level} 150\n{DOME}"));
    let direct = of_level.colour("direct").unwrap();
    assert!(level < 595.0 && (direct.g / found.g - 1.0).abs() < 1e-3, "{direct:?}, not {found:?}");
    // Only half of the sky, and no sun.
    let (_, light) =
        sky("!gensky -ang 30 40 -s -b 10\nskyfunc glow g 0 0 4 1 2 3 0\ng source sky 0 0 4 0 0 1 180");
    near(light.colour("ground"), [0.0; 3]);
    near(light.colour("zenith"), [10.0 * LUMENS, 20.0 * LUMENS, 30.0 * LUMENS]);
    near(light.colour("sun"), [0.0; 3]);
}

#[test]
fn sources_are_suns_domes_and_parts_of_skies() {
    let made = scene(
        "void light l 0 0 3 100 200 300\nvoid glow g 0 0 4 1 2 3 0\nvoid glow h 0 0 4 .5 .5 .5 0\n\
         l source sun 0 0 4  0 -1 0  10\ng source up 0 0 4 0 0 1 180\nh source down 0 0 4 0 0 -1 180\nh source side 0 0 4 1 0 0 120",
    );
    assert_eq!(warnings(&made), "");
    let of = |kind: &str| made.lights.iter().find(|light| light.kind == kind).unwrap();
    let sun = of("directional");
    // It stands in the south, and shines to the north.
    at(sun.vector("direction").unwrap(), [0.0, 0.0, -1.0]);
    let share = std::f32::consts::PI * square(sin(5f32.to_radians())) * LUMENS;
    near(sun.colour("irradiance"), [100.0 * share, 200.0 * share, 300.0 * share]);
    let dome = of("cie-sky");
    near(dome.colour("zenith"), [LUMENS, 2.0 * LUMENS, 3.0 * LUMENS]);
    near(dome.colour("ground"), [0.5, 0.25, 0.5 / 3.0]);
    let map = match of("environment").parameters.find("radiance") {
        Some((Value::Texture(index), _)) => &made.textures[*index],
        other => panic!("{other:?}"),
    };
    // East, which is x, is a quarter to the right of the middle.
    let texel = |x: f32, y: f32| {
        let (w, h) = (map.width() as f32, map.height() as f32);
        map.texel((x * w) as usize, (y * h) as usize).g
    };
    assert!((texel(0.75, 0.5) - 0.5 * LUMENS).abs() < 1e-6);
    assert!((texel(0.6, 0.5) - 0.5 * LUMENS).abs() < 1e-6, "within 60 degrees");
    assert_eq!((texel(0.57, 0.5), texel(0.25, 0.5), texel(0.75, 0.1)), (0.0, 0.0, 0.0));
}

/// A sky that reaches five degrees below the horizon lights what it sees from below, by the numbers that `rtrace` prints.
#[test]
fn a_sky_of_more_than_its_half_reaches_below_the_horizon() {
    let wide = |degrees: f32| {
        scene(&format!(
            "!gensky 8 18 9.5 -s\nskyfunc glow g 0 0 4 .5 1 2 0\ng source sky 0 0 4 0 0 1 {degrees}"
        ))
    };
    let made = wide(190.0);
    assert_eq!(warnings(&made), "");
    let kinds: Vec<_> = made.lights.iter().map(|light| &*light.kind).collect();
    assert_eq!(kinds, ["cie-sky", "environment"]);
    let map = &made.textures[0];
    let texel = |x: f32, tangent: f32| {
        let row = 0.5 - atan(tangent) / std::f32::consts::PI;
        map.texel((x * map.width() as f32) as usize, (row * map.height() as f32) as usize)
    };
    // The east is a quarter to the right of the middle, the south at the edge.
    for (x, tangent, wanted) in
        [(0.75, -0.05, 23.69), (0.75, -0.08, 22.74), (0.0, -0.05, 20.81), (0.0, -0.08, 21.09)]
    {
        let found = texel(x, tangent);
        assert!((found.g / (wanted * LUMENS) - 1.0).abs() < 5e-3, "{found:?}, not {wanted}");
        assert!((found.r / found.g - 0.5).abs() < 1e-3 && (found.b / found.g - 2.0).abs() < 1e-3);
    }
    assert_eq!((texel(0.5, 0.05), texel(0.5, -0.1)), (Rgb::grey(0.0), Rgb::grey(0.0)));
    assert_eq!(wide(180.0).lights.len(), 1);
}

#[test]
fn views_are_those_of_the_files_beside() {
    let rad = format!("void glow m 0 0 4 1 1 1 0\nm polygon p {SQUARE}");
    let view = "rvu -vtv -vp 1 2 3 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 40 -vo 0 -va 0 -vs .25 -vl .1\n";
    let made = files(&[("a.rad", &rad), ("a.vf", view)]).unwrap();
    let [camera] = &made.cameras[..] else { panic!("{:?}", made.cameras) };
    at(camera.spec.vector("position").unwrap(), [1.0, 3.0, -2.0]);
    let forward = camera.spec.vector("look_at").unwrap() - camera.spec.vector("position").unwrap();
    at(forward.normalize(), [0.0, 0.0, -1.0]);
    assert_eq!(camera.spec.number("fov"), Some(40.0));
    let aspect = tan(30f32.to_radians()) / tan(20f32.to_radians());
    assert!((camera.spec.number("frame").unwrap() - aspect).abs() < 1e-4);
    assert_eq!(
        (camera.spec.number("principal_x"), camera.spec.number("principal_y")),
        (Some(0.25), Some(0.6))
    );
    let rif = "# a project\nscene= a.rad\nQUAL= med\nview= one -vtl -vp 0 -5 2 -vd 0 1 0 -vh 4 -vv 3\n\
               view= two -vth -vp 0 0 9 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 180\nview= three -vf a.vf\n";
    let made = files(&[("a.rif", rif), ("a.rad", &rad), ("a.vf", view)]).unwrap();
    built(made.clone(), "rif");
    assert_eq!((made.objects.len(), warnings(&made).as_str()), (1, ""));
    let found: Vec<_> = made.cameras.iter().map(|camera| (&*camera.spec.name, &*camera.spec.kind)).collect();
    assert_eq!(found, [("one", "orthographic"), ("two", "fisheye"), ("three", "perspective")]);
    assert_eq!(made.cameras[0].spec.number("height"), Some(3.0));
    let wider = "scene= a.rad\nview= -vf a.vf -vh 90 -vv 70\n";
    let made = files(&[("a.rif", wider), ("a.rad", &rad), ("a.vf", view)]).unwrap();
    assert_eq!(made.cameras[0].spec.number("fov"), Some(70.0), "what comes after the file counts");
    let made = files(&[("a.rad", &rad), ("a.rif", rif), ("b.vf", view)]).unwrap();
    assert!(made.cameras.len() == 2 && warnings(&made).contains("a.vf"), "{}", warnings(&made));
}

/// The words of a sort of message, for each of the wrong files.
#[test]
fn wrong_files_say_where_and_what() {
    for (text, wanted) in [
        ("void plastic m 0 0 4 1 1 1 0", &["scene.rad:1:1", "'m' has 4 numbers, and needs 5"][..]),
        ("void plastik m 0 0 5 1 1 1 0 0", &["scene.rad:1:6", "plastik", "did you mean 'plastic'"]),
        ("void plastic m 0 0 5 1.5 1.5 1.5 0.5", &["the file ends where a number should be"]),
        ("void plastic m 0 0 5 1 1 one 0 0", &["scene.rad:1:26", "'one' stands where a number should"]),
        ("void plastic m 0 0 5 1 1 nan 0 0", &["'nan' stands where a number should"]),
        ("void polygon p 0 0 99999999999 1 2 3", &["scene.rad:1:20", "99999999999", "the file ends before"]),
        ("void polygon p 0 0 -3", &["'-3' stands where the number of numbers"]),
        ("void polygon p 0 0 10 0 0 0 0 0 0 0 0 0 0", &["has 10 numbers, and needs three for each"]),
        (
            "void polygon p 18446744073709551616 0 0",
            &["'18446744073709551616' stands where the number of words"],
        ),
        ("void plastic", &["the file ends where the name of a primitive should be"]),
        ("void alias a", &["the file ends where the name that an alias"]),
        ("\n\n!xform -q 1 a.rad", &["scene.rad:3:1", "'-q' is no option of xform"]),
        ("!xform -t 1 2 a.rad", &["xform needs a number at 'a.rad'"]),
        ("!xform -s 1e200 -i 3 -s 1e200 a.rad", &["cannot be found"]),
        ("!genbox m b 1 2", &["genbox needs a material, a name and three sizes"]),
        ("!genbox m b 1 -2 3", &["genbox needs a material, a name and three sizes"]),
        ("!gensky 13 1 12", &["gensky needs a month, a day and an hour"]),
        ("!gensky 1 1 12 -t x", &["gensky needs a number after '-t', not 'x'"]),
        ("!gendaylit 1 1 12", &["gendaylit needs -P, -W, -L or -G"]),
    ] {
        let message = refusal("rad", text);
        for words in wanted {
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}

#[test]
fn files_stay_within_their_folder_and_end() {
    let outside = files(&[("in/a.rad", "!xform ../b.rad"), ("b.rad", "")]).unwrap_err().to_string();
    assert!(outside.contains("a.rad:1:1") && outside.contains("../b.rad"), "{outside}");
    let missing = files(&[("a.rad", "!xform b.rad")]).unwrap_err().to_string();
    assert!(missing.contains("there is no file 'b.rad'"), "{missing}");
    let cycle = files(&[("a.rad", "!xform b.rad"), ("b.rad", "!xform -rz 1 a.rad")]).unwrap_err().to_string();
    assert!(cycle.contains("names itself"), "{cycle}");
    let own = files(&[("a.rad", "!cat a.rad")]).unwrap_err().to_string();
    assert!(own.contains("names itself"), "{own}");
    // Forty files, each of which places the next one twice.
    let texts: Vec<(String, String)> =
        (0..30).map(|i| (format!("{i}.rad"), format!("!xform -a 2 -t 1 0 0 {}.rad", i + 1))).collect();
    let mut all: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (&**name, &**text)).collect();
    all.push(("30.rad", "void sphere s 0 0 4 0 0 0 1"));
    let doubled = files(&all).unwrap_err().to_string();
    assert!(doubled.contains("multiply so much"), "{doubled}");
    let huge = read_text("rad", "!genbox m b 1 1 1 | xform -a 4000000000 -t 1 0 0 -a 4000000000 -t 0 1 0");
    assert!(huge.unwrap_err().to_string().contains("multiply so much"));
    let text = format!(
        "m0 plastic m1 0 0 5 1 1 1 0 0\n{}",
        (1..2000)
            .fold(String::new(), |all, i| { all + &format!("m{i} colorfunc m{} 4 r g b . 0 0\n", i + 1) })
    );
    let chain = refusal("rad", format!("{text}m2000 polygon p {SQUARE}"));
    assert!(chain.contains("more than 1000 levels"), "{chain}");
}

/// Digits that 32-bit floats do not have so far from zero.
#[test]
fn models_far_away_keep_their_digits() {
    let made = scene(
        "void plastic m 0 0 5 .5 .5 .5 0 0\nm polygon p 0 0 9  500000 200000 10  500000.25 200000 10  500000 200000.125 10",
    );
    let bounds = made.bounds(0.0);
    at(bounds.extent(), [0.25, 0.0, 0.125]);
    assert!(
        (made.origin.x - 500_000.0).abs() < 2.0 && (made.origin.z + 200_000.0).abs() < 2.0,
        "{}",
        made.origin
    );
}

#[test]
fn files_without_a_name_are_known_by_their_first_statement() {
    for text in [
        "# a scene\n\nvoid plastic m 0 0 5 1 1 1 0 0".to_owned(),
        "!xform -t 0 0 1 a.rad".to_owned(),
        "void alias a b".to_owned(),
    ] {
        let read = read_text("", &text).map_err(|error| error.to_string());
        assert!(!read.as_ref().is_err_and(|error| error.contains("not a scene")), "{text}: {read:?}");
    }
}

/// Output of generators of skies is read as what they are asked for.
#[test]
fn skies_that_generators_have_written_are_the_same() {
    let written = "void light solar 0 0 3 7.033e+06 7.033e+06 7.033e+06\nsolar source sun 0 0 4 0.491441 -0.160574 0.855980 0.5\n\
                   void brightfunc skyfunc 2 skybr skybright.cal 0 7 1 1.460e+01 2.607e+01 8.765e-01 0.491441 -0.160574 0.855980\n";
    let (made, of_file) = sky(&format!("{written}{DOME}"));
    assert_eq!((warnings(&made).as_str(), made.lights.len()), ("", 1));
    let (_, of_command) = sky(&format!("!gensky 6 21 10 +s\n{DOME}"));
    for (key, value, _) in &of_command.parameters.0 {
        let (Some(a), Some(b)) = (of_command.colour(key), of_file.colour(key)) else {
            assert_eq!(of_file.parameters.find(key).map(|found| found.0), Some(value), "{key}");
            continue;
        };
        let off = (0..3).map(|i| (a[i] - b[i]).abs() / a[i].max(1e-3)).fold(0.0, f32::max);
        assert!(off < 0.02, "{key}: {a:?} {b:?}");
    }
    // Perez's by its coefficients is a map; its sun is a light of its own, as is that of the intermediate sky.
    let written = "void light solar 0 0 3 4.977e+06 4.977e+06 4.977e+06\nsolar source sun 0 0 4 0.491441 -0.160574 0.855980 0.533\n\
                   void brightfunc skyfunc 4 skybright perezlum.cal -rz 0 0 10 4.443e+01 2.421e+01 -0.980538 -0.268892 13.054283 \
                   -3.487938 0.156107 0.491441 -0.160574 0.855980\n";
    for text in [written.to_owned(), "!gensky 6 21 10 +i\n".to_owned()] {
        let made = scene(&format!("{text}{DOME}"));
        assert_eq!(warnings(&made), "", "{text}");
        let kinds: Vec<&str> = made.lights.iter().map(|light| &*light.kind).collect();
        assert_eq!(kinds, ["environment", "directional"], "{text}");
    }
    let made = scene(&format!("{written}{DOME}"));
    let map = &made.textures[0];
    // Straight up: 44.43 (1 + a exp b) (1 + c exp(d Z) + e cos² Z), for a sun at Z from the zenith.
    let z = acos(0.85598);
    let wanted = 44.43
        * (1.0 - 0.980538 * exp(-0.268892))
        * (1.0 + 13.054283 * exp(-3.487938 * z) + 0.156107 * 0.7327);
    let found = map.texel(0, 0).g / (0.9 * LUMENS);
    assert!((found / wanted - 1.0).abs() < 0.01, "{found}, not {wanted}");
    assert!((map.texel(0, map.height() - 1).r - 24.21 * 1.4 * LUMENS).abs() < 1e-3);
}

/// Objects of OBJ files may be called as shapes and materials of Radiance are.
#[test]
fn objects_of_obj_are_no_statements() {
    for name in ["sphere", "light", "glass"] {
        for first in ["0 0 1", "0 0 0", "0.5 0 1", "0 1 0", "1 0 0"] {
            let text = format!("o {name}\nv {first}\nv 2 0 0\nv 0 3 0\nf 1 2 3\n");
            let scene =
                bilux_formats::read_bytes(text.as_bytes(), "", None, "a", &ReadOptions::default()).unwrap();
            assert_eq!(scene.objects[0].mesh.triangles.len(), 1, "{name}, {first}");
        }
    }
    let scene = bilux_formats::read_bytes(
        b"void light l\n0\n0 # none\n3 1 1 1\nl sphere s 0 0 # place, radius\n4 0 0 1 .5",
        "",
        None,
        "a",
        &ReadOptions::default(),
    );
    let scene = scene.unwrap();
    assert_eq!(scene.objects.len() + scene.lights.len(), 1);
}

//! pbrt scenes: what is read, and the warnings about everything else.

use crate::{read_text, refusal, warnings};
use bilux_formats::{FormatError, ReadOptions, read};
use bilux_math::transcendental::{atan, sin_cos, tan};
use bilux_math::{Rgb, Vec3};

use bilux_scene::{CameraSample, SceneBuilder, Spec, Value};
use std::io::Write;
use std::path::Path;

const TRIANGLE: &str = r#"Shape "trianglemesh" "point3 P" [0 0 0  1 0 0  0 1 0]"#;

fn scene(text: &str) -> SceneBuilder {
    let scene = read_text("pbrt", text).unwrap_or_else(|error| panic!("{text}: {error}"));
    if let Err(error) = scene.build(&Default::default(), [0.0, 1.0], 1.0) {
        panic!("{text}: {error}");
    }
    scene
}

fn world(text: &str) -> SceneBuilder {
    scene(&format!("WorldBegin\n{text}"))
}

/// The material of the first object, after a line of a file.
fn material(line: &str) -> Spec {
    let scene = world(&format!("{line}\n{TRIANGLE}"));
    assert_eq!(warnings(&scene), "", "{line}");
    scene.materials[scene.objects[0].material].clone()
}

fn number(spec: &Spec, key: &str) -> f32 {
    match spec.parameters.find(key) {
        Some((Value::Number(x), _)) => *x as f32,
        other => panic!("{key}: {other:?}"),
    }
}

fn colour(spec: &Spec, key: &str) -> Rgb {
    match spec.parameters.find(key) {
        Some((Value::List(c), _)) => {
            let channel = |i: usize| if let Value::Number(x) = c[i] { x as f32 } else { f32::NAN };
            Rgb::new(channel(0), channel(1), channel(2))
        }
        other => panic!("{key}: {other:?}"),
    }
}

#[track_caller]
fn close(a: Rgb, b: [f32; 3]) {
    assert!((0..3).all(|c| (a[c] - b[c]).abs() < 2e-3 * b[c].abs().max(1.0)), "{a:?} {b:?}");
}

#[test]
fn settings_camera_and_film_are_read() {
    let scene = scene(
        r#"
        LookAt 0 0 5  0 0 0  0 1 0
        Camera "perspective" "float fov" [60]
        Film "rgb" "integer xresolution" [100] "integer yresolution" [200] "float iso" [200]
        PixelFilter "triangle" "float xradius" [1] "float yradius" [1]
        Sampler "zsobol" "integer pixelsamples" [64]
        Integrator "volpath" "integer maxdepth" [7]
        WorldBegin
        LightSource "point" "rgb I" [1 2 3] "point3 from" [0 0 2]"#,
    );
    let setting = |key: &str| scene.settings.find(key).unwrap().0.clone();
    assert_eq!(setting("size"), "100x200".into());
    assert_eq!(setting("filter"), "tent".into());
    assert_eq!((setting("spp"), setting("max_depth")), (Value::Integer(64), Value::Integer(7)));
    let camera = &scene.cameras[0].spec;
    // The 60 degrees apply to the width, which is the shorter side.
    assert!((number(camera, "fov") - 2.0 * atan(2.0 * tan(30f32.to_radians())).to_degrees()).abs() < 1e-3);
    assert_eq!(camera.parameters.find("mirrored").map(|(v, _)| v.clone()), Some(true.into()));
    close(colour(camera, "position"), [0.0, 0.0, 5.0]);
    // Doubling the ISO doubles all light.
    close(colour(&scene.lights[0], "intensity"), [2.0, 4.0, 6.0]);
    assert_eq!(warnings(&scene), "");
}

#[test]
fn pictures_are_not_mirrored() {
    // Without any transform, x points right, y up, and the camera looks along z.
    let scene = scene(&format!("Camera \"perspective\"\nWorldBegin\n{TRIANGLE}"));
    let built = scene.build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    let camera = &built.cameras()[0].1;
    let seen = camera.connect(Vec3::new(0.5, 0.25, 2.0), bilux_math::Vec2::ZERO, 0.0).unwrap();
    assert!(seen.film.x > 0.5 && seen.film.y < 0.5, "{seen:?}");
    let scene = self::scene(&format!("Camera \"orthographic\"\nWorldBegin\n{TRIANGLE}"));
    let built = scene.build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    let seen = built.cameras()[0].1.connect(Vec3::new(0.5, 0.25, 2.0), bilux_math::Vec2::ZERO, 0.0).unwrap();
    assert!((seen.film.x - 0.75).abs() < 1e-5 && (seen.film.y - 0.375).abs() < 1e-5, "{seen:?}");
}

/// pbrt's definition, in its own camera: from the right (+x) over ahead (+z) to the left, and from above to below.
#[test]
fn spherical_cameras_see_everything_as_in_pbrt() {
    for (turned, mirrors) in [("", false), ("LookAt 1 2 3  4 1 0  0.1 1 0", false), ("Scale -1 1 1", true)] {
        let text = format!(
            "{turned}\nCamera \"spherical\" \"string mapping\" [\"equirectangular\"]\nWorldBegin\n{TRIANGLE}"
        );
        let scene = scene(&text);
        assert_eq!(warnings(&scene), "");
        let camera = scene.build(&Default::default(), [0.0, 1.0], 2.0).unwrap().cameras()[0].1.clone();
        let to_camera = camera.matrices(0.0).to_camera;
        for (u, v) in [(0.1f32, 0.3f32), (0.25, 0.5), (0.6, 0.7), (0.9, 0.45)] {
            let sample =
                CameraSample { film: bilux_math::Vec2::new(u, v), lens: bilux_math::Vec2::ZERO, time: 0.0 };
            let ray = camera.ray(&sample);
            let (theta, phi) = (std::f32::consts::PI * v, 2.0 * std::f32::consts::PI * u);
            let ([sin, cos], [up, along]) =
                ([sin_cos(phi).0, sin_cos(phi).1], [sin_cos(theta).1, sin_cos(theta).0]);
            let own = Vec3::new(along * cos, up, along * sin);
            let expected = match turned {
                "" => own,
                "Scale -1 1 1" => own * Vec3::new(-1.0, 1.0, 1.0),
                _ => {
                    // LookAt: z ahead, x = up × z in pbrt's left-handed space.
                    let ahead = Vec3::new(3.0, -1.0, -3.0).normalize();
                    let right = Vec3::new(0.1, 1.0, 0.0).normalize().cross(ahead).normalize();
                    right * own.x + ahead.cross(right) * own.y + ahead * own.z
                }
            };
            let direction = Vec3::from(ray.direction);
            assert!(direction.distance(expected) < 1e-5, "{turned} {u} {v}: {direction} not {expected}");
        }
        assert!(to_camera.is_finite() && (mirrors || turned != "Scale -1 1 1"));
    }
    let scene = scene(&format!("Camera \"spherical\"\nWorldBegin\n{TRIANGLE}"));
    assert!(warnings(&scene).contains("'equalarea' is not supported"), "{}", warnings(&scene));
}

#[test]
fn screen_windows_are_shifted_and_stretched() {
    let text = "Camera \"perspective\" \"float fov\" [90] \"float screenwindow\" [-0.5 1.5 -2 0.5]";
    let text = format!(
        "Film \"rgb\" \"integer xresolution\" [100] \"integer yresolution\" [100]\n{text}\nWorldBegin\n{TRIANGLE}"
    );
    let scene = scene(&text);
    assert_eq!(warnings(&scene), "");
    let camera = scene.build(&Default::default(), [0.0, 1.0], 1.0).unwrap().cameras()[0].1.clone();
    for (x, y) in [(0.0f32, 0.0f32), (1.0, -1.5), (-0.4, 0.3)] {
        let seen = camera.project(Vec3::new(x, y, 1.0), 0.0).unwrap();
        let expected = bilux_math::Vec2::new((x + 0.5) / 2.0, (0.5 - y) / 2.5);
        assert!(seen.distance(expected) < 1e-5, "{x} {y}: {seen} not {expected}");
    }
}

#[test]
fn realistic_cameras_are_thin_lenses() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.pbrt");
    // A thin lens of 50 mm.
    std::fs::write(
        folder.path().join("lens.dat"),
        "# radius, thickness, index, width\n50 0 1.5 20\n-50 0 1 20\n0 50 0 10\n",
    )
    .unwrap();
    let text = format!(
        "Film \"rgb\" \"integer xresolution\" [100] \"integer yresolution\" [100]\nCamera \"realistic\" \"string lensfile\" \"lens.dat\" \"float aperturediameter\" [8] \"float focusdistance\" [2]\nWorldBegin\n{TRIANGLE}"
    );
    std::fs::write(&file, &text).unwrap();
    let scene = bilux_formats::read(&file, &Default::default()).unwrap();
    assert!(warnings(&scene).contains("thin lens of 50.0 mm"), "{}", warnings(&scene));
    let camera = &scene.cameras[0].spec;
    // The film is farther away than the focal length: 1/50 = 1/2000 + 1/v.
    let v = 1.0 / (1.0 / 50.0 - 1.0 / 2000.0);
    let fov = 2.0 * atan(0.5 * 35.0 / 2f32.sqrt() / v).to_degrees();
    assert!((number(camera, "fov") - fov).abs() < 1e-3);
    assert!(
        (number(camera, "aperture") - 0.004).abs() < 1e-6 && (number(camera, "focus") - 2.0).abs() < 1e-6
    );
    for (lens, expected) in
        [("50 0 1.5", "four numbers for each surface"), ("-50 0 1.5 20", "forms no picture")]
    {
        std::fs::write(folder.path().join("lens.dat"), lens).unwrap();
        let error = bilux_formats::read(&file, &Default::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn transforms_and_attributes_nest() {
    let scene = world(&format!(
        r#"
        Translate 1 0 0
        AttributeBegin
            Scale 2 2 2
            Rotate 90 0 0 1
            {TRIANGLE}
        AttributeEnd
        {TRIANGLE}
        CoordinateSystem "here"
        Identity
        {TRIANGLE}
        CoordSysTransform "here"
        {TRIANGLE}"#
    ));
    let corner = |i: usize| scene.objects[i].motion.at(0.0).point(Vec3::X);
    assert!((corner(0) - Vec3::new(1.0, 2.0, 0.0)).length() < 1e-6);
    assert_eq!(corner(1), Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(corner(2), Vec3::X);
    assert_eq!(corner(3), corner(1));
}

#[test]
fn moving_objects_have_two_keyframes() {
    let scene = scene(&format!(
        r#"Camera "perspective" "float shutterclose" [0.5]
        TransformTimes 0 2
        WorldBegin
        ActiveTransform EndTime
        Translate 4 0 0
        ActiveTransform All
        {TRIANGLE}"#
    ));
    let at = |time| scene.objects[0].motion.at(time).point(Vec3::ZERO);
    assert_eq!((at(0.0), at(1.0), at(2.0)), (Vec3::ZERO, Vec3::X * 2.0, Vec3::X * 4.0));
    assert_eq!(scene.settings.find("shutter").unwrap().0, &Value::from(0.5f32));
}

/// [pbrt 2023, 7.1.2 and 2.10]: the transform of an instance is interpolated on its own and applied to the shapes in it; that of
/// a single shape is interpolated as a whole, so its translation is linear.
#[test]
fn shapes_of_an_instance_that_turns_move_along_an_arc() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turning = "ActiveTransform EndTime\nRotate 90 0 0 1\nActiveTransform All\nScale 0.5 1 1";
    let scene = world(&format!(
        r#"
        ObjectBegin "arm"
            Translate 2 0 0
            {TRIANGLE}
            ActiveTransform EndTime
            Translate 0 4 0
            ActiveTransform All
            {TRIANGLE}
        ObjectEnd
        Translate 0 0 7
        {turning}
        ObjectInstance "arm"
        Translate 2 0 0
        {TRIANGLE}"#
    ));
    assert_eq!(warnings(&scene), "");
    let midway = |i: usize| scene.objects[i].motion.at(0.5).point(Vec3::ZERO);
    // (2, 0) in the object is at (1, 0) of the space that turns by 45 degrees.
    let near = |a: Vec3, b: Vec3| assert!(a.abs_diff_eq(b, 1e-5), "{a} instead of {b}");
    near(midway(1), Vec3::new(half, half, 7.0));
    // (2, 2) is at (1, 2) there.
    near(midway(2), Vec3::new(half - 2.0 * half, half + 2.0 * half, 7.0));
    // The shape's own transform goes from (1, 0) to (0, 1) in a line.
    near(midway(0), Vec3::new(0.5, 0.5, 7.0));
}

/// [pbrt 2023, 2.10]: rotations are interpolated at constant angular speed, translations along a line.
#[test]
fn cameras_that_turn_do_so_at_constant_speed() {
    for (degrees, start, end) in [(90.0f32, 0.0f32, 1.0f32), (170.0, 0.0, 1.0), (90.0, 2.0, 6.0)] {
        let scene = scene(&format!(
            r#"
            TransformTimes {start} {end}
            ActiveTransform EndTime
            Rotate {degrees} 0 1 0
            ActiveTransform All
            Translate -1 0 0
            ActiveTransform EndTime
            Translate -2 0 0
            ActiveTransform All
            Camera "perspective" "float fov" [40]
            WorldBegin
            {TRIANGLE}"#
        ));
        let camera = bilux_scene::cameras::build(&scene.cameras[0], 1.0).unwrap();
        for time in [0.0f32, 0.1, 0.25, 0.5, 0.9, 1.0] {
            // `Rotate` turns the world about the camera, so the camera turns the other way.
            let (sin, cos) = sin_cos(-(degrees * time).to_radians());
            let expected = Vec3::new(sin, 0.0, cos);
            let moment = start + (end - start) * time;
            let forward = camera.forward(moment);
            assert!(forward.abs_diff_eq(expected, 2e-5), "{degrees} at {moment}: {forward} for {expected}");
            let position = camera.matrices(moment).to_camera.inverse().transform_point3(Vec3::ZERO);
            assert!(position.abs_diff_eq(Vec3::new(1.0 + 2.0 * time, 0.0, 0.0), 1e-4), "{time}: {position}");
        }
    }
}

#[test]
fn objects_are_put_where_they_are_used() {
    let scene = world(&format!(
        r#"
        ObjectBegin "thing"
            Translate 0 0 1
            {TRIANGLE}
            Shape "sphere"
        ObjectEnd
        Translate 1 0 0
        ObjectInstance "thing"
        Translate 1 0 0
        ObjectInstance "thing""#
    ));
    assert_eq!(scene.objects.len(), 4);
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[2].mesh));
    assert_eq!(scene.objects[2].motion.at(0.0).point(Vec3::ZERO), Vec3::new(2.0, 0.0, 1.0));
    assert_eq!(scene.objects[2].name, "thing");
}

#[test]
fn shapes_are_as_large_as_they_say_and_face_outwards() {
    for (text, low, high) in [
        (r#"Shape "sphere" "float radius" [2]"#, [-2.0; 3], [2.0; 3]),
        (r#"Shape "sphere" "float zmin" [0]"#, [-1., -1., 0.], [1., 1., 1.]),
        (r#"Shape "disk" "float height" [3]"#, [-1., -1., 3.], [1., 1., 3.]),
        (r#"Shape "cylinder" "float zmax" [4] "float phimax" [90]"#, [0., 0., -1.], [1., 1., 4.]),
        (r#"Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1]"#, [0.; 3], [1.; 3]),
        (
            r#"Shape "curve" "string type" "cylinder" "point3 P" [0 0 0 0 0 1 0 0 2 0 0 3] "float width" [.2]"#,
            [-0.1, -0.1, 0.0],
            [0.1, 0.1, 3.0],
        ),
    ] {
        let scene = world(text);
        let object = &scene.objects[0];
        let bounds = scene.bounds(0.0);
        assert!((bounds.min - Vec3::from(low)).abs().max_element() < 1e-3, "{text}: {bounds:?}");
        assert!((bounds.max - Vec3::from(high)).abs().max_element() < 1e-3, "{text}: {bounds:?}");
        for t in &object.mesh.triangles {
            let [a, b, c] = t.map(|i| object.mesh.positions[i as usize]);
            let normal: Vec3 = t.iter().map(|i| object.mesh.normals[*i as usize]).sum();
            assert!((b - a).cross(c - a).dot(normal) > 0.0, "{text}: {t:?}");
        }
    }
    let scene = world(&format!("ReverseOrientation\n{TRIANGLE}"));
    assert_eq!(scene.objects[0].mesh.triangles, [[0, 2, 1]]);
    let smooth = world(
        r#"Shape "loopsubdiv" "integer levels" [2] "point3 P" [1 1 1 -1 -1 1 -1 1 -1 1 -1 -1]
        "integer indices" [0 2 1 0 1 3 0 3 2 1 2 3]"#,
    );
    assert_eq!(smooth.objects[0].mesh.triangles.len(), 4 * 16);
}

#[test]
fn materials_are_mapped() {
    close(
        colour(&material(r#"Material "diffuse" "rgb reflectance" [.1 .2 .3]"#), "reflectance"),
        [0.1, 0.2, 0.3],
    );
    // The default is a grey of 0.5.
    close(colour(&material(r#"Material "diffuse""#), "reflectance"), [0.5; 3]);
    assert_eq!(number(&material(""), "reflectance"), 0.5);
    let metal = material(r#"Material "conductor" "spectrum eta" "metal-Ag-eta" "spectrum k" "metal-Ag-k""#);
    close(colour(&metal, "eta"), [0.130, 0.124, 0.151]);
    close(colour(&metal, "k"), [4.118, 3.335, 2.411]);
    let rough = material(r#"Material "conductor" "float roughness" [.0625] "bool remaproughness" false"#);
    close(colour(&rough, "eta"), [0.215, 0.975, 1.209]);
    assert!((number(&rough, "roughness") - 0.25).abs() < 1e-6);
    let rough = material(r#"Material "conductor" "float roughness" [.0625]"#);
    assert!((number(&rough, "roughness") - 0.5).abs() < 1e-6);
    let brushed = material(
        r#"Material "conductor" "float uroughness" .4 "float vroughness" .1 "bool remaproughness" false"#,
    );
    assert!((number(&brushed, "anisotropy") - 0.75).abs() < 1e-6);
    assert_eq!(number(&brushed, "rotation"), 90.0);
    let glass = material(r#"Material "dielectric" "spectrum eta" [400 1.6 700 1.6]"#);
    assert_eq!((glass.kind.as_str(), number(&glass, "eta")), ("dielectric", 1.6));
    assert_eq!(material(r#"Material "thindielectric""#).parameters.find("thin").unwrap().0, &true.into());
    // Accounts for the light that the boundary reflects back to the base.
    let paint = material(r#"Material "coateddiffuse" "rgb reflectance" [.5 .5 .5] "float roughness" 0"#);
    close(colour(&paint, "base_color"), [0.5 * 0.4036 / (1.0 - 0.5 * 0.5964); 3]);
    assert_eq!(
        material(r#"Material "coatedconductor""#).parameters.find("coat_weight").unwrap().0,
        &1f32.into()
    );
    let mirror = material(r#"Material "conductor" "rgb reflectance" [.25 .25 .25]"#);
    close(colour(&mirror, "k"), [(4f32 * 0.25 / 0.75).sqrt(); 3]);
    let leaf = material(
        r#"Material "diffusetransmission" "rgb reflectance" [.1 .3 .1] "rgb transmittance" [.2 .6 .1]"#,
    );
    assert!((number(&leaf, "diffuse_transmission_weight") - 2.0 / 3.0).abs() < 1e-6);
    close(colour(&leaf, "base_color"), [0.3, 0.9, 0.3]);
    close(colour(&leaf, "diffuse_transmission_color"), [0.3, 0.9, 0.15]);
    let old = material(r#"Material "matte" "color Kd" [.3 .3 .3]"#);
    close(colour(&old, "reflectance"), [0.3; 3]);
}

#[test]
fn mixes_and_names_may_come_later() {
    let scene = world(&format!(
        r#"
        MakeNamedMaterial "both" "string type" "mix" "string materials" ["a" "b"] "float amount" [.25]
        NamedMaterial "both"
        {TRIANGLE}
        MakeNamedMaterial "a" "string type" "diffuse"
        MakeNamedMaterial "b" "string type" "conductor""#
    ));
    let mix = &scene.materials[scene.objects[0].material];
    assert_eq!((mix.kind.as_str(), mix.name.as_str(), number(mix, "amount")), ("mix", "both", 0.25));
    assert_eq!(warnings(&scene), "");
}

#[test]
fn lights_shine_as_much_as_they_say() {
    let scene = world(
        r#"
        LightSource "point" "rgb I" [1 1 1] "float scale" [3]
        LightSource "point" "float power" [12.566371]
        LightSource "distant" "blackbody L" [6500] "point3 from" [0 5 0] "point3 to" [0 0 0]
        LightSource "infinite" "rgb L" [.5 .6 .7]
        LightSource "spot" "spectrum I" [300 7 900 7] "float coneangle" [40] "float conedeltaangle" [10]
        LightSource "distant" "spectrum L" "stdillum-A" "float scale" [2]"#,
    );
    let light = |i: usize, key| colour(&scene.lights[i], key);
    close(light(0, "intensity"), [3.0; 3]);
    close(light(1, "intensity"), [1.0; 3]);
    let warm = light(2, "irradiance");
    assert!((warm.luminance() - 1.0).abs() < 2e-3 && warm.r > warm.b, "{warm:?}");
    close(light(2, "direction"), [0.0, -1.0, 0.0]);
    close(light(3, "radiance"), [0.5, 0.6, 0.7]);
    let even = light(4, "intensity");
    // A spectrum has a luminance of 1, whatever its values; this one is slightly pinker than daylight.
    assert!((even.luminance() - 1.0).abs() < 2e-3 && even.r > 1.0, "{even:?}");
    assert_eq!((number(&scene.lights[4], "angle"), number(&scene.lights[4], "inner_angle")), (40.0, 30.0));
    let tungsten = light(5, "irradiance");
    assert!((tungsten.luminance() - 2.0).abs() < 4e-3 && tungsten.r > 3.0, "{tungsten:?}");
    assert_eq!(warnings(&scene), "");
}

#[test]
fn surfaces_give_light_on_their_side() {
    let light = r#"AreaLightSource "diffuse" "rgb L" [1 2 3] "float scale" [2]"#;
    let glowing = |text: &str| {
        let scene = world(&format!("{light}\n{text}"));
        scene.materials[scene.objects[0].material].clone()
    };
    let spec = glowing(TRIANGLE);
    close(colour(&spec, "emission"), [2.0, 4.0, 6.0]);
    assert_eq!(spec.parameters.find("emission_sides").unwrap().0, &"front".into());
    // Normals determine the front.
    let scene = world(&format!("{light}\n{TRIANGLE} \"normal N\" [0 0 -1 0 0 -1 0 0 -1]"));
    assert_eq!(scene.objects[0].mesh.triangles, [[0, 2, 1]]);
    // A black emissive sphere becomes a sphere light, which is round at any size.
    let black = r#"Material "diffuse" "rgb reflectance" [0 0 0]"#;
    let scene = world(&format!("{light}\n{black}\nTranslate 0 3 0\nScale 2 2 2\nShape \"sphere\""));
    assert_eq!((scene.objects.len(), scene.lights.len()), (0, 1));
    assert_eq!((scene.lights[0].kind.as_str(), number(&scene.lights[0], "radius")), ("sphere", 2.0));
    // One watt from a triangle of half a square unit.
    let spec = world(&format!("AreaLightSource \"diffuse\" \"float power\" [1]\n{TRIANGLE}"));
    let spec = &spec.materials[spec.objects[0].material];
    close(colour(spec, "emission"), [2.0 / std::f32::consts::PI; 3]);
    // The same power from both sides together.
    let both = r#"AreaLightSource "diffuse" "float power" [1] "bool twosided" true"#;
    let scene = world(&format!("{both}\n{TRIANGLE}"));
    let spec = &scene.materials[scene.objects[0].material];
    close(colour(spec, "emission"), [1.0 / std::f32::consts::PI; 3]);
}

#[test]
fn alpha_is_opacity() {
    let of = |alpha: &str| {
        let scene = world(&format!("Texture \"t\" \"float\" \"checkerboard\"\n{TRIANGLE} {alpha}"));
        assert_eq!(warnings(&scene).contains("nothing to render"), scene.objects.is_empty());
        let object = scene.objects.first()?;
        scene.materials[object.material].parameters.find("opacity").map(|(value, _)| value.clone())
    };
    assert_eq!(of(r#""float alpha" [.5]"#), Some(0.5f32.into()));
    assert!(matches!(of(r#""texture alpha" "t""#), Some(Value::Texture(_))));
    assert_eq!(of(r#""float alpha" [0]"#), None);
}

#[test]
fn media_absorb() {
    let scene = world(
        r#"
        MakeNamedMedium "ink" "string type" "homogeneous" "rgb sigma_a" [1 2 3] "rgb sigma_s" [0 0 0] "float scale" [10]
        MediumInterface "ink" ""
        Material "dielectric"
        Shape "sphere"
        Material "interface"
        Shape "sphere"
        MediumInterface "" ""
        Shape "sphere""#,
    );
    assert_eq!(scene.objects.len(), 2, "an interface with nothing behind is nothing");
    for object in &scene.objects {
        close(colour(&scene.materials[object.material], "absorption"), [10.0, 20.0, 30.0]);
    }
    assert_eq!(warnings(&scene), "");
}

#[test]
fn media_scatter_inside_interfaces_and_glass() {
    let scene = world(
        r#"
        MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [1 2 3] "rgb sigma_a" [.1 .2 .3] "float g" [.6] "float scale" [2]
        AttributeBegin
        MediumInterface "fog" ""
        Material "interface"
        Shape "sphere"
        AttributeEnd
        MediumInterface "" "fog"
        Material "interface"
        Shape "sphere" "float radius" .5
        MediumInterface "fog" ""
        Material "dielectric"
        Shape "sphere""#,
    );
    assert_eq!(warnings(&scene), "");
    let of = |i: usize| &scene.materials[scene.objects[i].material];
    let kinds: Vec<&str> = (0..3).map(|i| &*of(i).kind).collect();
    assert_eq!(kinds, ["interface", "interface", "dielectric"]);
    for i in [0, 2] {
        close(colour(of(i), "scattering"), [2.0, 4.0, 6.0]);
        close(colour(of(i), "absorption"), [0.2, 0.4, 0.6]);
        assert_eq!(of(i).number("scattering_anisotropy"), Some(0.6));
    }
    // A hole in the fog.
    assert!(of(1).colour("scattering").is_none());
}

#[test]
fn colour_spaces_hold_until_they_change() {
    let scene = world(&format!(
        "ColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .5 .4]\n{TRIANGLE}\n\
         LightSource \"point\" \"rgb I\" [0 1 0]"
    ));
    let c = colour(&scene.materials[scene.objects[0].material], "reflectance");
    assert!((c.r - 0.5).abs() < 0.02 && c.b < 0.4, "{c:?}");
    let green = colour(&scene.lights[0], "intensity");
    assert!(green.g > 1.1 && green.r == 0.0, "what Rec. 709 cannot show is cut: {green:?}");
}

#[test]
fn errors_state_their_location() {
    let mut missed = Vec::new();
    for (text, wanted) in [
        ("Shpae \"sphere\"", "scene.pbrt:1:1: there is no directive 'Shpae'; did you mean 'Shape'?"),
        (
            "WorldBegin\n  Shape \"sphrere\"",
            "scene.pbrt:2:3: there is no shape 'sphrere'; did you mean 'sphere'?",
        ),
        (
            "WorldBegin Shape \"disk\" \"flaot radius\" 1",
            "scene.pbrt:1:25: there is no type 'flaot' of parameters; did you mean 'float'?",
        ),
        (
            "WorldBegin Shape \"disk\" \"float radius\" [1 x]",
            "scene.pbrt:1:43: 'radius' takes numbers, not 'x'",
        ),
        ("WorldBegin Shape \"disk\" \"float radius\" [1 2]", "'radius' must be one number, not 2 numbers"),
        ("WorldBegin Shape \"disk\" \"float radius\" [1", "the file ends here, but ']'"),
        ("WorldBegin Shape \"disk\" \"float\" [1]", "'float' does not declare a parameter"),
        ("WorldBegin Shape \"trianglemesh\"", "P (points of the shape) is missing"),
        ("WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1]", "'P' must be triples of numbers"),
        (
            "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1] \"integer indices\" [0 1 2]",
            "scene.pbrt:1:58: 'indices' refers to vertex 2, but there are only 2",
        ),
        ("WorldBegin\nTransform [1 0 0 0 0 nan 0 0 0 0 1 0 0 0 0 1]", "must be finite, not NaN"),
        ("Scale 1e200 1 1 Scale 1e200 1 1", "this transform overflows"),
        ("LookAt 0 0 0 0 0 0 0 1 0", "scene.pbrt:1:1: a camera must not look along its own up"),
        ("WorldBegin AttributeBegin", "scene.pbrt:1:12: what begins here is not closed"),
        ("WorldBegin AttributeEnd", "never begun"),
        ("WorldBegin ObjectBegin \"a\" AttributeEnd", "the object 'a' is not closed before the file ends"),
        ("WorldBegin ObjectInstance \"a\"", "there is no object 'a', nor any other"),
        ("WorldBegin NamedMaterial \"gold\" Shape \"sphere\"", "there is no material 'gold', nor any other"),
        ("WorldBegin Material \"difuse\" Shape \"sphere\"", "did you mean 'diffuse'?"),
        (
            "WorldBegin Material \"diffuse\" \"texture reflectance\" \"wood\" Shape \"sphere\"",
            "there is no texture 'wood'",
        ),
        ("WorldBegin LightSource \"pint\"", "there is no light 'pint'; did you mean 'point'?"),
        (
            "WorldBegin LightSource \"point\" \"spectrum I\" [500 1 400 1]",
            "must increase, but 500 is followed by 400",
        ),
        (
            "WorldBegin LightSource \"point\" \"spectrum I\" \"metal-Xu-k\"",
            "there is no spectrum or file 'metal-Xu-k'; did you mean",
        ),
        ("Camera \"perspectiv\"", "did you mean 'perspective'?"),
        ("WorldBegin Camera \"perspective\"", "belongs before WorldBegin"),
        ("Include \"other.pbrt\"", "was not read from a folder"),
        (
            "WorldBegin Texture \"a\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" Material \"diffuse\" \"texture reflectance\" \"a\" Shape \"sphere\"",
            "the texture 'a' contains itself",
        ),
        (
            "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"] NamedMaterial \"a\" Shape \"sphere\"",
            "or contain themselves",
        ),
        ("WorldBegin MediumInterface \"x\" Shape \"sphere\"", "there is no medium 'x', nor any other"),
    ] {
        let reported = refusal("pbrt", text);
        if !reported.contains(wanted) || !reported.contains("scene.pbrt") {
            missed.push(format!("{text}\n{reported}\n{wanted}"));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n\n"));
}

#[test]
fn glass_disperses_by_its_name_or_its_spectrum() {
    for (eta, wanted) in [
        ("\"spectrum eta\" \"glass-BK7\"", Some((1.5168, 20.0 / 64.17))),
        ("\"spectrum eta\" [ 400 1.54 486.13 1.51 587.6 1.5 656.27 1.49 700 1.48 ]", Some((1.5, 0.8))),
        ("\"spectrum eta\" [ 400 1.5 700 1.5 ]", None),
        ("\"float eta\" 1.5", None),
    ] {
        let scene = world(&format!("Material \"dielectric\" {eta} Shape \"sphere\""));
        assert_eq!(warnings(&scene), "");
        let glass = scene.materials.iter().find(|spec| spec.kind == "dielectric").unwrap();
        let number = |key: &str| match glass.parameters.find(key) {
            Some((Value::Number(number), _)) => Some(*number),
            _ => None,
        };
        match wanted {
            Some((index, dispersion)) => {
                assert!((number("eta").unwrap() - index).abs() < 1e-4, "{eta}");
                assert!((number("dispersion").unwrap() - dispersion).abs() < 1e-3, "{eta}");
            }
            None => assert_eq!(number("dispersion"), None, "{eta}"),
        }
    }
}

/// Below a surface light is scattered by coefficients, measured or given, or so that it has a colour.
#[test]
fn subsurface_is_a_medium_below_a_surface() {
    let spec = |parameters: &str| material(&format!("Material \"subsurface\" {parameters}"));
    let near = |found: Rgb, wanted: [f32; 3]| {
        assert!(
            (0..3).all(|c| (found[c] - wanted[c]).abs() < 1e-4 * wanted[c].max(1e-3)),
            "{found:?}, not {wanted:?}"
        );
    };
    let marble =
        spec("\"string name\" \"Marble\" \"float scale\" 10 \"float eta\" 1.5 \"float roughness\" 0.09");
    assert_eq!(marble.kind, "dielectric");
    near(colour(&marble, "scattering"), [21.9, 26.2, 30.0]);
    near(colour(&marble, "absorption"), [0.021, 0.041, 0.071]);
    assert!(number(&marble, "roughness") > 0.0);
    let given = spec("\"rgb sigma_s\" [1 2 3] \"rgb sigma_a\" [0.1 0.2 0.3] \"float g\" 0.7");
    near(colour(&given, "scattering"), [1.0, 2.0, 3.0]);
    assert!((number(&given, "scattering_anisotropy") - 0.7).abs() < 1e-6);
    assert!((number(&given, "eta") - 1.33).abs() < 1e-6);
    let skin = spec("\"rgb reflectance\" [0.8 0.5 0.4] \"rgb mfp\" [0.01 0.005 0.002]");
    assert_eq!(skin.kind, "principled");
    near(colour(&skin, "subsurface_color"), [0.8, 0.5, 0.4]);
    near(colour(&skin, "subsurface_radius_scale"), [1.0, 0.5, 0.2]);
    assert!((number(&skin, "subsurface_radius") - 0.01).abs() < 1e-6);
    assert_eq!(number(&skin, "subsurface_weight"), 1.0);
}

#[test]
fn unsupported_features_give_warnings() {
    for (text, wanted) in [
        (
            "Shape \"disk\" \"float raduis\" 2",
            "scene.pbrt:2:14: 'raduis' of the shape 'disk' is not used; did you mean 'radius'?",
        ),
        ("Material \"hair\" Shape \"sphere\"", "hair is shown as opaque glossy fibres"),
        (
            "Material \"subsurface\" \"string name\" \"Wood\" Shape \"sphere\"",
            "the measured medium 'Wood' is not known",
        ),
        (
            "Material \"coateddiffuse\" \"spectrum eta\" \"glass-BK7\" Shape \"sphere\"",
            "refracted with the index at 587.6 nm",
        ),
        (
            "Texture \"n\" \"float\" \"fbm\" Material \"diffuse\" \"texture displacement\" \"n\" Shape \"sphere\"",
            "displacement of a material is not supported",
        ),
        (
            "Texture \"n\" \"spectrum\" \"marble\" Material \"diffuse\" \"texture reflectance\" \"n\" Shape \"sphere\"",
            "the texture 'marble' is not supported",
        ),
        ("LightSource \"goniometric\" \"string filename\" \"a.exr\"", "shines uniformly in all directions"),
        ("Scale 0 1 1 Shape \"sphere\"", "objects with a scale of zero are not rendered"),
        ("Shape \"cone\" Shape \"sphere\"", "the pbrt-v3 shape 'cone' is left out"),
    ] {
        let reported = warnings(&world(text));
        assert!(reported.contains(wanted), "{text}\n{reported}\n{wanted}");
    }
}

#[test]
fn procedural_textures_are_evaluated() {
    let of = |lines: &str| {
        let scene =
            world(&format!("{lines}\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n{TRIANGLE}"));
        assert_eq!(warnings(&scene), "", "{lines}");
        let spec = &scene.materials[scene.objects[0].material];
        match spec.parameters.find("reflectance").unwrap().0 {
            Value::Texture(i) => {
                let texture = scene.textures[*i].clone();
                Box::new(move |u, v| texture.at(bilux_math::Vec2::new(u, v))) as Box<dyn Fn(f32, f32) -> Rgb>
            }
            _ => {
                let c = colour(spec, "reflectance");
                Box::new(move |_, _| c)
            }
        }
    };
    let board = of(
        r#"Texture "t" "spectrum" "checkerboard" "float uscale" 4 "rgb tex1" [.8 .8 .8] "rgb tex2" [.1 .2 .3]"#,
    );
    close(board(0.1, 0.5), [0.8; 3]);
    close(board(0.3, 0.5), [0.1, 0.2, 0.3]);
    let scaled = of(r#"Texture "a" "spectrum" "constant" "rgb value" [.5 .5 1]
        Texture "t" "spectrum" "scale" "texture tex" "a" "float scale" .5"#);
    close(scaled(0.0, 0.0), [0.25, 0.25, 0.5]);
    let mixed = of(r#"Texture "b" "float" "checkerboard"
        Texture "t" "spectrum" "mix" "rgb tex1" [0 0 0] "rgb tex2" [1 .5 0] "texture amount" "b""#);
    close(mixed(0.5, 0.5), [1.0, 0.5, 0.0]);
    let ramp = of(
        r#"Texture "t" "spectrum" "bilerp" "rgb v00" [0 0 0] "rgb v10" [1 0 0] "rgb v01" [0 1 0] "rgb v11" [1 1 0]"#,
    );
    close(ramp(0.25, 0.75), [0.25, 0.75, 0.0]);
    let both = of(r#"Texture "a" "spectrum" "checkerboard" "float vscale" 2
        Texture "b" "spectrum" "checkerboard" "float uscale" 2
        Texture "t" "spectrum" "scale" "texture tex1" "a" "texture tex2" "b""#);
    close(both(0.25, 0.25), [1.0; 3]);
    close(both(0.75, 0.25), [0.0; 3]);
}

fn in_folder(files: &[(&str, &[u8])]) -> (tempfile::TempDir, Result<SceneBuilder, FormatError>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    let path = folder.path().join(files[0].0);
    let options = ReadOptions { max_memory: 32 << 20, ..ReadOptions::default() };
    let result = read(&path, &options);
    (folder, result)
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn files_are_included_and_unpacked() {
    let main = b"WorldBegin\nTranslate 0 0 1\nImport \"parts/a.pbrt\"\nInclude \"parts/b.pbrt.gz\"\nShape \"sphere\"";
    let (_folder, scene) = in_folder(&[
        ("main.pbrt", main),
        ("parts/a.pbrt", b"Translate 5 0 0 Shape \"plymesh\" \"string filename\" \"parts/t.ply.gz\""),
        ("parts/b.pbrt.gz", &packed(b"Translate 0 7 0")),
        ("parts/t.ply.gz", &packed(PLY.as_bytes())),
        ("parts/t.ply", PLY.as_bytes()),
    ]);
    let scene = scene.unwrap();
    let at = |i: usize| scene.objects[i].motion.at(0.0).point(Vec3::ZERO);
    assert_eq!((at(0), at(1)), (Vec3::new(5.0, 0.0, 1.0), Vec3::new(0.0, 7.0, 1.0)));
    assert!(scene.objects[0].mesh.normals.is_empty(), "flat without normals");
}

/// The scene of a dragon from pbrt-v3 has a 0 in the corner before its infinite light.
#[test]
fn a_matrix_that_is_not_affine_is_used_as_far_as_it_is() {
    let place = |matrix: &str| {
        let scene = world(&format!("ConcatTransform [{matrix}]\n{TRIANGLE}"));
        assert!(warnings(&scene).contains("scene.pbrt:2:1: a matrix does not end in the row 0 0 0 1"));
        let motion = scene.objects[0].motion.at(0.0);
        [motion.point(Vec3::ZERO), motion.vector(Vec3::X)]
    };
    assert_eq!(place("0 0 1 0  0 1 0 0  -1 0 0 0  5 6 7 0"), [Vec3::new(5.0, 6.0, 7.0), Vec3::Z]);
    assert_eq!(place("1 0 0 9  0 1 0 9  0 0 1 9  5 6 7 3"), [Vec3::new(5.0, 6.0, 7.0), Vec3::X]);
    // Doubled homogeneous coordinates halve the size.
    assert_eq!(place("4 0 0 0  0 4 0 0  0 0 4 0  2 2 2 2"), [Vec3::ONE, Vec3::X * 2.0]);
    let turned =
        r#"ConcatTransform [0 0 1 0  0 1 0 0  -1 0 0 0  0 0 0 0] LightSource "infinite" "rgb L" [1 1 1]"#;
    assert_eq!(world(turned).lights.len(), 1);
}

/// A courtyard of version 3 interleaves them, which pbrt accepts, since it keeps one stack for both.
#[test]
fn objects_and_attributes_may_cross() {
    let crossed = format!(
        "AttributeBegin\nObjectBegin \"a\"\nTranslate 1 0 0\n{TRIANGLE}\nAttributeEnd\nObjectEnd\nObjectInstance \"a\""
    );
    let scene = world(&crossed);
    assert!(warnings(&scene).contains("are not properly nested"));
    assert_eq!(scene.objects.len(), 1);
    assert_eq!(scene.objects[0].motion.at(0.0).point(Vec3::ZERO), Vec3::X);
}

#[test]
fn integrators_of_version_2_are_understood() {
    let text = "SurfaceIntegrator \"path\" \"integer maxdepth\" 7\nVolumeIntegrator \"emission\"\nRenderer \"sampler\"\nWorldBegin";
    let scene = scene(text);
    assert_eq!(scene.settings.find("max_depth").unwrap().0, &Value::Integer(7));
    assert!(warnings(&scene).contains("'renderer' of pbrt-v2 is not used"));
}

#[test]
fn a_missing_sky_is_grey_and_so_is_any_light() {
    for light in [
        r#"LightSource "infinite" "string filename" "sky.exr""#,
        r#"LightSource "projection" "string filename" "slide.png""#,
    ] {
        let (_folder, scene) = in_folder(&[("a.pbrt", format!("WorldBegin\n{light}").as_bytes())]);
        let scene = scene.unwrap();
        let reported = warnings(&scene);
        assert!(
            reported.contains("a texture is replaced by a uniform grey of 0.5: there is no file"),
            "{reported}"
        );
        let parameters = &scene.lights[0].parameters;
        let is_grey = |c: Rgb| c.r == c.g && c.g == c.b && c.r > 0.0;
        match parameters.find("radiance") {
            Some((Value::Texture(i), _)) => {
                assert!(scene.textures[*i].texels().all(|c| c == Rgb::grey(0.5)), "{light}");
            }
            _ => assert!(is_grey(colour(&scene.lights[0], "intensity")), "{light}"),
        }
    }
}

/// First next to the scene, then in the working folder, but nowhere above it.
#[test]
fn files_are_looked_for_in_the_working_folder_too() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    let mesh = |name: &str| format!("Shape \"plymesh\" \"string filename\" \"{name}\"\n");
    let meshes = ["models/t.ply", "u.ply"].map(mesh).concat();
    put("work/scenes/a.pbrt", format!("WorldBegin\n{meshes}Include \"lib/more.pbrt\"").as_bytes());
    put("work/scenes/secret.pbrt", b"WorldBegin Include \"../../secret.txt\"");
    put("work/models/t.ply", PLY.as_bytes());
    put("work/lib/more.pbrt", mesh("u.ply").as_bytes());
    put("work/scenes/u.ply", PLY.as_bytes());
    put("work/u.ply", b"instead of this one");
    put("secret.txt", b"Shape");
    let working_folder = Some(folder.path().join("work"));
    let options = ReadOptions { working_folder, ..ReadOptions::default() };
    let scene = read(&folder.path().join("work/scenes/a.pbrt"), &options).unwrap();
    assert_eq!(scene.objects.len(), 3);
    let reported = |name: &str, options: &ReadOptions| {
        read(&folder.path().join("work/scenes").join(name), options).unwrap_err().to_string()
    };
    assert!(reported("a.pbrt", &ReadOptions::default()).contains("there is no file 'models/t.ply'"));
    assert!(reported("secret.pbrt", &options).contains("lies outside the scene's folder"));
}

#[test]
fn a_missing_include_of_the_scene_s_own_name_is_missing() {
    let (_folder, scene) = in_folder(&[("main.pbrt", b"Include \"geometry/main.pbrt\"")]);
    let reported = scene.unwrap_err().to_string();
    assert!(reported.contains("main.pbrt:1:9: there is no file 'geometry/main.pbrt'"), "{reported}");
}

/// Gold from a file, as in scenes of version 3: its red is above 1 in sRGB.
#[test]
fn gold_by_its_spectra_is_gold() {
    let eta = b"400 1.47\n450 1.38\n500 0.97\n550 0.42\n600 0.25\n650 0.15\n700 0.13\n850 0.17";
    let k = b"400 1.95\n450 1.91\n500 1.86\n550 2.48\n600 3.1\n650 3.6\n700 4.05\n850 5.3";
    let main = b"WorldBegin\nMaterial \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\" \"spectrum k\" \"spds/Au.k.spd\" \
                 Shape \"sphere\"\nMaterial \"coatedconductor\" \"spectrum conductor.eta\" \"spds/Au.eta.spd\" \
                 \"spectrum conductor.k\" \"spds/Au.k.spd\" Shape \"sphere\"";
    let (_folder, scene) = in_folder(&[("main.pbrt", main), ("spds/Au.eta.spd", eta), ("spds/Au.k.spd", k)]);
    let scene = scene.unwrap();
    scene.build(&Default::default(), [0.0, 1.0], 1.0).unwrap();
    assert!(warnings(&scene).contains("lies outside sRGB"));
    let gold = scene.materials.iter().find(|spec| spec.kind == "conductor").unwrap();
    let (eta, k) = (colour(gold, "eta"), colour(gold, "k"));
    assert!(eta.max_channel() < 2.0 && k.max_channel() < 6.0, "{eta:?} {k:?}");
}

#[test]
fn malicious_files_are_refused() {
    let refused = |files: &[(&str, &[u8])]| in_folder(files).1.map(|_| ()).unwrap_err().to_string();
    let reported = refused(&[("a.pbrt", b"Include \"b.pbrt\""), ("b.pbrt", b"\nInclude \"a.pbrt\"")]);
    assert!(reported.contains("b.pbrt:2:9: 'a.pbrt' includes itself"), "{reported}");
    let reported = refused(&[("a.pbrt", b"Include \"/etc/passwd\"")]);
    assert!(reported.contains("a.pbrt:1:9: '/etc/passwd' lies outside the scene's folder"), "{reported}");
    let reported = refused(&[("a.pbrt", b"Include \"nowhere.pbrt\"")]);
    assert!(reported.contains("there is no file 'nowhere.pbrt'"), "{reported}");
    let bomb = packed(&vec![b' '; 200 << 20]);
    assert!(bomb.len() < 1 << 20);
    let reported = refused(&[("a.pbrt", b"WorldBegin Include \"b.gz\""), ("b.gz", &bomb)]);
    assert!(reported.contains("takes more than the"), "{reported}");
    let reported = refused(&[("a.pbrt", b"WorldBegin Include \"b.gz\""), ("b.gz", &packed(b"Shape")[..20])]);
    assert!(reported.contains("b.gz: ") && reported.contains("cannot be decompressed"), "{reported}");
    // Each file includes the next one twice: 2^40 inclusions in all, but for the limit on the chain.
    let names: Vec<String> = (0..41).map(|i| format!("{i}.pbrt")).collect();
    let texts: Vec<String> = (1..42).map(|i| format!("Include \"{i}.pbrt\" Include \"{i}.pbrt\"")).collect();
    let files: Vec<(&str, &[u8])> =
        names.iter().zip(&texts).map(|(n, t)| (n.as_str(), t.as_bytes())).collect();
    assert!(refused(&files).contains("more than 32 levels deep"));
    let mut short = files[..30].to_vec();
    short[29].1 = b"#";
    assert!(refused(&short).contains("the includes multiply"));
}

#[test]
fn texts_that_would_take_for_ever_are_refused_soon() {
    let chain: String = (0..20_000)
        .map(|i| format!("Texture \"{}\" \"float\" \"scale\" \"texture tex\" \"{i}\"\n", i + 1))
        .collect();
    let user = "Material \"diffuse\" \"texture reflectance\" \"20000\" Shape \"disk\"";
    let reported = refusal("pbrt", format!("WorldBegin\n{chain}{user}"));
    assert!(reported.contains("more than 32 levels deep"), "{reported}");
    let many = "Attribute \"shape\" \"float radius\" 1\n".repeat(2000);
    assert!(
        refusal("pbrt", format!("WorldBegin\n{many}"))
            .contains("scene.pbrt:1002:1: there are more than 1000")
    );
    let deep = "AttributeBegin\n".repeat(20_000);
    assert!(refusal("pbrt", format!("WorldBegin\n{deep}")).contains("nested more than"));
    let long = "x".repeat(1 << 20);
    let materials: String = (0..2000)
        .map(|i| format!("MakeNamedMaterial \"{i}{}\" \"string type\" \"diffuse\"\n", &long[..90]))
        .collect();
    let reported =
        refusal("pbrt", format!("WorldBegin\n{materials}\nNamedMaterial \"{long}\" Shape \"disk\""));
    assert!(reported.len() < 20_000, "{}", reported.len());
}

#[test]
fn the_first_bytes_identify_the_format() {
    let text = format!("# a scene\nWorldBegin\n{TRIANGLE}");
    assert_eq!(read_text("", text).unwrap().objects.len(), 1);
    assert!(bilux_formats::format_named("pbrt").unwrap().extensions.contains(&"pbrt"));
    assert_eq!(Path::new("x.pbrt").extension().unwrap(), "pbrt");
}

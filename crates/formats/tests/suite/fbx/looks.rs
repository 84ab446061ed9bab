//! Materials, textures, lights and cameras.

use super::writer::ps;
use super::*;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_math::transcendental::{atan, atan2_f64, tan};
use std::f32::consts::PI;

/// A quad with a material, or what else is connected to its node (2) or to the material (3).
fn with(more: Vec<N>, links: Vec<N>) -> Vec<N> {
    let objects = vec![quad(1), model(2, "node", vec![])].into_iter().chain(more).collect();
    let links = vec![link(1, 2, ""), link(2, 0, "")].into_iter().chain(links).collect();
    file(vec![p("UnitScaleFactor", &[100.0])], objects, links)
}

fn phong(list: Vec<N>) -> N {
    object("Material", 3, "paint", "", vec![n("ShadingModel", vec![text("phong")], vec![]), properties(list)])
}

#[test]
fn phong_becomes_principled() {
    let list = vec![
        p("DiffuseColor", &[0.5, 0.25, 1.0]),
        p("DiffuseFactor", &[0.8]),
        p("SpecularColor", &[0.5, 0.5, 0.5]),
        p("ShininessExponent", &[6.0]),
        p("TransparentColor", &[1.0, 1.0, 1.0]),
        p("TransparencyFactor", &[0.25]),
        p("EmissiveColor", &[1.0, 1.0, 1.0]),
        p("EmissiveFactor", &[0.5]),
    ];
    let scene = read_all(&with(vec![phong(list)], vec![link(3, 2, "")]));
    let spec = &scene.materials[scene.objects[0].material];
    assert_eq!((spec.name.as_str(), spec.kind.as_str()), ("paint", "principled"));
    assert_eq!(
        spec.colour("base_color"),
        Some(Rgb::new(srgb_decode(0.4), srgb_decode(0.2), srgb_decode(0.8)))
    );
    assert_eq!(spec.colour("emission"), Some(Rgb::grey(srgb_decode(0.5))));
    assert_eq!((spec.number("opacity"), spec.number("specular_weight")), (Some(0.75), Some(0.5)));
    // Blinn's exponent of 6 is a GGX alpha of a half.
    assert!((spec.number("specular_roughness").unwrap() - 0.5f32.sqrt()).abs() < 1e-6);
}

#[test]
fn shaders_of_programs_have_their_own_names() {
    let list = |prefix: &str| {
        [
            ("base_color", &[1.0, 0.0, 0.0][..]),
            ("metalness", &[0.75]),
            ("roughness", &[0.25]),
            ("emission", &[0.0]),
        ]
        .map(|(name, value)| p(&format!("{prefix}{name}"), value))
        .to_vec()
    };
    for prefix in ["3dsMax|Parameters|", "3dsMax|main|", "Maya|"] {
        let scene = read_all(&with(vec![phong(list(prefix))], vec![link(3, 2, "")]));
        let spec = &scene.materials[scene.objects[0].material];
        assert_eq!(spec.colour("base_color"), Some(Rgb::new(1.0, 0.0, 0.0)));
        assert_eq!(
            (spec.number("base_metalness"), spec.number("specular_roughness")),
            (Some(0.75), Some(0.25))
        );
    }
}

/// Two texels in the file, red at the left; moved by half of the width.
#[test]
fn textures_in_the_file_lie_as_it_says() {
    let video = object(
        "Video",
        5,
        "v",
        "Clip",
        vec![
            n("RelativeFilename", vec![text("two.ppm")], vec![]),
            n("Content", vec![V::Bytes(b"P6 2 1 255\n\xff\0\0\0\0\xff".to_vec())], vec![]),
        ],
    );
    let texture = |list: Vec<N>| object("Texture", 4, "t", "", vec![properties(list)]);
    let links = || vec![link(3, 2, ""), link(4, 3, "DiffuseColor"), link(5, 4, "")];
    let of = |list: Vec<N>| {
        let scene = read_all(&with(vec![phong(vec![]), texture(list), video.clone()], links()));
        let Some((bilux_scene::Value::Texture(index), _)) = scene.materials[0].parameters.find("base_color")
        else {
            panic!("{:?}", scene.materials)
        };
        scene.textures[*index].clone()
    };
    let at = |list: Vec<N>, uv: [f32; 2]| of(list).at(bilux_math::Vec2::from(uv));
    let (red, blue) = (Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 1.0));
    assert_eq!((at(vec![], [0.25, 0.5]), at(vec![], [0.75, 0.5])), (red, blue));
    assert_eq!(at(vec![p("Translation", &[0.5, 0.0, 0.0])], [0.25, 0.5]), blue);
    assert_eq!(at(vec![p("Scaling", &[2.0, 1.0, 1.0])], [0.375, 0.5]), blue);
    // A quarter turn takes v to -u.
    assert_eq!(at(vec![p("Rotation", &[0.0, 0.0, 90.0])], [0.5, 0.25]), blue);
    // Each direction is clamped by its own mode.
    use bilux_scene::texture::Wrap::{Clamp, Repeat};
    assert_eq!(of(vec![p("WrapModeU", &[1.0])]).wrap, [Clamp, Repeat]);
    assert_eq!(of(vec![p("WrapModeV", &[1.0])]).wrap, [Repeat, Clamp]);
    let missing = with(
        vec![phong(vec![]), texture(vec![ps("UVSet", "a")])],
        vec![link(3, 2, ""), link(4, 3, "DiffuseColor")],
    );
    let missing = scene_of(&binary(7400, true, &missing)).unwrap();
    assert!(crate::warnings(&missing).contains("magenta checker"));
}

#[test]
fn lights_shine_down_their_node_as_bright_as_their_programs_show_them() {
    let light = |kind: f64, more: Vec<N>| {
        let mut list = vec![p("LightType", &[kind]), p("Color", &[1.0, 0.0, 0.0]), p("Intensity", &[200.0])];
        list.extend(more);
        let attribute = object("NodeAttribute", 6, "", "Light", vec![properties(list)]);
        let node = model(7, "lamp", vec![p("Lcl Translation", &[0.0, 0.0, 5.0])]);
        read_all(&with(vec![attribute, node], vec![link(6, 7, ""), link(7, 0, "")])).lights[0].clone()
    };
    let sun = light(1.0, vec![]);
    assert_eq!(
        (sun.vector("direction"), sun.colour("irradiance")),
        (Some(-Vec3::Y), Some(Rgb::new(2.0 * PI, 0.0, 0.0)))
    );
    let point = light(0.0, vec![p("DecayType", &[2.0])]);
    assert_eq!(
        (point.kind.as_str(), point.colour("intensity")),
        ("point", Some(Rgb::new(2.0 * PI, 0.0, 0.0)))
    );
    assert_eq!(point.vector("position"), Some(Vec3::new(0.0, 0.0, 5.0)));
    // Blender's are in watts since 2.80; before, they are as bright as stated up to a distance.
    for (creator, expected) in [("2.76 (sub 0) - 3.6.2", PI * 400.0), ("4.4.1 - 5.13.0", 1.0 / (4.0 * PI))] {
        let list = vec![p("Intensity", &[100.0]), p("DecayType", &[2.0]), p("DecayStart", &[20.0])];
        let attribute = object("NodeAttribute", 6, "", "Light", vec![properties(list)]);
        let mut nodes = with(vec![attribute, model(7, "lamp", vec![])], vec![link(6, 7, ""), link(7, 0, "")]);
        nodes.push(n("Creator", vec![text(&format!("Blender (stable FBX IO) - {creator}"))], vec![]));
        let found = read_all(&nodes).lights[0].colour("intensity").unwrap().r;
        assert!((found / expected - 1.0).abs() < 1e-5, "{creator}: {found}");
    }
    // The middle of the quad is at (0.5, 1, 0), so the distance² is 26.25.
    let constant = light(0.0, vec![]).colour("intensity").unwrap().r;
    assert!((constant - 2.0 * PI * 26.25).abs() < 1e-3, "{constant}");
    let spot = light(2.0, vec![p("OuterAngle", &[60.0]), p("InnerAngle", &[40.0])]);
    assert_eq!((spot.number("angle"), spot.number("inner_angle")), (Some(30.0), Some(20.0)), "half angles");
}

/// In a file of centimetres, lamps are weaker by a power of the centimetres to what they light, and light a white surface of irradiance π
/// from a distance of 1 if their intensity is 100.
#[test]
fn lights_decay_over_the_units_of_their_file() {
    // The middle of the quad is 5 cm below.
    for (decay, weaker) in [(0.0, 1.0), (1.0, 5.0), (2.0, 25.0), (3.0, 125.0)] {
        let list = vec![p("Intensity", &[200.0]), p("DecayType", &[decay])];
        let attribute = object("NodeAttribute", 6, "", "Light", vec![properties(list)]);
        let lamp = model(7, "lamp", vec![p("Lcl Translation", &[0.5, 1.0, 5.0])]);
        let objects = vec![quad(1), model(2, "node", vec![]), attribute, lamp];
        let links = vec![link(1, 2, ""), link(2, 0, ""), link(6, 7, ""), link(7, 0, "")];
        let scene = read_all(&file(vec![p("UnitScaleFactor", &[1.0])], objects, links));
        let irradiance = scene.lights[0].colour("intensity").unwrap().g / (0.05 * 0.05);
        let wanted = 2.0 * PI / weaker;
        assert!((irradiance / wanted - 1.0).abs() < 1e-4, "{decay}: {irradiance}, not {wanted}");
    }
}

/// A film of 36 × 24 mm behind a lens of 50 mm sees 26.99° × 39.6°, as any table of lenses says.
#[test]
fn cameras_look_along_x_with_the_angle_of_their_lens() {
    let camera = |list: Vec<N>| {
        let attribute = object("NodeAttribute", 6, "", "Camera", vec![properties(list)]);
        let node = model(7, "eye", vec![p("Lcl Translation", &[-3.0, 0.0, 0.0])]);
        read_all(&with(vec![attribute, node], vec![link(6, 7, ""), link(7, 0, "")])).cameras[0].spec.clone()
    };
    let film =
        || vec![p("FilmWidth", &[36.0 / 25.4]), p("FilmHeight", &[24.0 / 25.4]), p("FocalLength", &[50.0])];
    let spec = camera([film(), vec![p("ApertureMode", &[3.0])]].concat());
    assert!((spec.number("fov").unwrap() - 26.99).abs() < 0.01, "{spec:?}");
    assert_eq!(
        (spec.vector("position"), spec.vector("up")),
        (Some(Vec3::new(-3.0, 0.0, 0.0)), Some(Vec3::Y))
    );
    assert!(spec.vector("look_at").unwrap().x > -3.0);
    let spec = camera([film(), vec![p("ApertureMode", &[1.0]), p("FieldOfView", &[39.6])]].concat());
    assert!((spec.number("fov").unwrap() - 26.99).abs() < 0.02, "{spec:?}");
    let spec = camera(vec![p("ApertureMode", &[2.0]), p("FieldOfView", &[33.0])]);
    assert_eq!(spec.number("fov"), Some(33.0));
    // A fixed side in pixels, and the other as a factor on it: 640 by 480, and 800 by 200.
    for (mode, width, height, aspect) in [(3.0, 640.0, 0.75, 4.0 / 3.0), (4.0, 4.0, 200.0, 4.0)] {
        let sides =
            vec![p("AspectRatioMode", &[mode]), p("AspectWidth", &[width]), p("AspectHeight", &[height])];
        let angle = vec![p("ApertureMode", &[1.0]), p("FieldOfView", &[60.0])];
        let spec = camera([sides, angle].concat());
        let half = atan(tan(30f32.to_radians()) / aspect).to_degrees();
        assert!((spec.number("fov").unwrap() - 2.0 * half).abs() < 0.01, "{mode}: {spec:?}");
    }
}

/// A factor that is stated alone is the transparency, as Blender and three.js read it; with a colour it is a factor on that.
#[test]
fn a_transparency_factor_alone_is_the_transparency() {
    let opacity = |list: Vec<N>| {
        let scene = read_all(&with(vec![phong(list)], vec![link(3, 2, "")]));
        scene.materials[scene.objects[0].material].number("opacity").unwrap_or(1.0)
    };
    assert!((opacity(vec![p("TransparencyFactor", &[0.6])]) - 0.4).abs() < 1e-6);
    let both = vec![p("TransparentColor", &[0.5, 0.5, 0.5]), p("TransparencyFactor", &[0.6])];
    assert!((opacity(both) - 0.7).abs() < 1e-6);
    assert_eq!(opacity(vec![p("TransparentColor", &[0.0, 0.0, 0.0]), p("TransparencyFactor", &[0.6])]), 1.0);
    assert_eq!(opacity(vec![p("TransparencyFactor", &[0.0])]), 1.0);
}

/// Of several objects for one file, one has the picture: it is that of all, and no other's.
#[test]
fn a_picture_is_found_in_another_object_of_its_name() {
    let png = |grey: f32| {
        let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::grey(grey)]).unwrap();
        bilux_pictures::write_bytes("png", &picture, &Default::default()).unwrap()
    };
    let clip = |id: i64, name: &'static str, content: Option<Vec<u8>>| {
        let names = vec![n("RelativeFilename", vec![text(name)], vec![])];
        let content = content.map(|bytes| n("Content", vec![V::Bytes(bytes)], vec![]));
        object("Video", id, "clip", "Clip", names.into_iter().chain(content).collect())
    };
    let texture =
        object("Texture", 4, "t", "", vec![n("RelativeFilename", vec![text("maps\\grid.png")], vec![])]);
    let all = vec![
        phong(vec![]),
        texture,
        clip(5, "maps\\grid.png", None),
        clip(6, "maps\\other.png", Some(png(0.5))),
        clip(7, "C:/a/grid.png", Some(png(0.25))),
    ];
    let links = vec![link(3, 2, ""), link(4, 3, "DiffuseColor"), link(5, 4, "")];
    let scene = scene_of(&binary(7400, true, &with(all, links))).unwrap();
    let spec = &scene.materials[scene.objects[0].material];
    let Some((bilux_scene::Value::Texture(index), _)) = spec.parameters.find("base_color") else {
        panic!("{spec:?}")
    };
    assert!((scene.textures[*index].texel(0, 0).g - 0.25).abs() < 0.01);
}

/// The gates of a camera by closed form: the film is 4 : 3 and 36 mm wide, the lens is 24 mm, and the picture 2 : 1 or 1 : 1. [FBX SDK,
/// FbxCamera::EGateFit: fill shows no more than the film, overscan no less.]
#[test]
fn each_fit_of_the_gate_shows_its_part_of_the_film() {
    let [width, height, focal] = [36.0, 27.0, 24.0];
    let fov = |fit: f64, aspect: f64| {
        let list = vec![
            p("FilmWidth", &[width / 25.4]),
            p("FilmHeight", &[height / 25.4]),
            p("FocalLength", &[focal]),
            p("ApertureMode", &[3.0]),
            p("AspectWidth", &[aspect * 100.0]),
            p("AspectHeight", &[100.0]),
            p("GateFit", &[fit]),
        ];
        let camera = object("NodeAttribute", 5, "lens", "Camera", vec![properties(list)]);
        let node = object("Model", 4, "eye", "Camera", vec![]);
        let scene = read_all(&with(vec![node, camera], vec![link(5, 4, ""), link(4, 0, "")]));
        scene.cameras[0].spec.number("fov").unwrap()
    };
    let of = |seen: f64| (2.0 * atan2_f64(seen / 2.0, focal).to_degrees()) as f32;
    // By what is seen of the film's height: its own, or what its width leaves.
    for (fit, wide, tall) in
        [(1.0, height, height), (2.0, width / 2.0, width), (3.0, width / 2.0, height), (4.0, height, width)]
    {
        for (aspect, seen) in [(2.0, wide), (1.0, tall)] {
            let found = fov(fit, aspect);
            assert!((found - of(seen)).abs() < 1e-3, "fit {fit}, {aspect}: {found}, not {}", of(seen));
        }
    }
}

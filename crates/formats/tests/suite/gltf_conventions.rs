//! Conventions of glTF, tested where a ray hits a surface: handedness of tangents, wrap modes, sets of texture
//! coordinates, normals of skins, directions of highlights, cones of spot lights.

use crate::gltf_motion::Parts;
use crate::{read_text, warnings};
use bilux_math::colour::srgb_decode;
use bilux_math::glam::DQuat;
use bilux_math::transcendental::{acos_f64, atan2_f64, cos_f64, sin_cos_f64};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_pictures::{Picture, WriteOptions, write_bytes};
use bilux_scene::{AccelChoice, Ray, Scene, SceneBuilder, Surface, Tracer, TransportMode, Value};
use std::f64::consts::{PI, TAU};

pub(crate) fn read(text: &str) -> SceneBuilder {
    read_text("gltf", text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// An image with these bytes, top row first, as a data URI.
fn picture(width: usize, texels: &[[u8; 3]]) -> String {
    let light = |byte: u8| srgb_decode(f32::from(byte) / 255.0);
    let colours = texels.iter().map(|&[r, g, b]| Rgb::new(light(r), light(g), light(b))).collect();
    let picture = Picture::from_rgb(width, texels.len() / width, colours).unwrap();
    let bytes = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
    format!("data:image/png,{}", bytes.iter().map(|b| format!("%{b:02x}")).collect::<String>())
}

/// A square of 2 by 2 that faces +z, with tangents and two sets of texture coordinates.
///
/// In the first set, v grows downwards, as in glTF; the second set rotates the texture by a quarter turn to the
/// right.
pub(crate) struct Square {
    /// The handedness: w of its tangents.
    hand: f32,
    /// Additional properties of its node, beginning with a comma.
    node: &'static str,
    material: String,
    /// Textures, samplers and images, each followed by a comma.
    more: String,
}

impl Square {
    pub(crate) fn of(material: &str, more: &str) -> Square {
        Square { hand: 1.0, node: "", material: material.to_owned(), more: more.to_owned() }
    }

    pub(crate) fn text(&self) -> String {
        let mut parts = Parts::default();
        parts.floats("VEC3", 3, &[-1., -1., 0., 1., -1., 0., 1., 1., 0., -1., 1., 0.]);
        parts.floats("VEC3", 3, &[0., 0., 1.].repeat(4));
        parts.floats("VEC4", 4, &[1., 0., 0., self.hand].repeat(4));
        // In a mirrored texture, u still grows along the tangent, but v grows the other way.
        let v = |down: f32| if self.hand > 0.0 { down } else { 1.0 - down };
        parts.floats("VEC2", 2, &[0., v(1.), 1., v(1.), 1., v(0.), 0., v(0.)]);
        parts.floats("VEC2", 2, &[1., 1., 1., 0., 0., 0., 0., 1.]);
        let Square { node, material, more, .. } = self;
        parts.document(&format!(
            r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],"materials":[{material}],{more}
            "meshes":[{{"primitives":[{{"mode":6,"material":0,"attributes":
            {{"POSITION":0,"NORMAL":1,"TANGENT":2,"TEXCOORD_0":3,"TEXCOORD_1":4}}}}]}}]"#
        ))
    }

    fn built(&self) -> Scene {
        let scene = read(&self.text());
        assert_eq!(warnings(&scene), "");
        scene.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
    }
}

/// The surface that a ray from +z hits.
fn seen(scene: &Scene, x: f32, y: f32) -> Surface {
    Tracer::new(scene, false).closest(&Ray::new([x, y, 5.0], [0.0, 0.0, -1.0])).expect("the square is there")
}

pub(crate) fn one_picture(width: usize, texels: &[[u8; 3]], sampler: &str) -> String {
    format!(
        r#""textures":[{{"source":0,"sampler":0}}],"samplers":[{{{sampler}}}],"images":[{{"uri":"{}"}}],"#,
        picture(width, texels)
    )
}

const MIRRORED: &str = r#","scale":[-1,1,1]"#;

#[test]
fn given_tangents_have_the_hand_that_they_say() {
    // Red tilts the normal along the tangent, green along cross(normal, tangent) · w. [glTF 2.0, 3.7.2.1 and
    // 3.9.3]
    let material = r#"{"normalTexture":{"index":0}}"#;
    for (texel, lean) in [([204u8, 128, 230], [1.0f32, 0.0]), ([128, 204, 230], [0.0, 1.0])] {
        for (hand, node) in [(1.0f32, ""), (-1.0, ""), (1.0, MIRRORED), (-1.0, MIRRORED)] {
            let more = one_picture(1, &[texel], "");
            let scene = Square { hand, node, ..Square::of(material, &more) }.built();
            let found = seen(&scene, 0.3, 0.2).n_shade;
            let [along, across] = lean.map(|x| x * 0.6);
            // A mirrored node reverses the tangent but not the bitangent.
            let wanted = Vec3::new(if node.is_empty() { along } else { -along }, across * hand, 0.8);
            assert!((found - wanted).length() < 0.01, "{texel:?}, w = {hand}{node}: {found}, not {wanted}");
        }
    }
}

#[test]
fn skins_that_mirror_turn_the_hand_of_tangents() {
    let (mut text, more) = (String::new(), one_picture(1, &[[128, 204, 230]], ""));
    for (hand, scale) in [(1.0f32, "1,1,1"), (-1.0, "1,1,1"), (1.0, "-1,1,1"), (-1.0, "-1,1,1")] {
        let mut parts = Parts::default();
        parts.floats("VEC3", 3, &[-1., -1., 0., 1., -1., 0., 1., 1., 0., -1., 1., 0.]);
        parts.floats("VEC3", 3, &[0., 0., 1.].repeat(4));
        parts.floats("VEC4", 4, &[1., 0., 0., hand].repeat(4));
        parts.floats("VEC2", 2, &[0., 1., 1., 1., 1., 0., 0., 0.]);
        parts.add("VEC4", 5121, 4, &[0; 16]);
        parts.floats("VEC4", 4, &[1., 0., 0., 0.].repeat(4));
        text.clear();
        text += &parts.document(&format!(
            r#""scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0,"skin":0}},{{"scale":[{scale}]}}],
            "materials":[{{"normalTexture":{{"index":0}}}}],{more}"skins":[{{"joints":[1]}}],
            "meshes":[{{"primitives":[{{"mode":6,"material":0,"attributes":{{"POSITION":0,"NORMAL":1,"TANGENT":2,
            "TEXCOORD_0":3,"JOINTS_0":4,"WEIGHTS_0":5}}}}]}}]"#
        ));
        let scene = read(&text).build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
        let found = seen(&scene, 0.3, 0.2);
        let wanted = Vec3::new(0.0, 0.6 * hand, 0.8);
        assert!((found.n_shade - wanted).length() < 0.01, "w = {hand}, {scale}: {}", found.n_shade);
        assert!(found.n_geom.z > 0.99, "the front stays in front");
    }
}

#[test]
fn pictures_go_on_beyond_each_edge_as_their_sampler_says() {
    // Red distinguishes columns, green rows.
    let texels: Vec<[u8; 3]> = (0..16).map(|i| [(i % 4) as u8 * 60, (i / 4) as u8 * 60, 0]).collect();
    let material = r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#;
    // The texels at -1 and at 4 of a row of four, for each wrap mode.
    let ways = [(10497u32, [3u8, 0u8]), (33071, [0, 3]), (33648, [0, 3])];
    // Those at -2 and at 5 distinguish mirroring from clamping.
    let further = [[2u8, 1], [0, 3], [1, 2]];
    for ((i, (s, at_s)), (k, (t, at_t))) in
        ways.into_iter().enumerate().flat_map(|s| ways.into_iter().enumerate().map(move |t| (s, t)))
    {
        let sampler = format!(r#""wrapS":{s},"wrapT":{t},"magFilter":9728"#);
        let scene = read(&Square::of(material, &one_picture(4, &texels, &sampler)).text());
        let texture = &scene.textures[0];
        // In Bilux, v points up: row 0 is on top.
        let at = |column: f32, row: f32| {
            let texel = texture.at(Vec2::new((column + 0.5) / 4.0, 1.0 - (row + 0.5) / 4.0));
            [texel.r, texel.g]
        };
        let light = |step: u8| srgb_decode(f32::from(step * 60) / 255.0);
        let check = |column: f32, row: f32, wanted: [u8; 2]| {
            let wanted = wanted.map(light);
            assert_eq!(at(column, row), wanted, "{sampler}: column {column}, row {row}");
        };
        check(1.0, 2.0, [1, 2]);
        for (place, near, far) in [(0, -1.0, -2.0), (1, 4.0, 5.0)] {
            check(near, 1.0, [at_s[place], 1]);
            check(1.0, near, [1, at_t[place]]);
            check(far, 1.0, [further[i][place], 1]);
            check(1.0, far, [1, further[k][place]]);
        }
    }
}

#[test]
fn a_texture_of_the_second_set_is_looked_up_there() {
    // Upper left red, upper right green, lower left blue, lower right grey.
    let texels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [188, 188, 188]];
    let more = one_picture(2, &texels, r#""magFilter":9728"#);
    let base = |texture: &str| {
        format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{texture},"metallicFactor":0}}}}"#)
    };
    let [red, green, blue, grey] = texels.map(|t| t.map(|b| srgb_decode(f32::from(b) / 255.0)));
    // At the corners of the square, from the upper left to the lower right.
    let upright = [red, green, blue, grey];
    // A quarter turn to the right: the left side becomes the top.
    let turned = [blue, red, grey, green];
    let by_first = r#","normalTexture":{"index":0},"occlusionTexture":{"index":0}}"#;
    let cases = [
        (base(r#"{"index":0}"#), upright),
        (base(r#"{"index":0,"texCoord":1}"#), turned),
        (base(r#"{"index":0,"texCoord":1,"extensions":{"KHR_texture_transform":{"texCoord":0}}}"#), upright),
        (base(r#"{"index":0,"extensions":{"KHR_texture_transform":{"texCoord":1}}}"#), turned),
        // Together with a texture that uses the first set.
        (base(r#"{"index":0,"texCoord":1}"#).trim_end_matches('}').to_owned() + "}" + by_first, turned),
    ];
    for (material, wanted) in cases {
        let scene =
            read(&Square::of(&material, &more).text()).build(&AccelChoice::default(), [0.0, 0.0], 1.0);
        let scene = scene.unwrap();
        for ((x, y), wanted) in [(-0.5, 0.5), (0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)].into_iter().zip(wanted) {
            let surface = seen(&scene, x, y);
            let found = scene.material(&surface).classic(&surface).kd;
            let off = (found - Rgb::from_array(wanted)).map(f32::abs).max_channel();
            assert!(off < 1e-3, "{material} at {x}, {y}: {found:?}, not {wanted:?}");
        }
    }
}

#[test]
fn two_textures_of_one_material_are_looked_up_by_two_sets() {
    let texels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [188, 188, 188]];
    let more = one_picture(2, &texels, r#""magFilter":9728"#);
    let light = |i: usize| Rgb::from_array(texels[i].map(|b| srgb_decode(f32::from(b) / 255.0)));
    let (upright, turned) = ([0, 1, 2, 3], [2, 0, 3, 1]);
    for (sets, [base, glow]) in [([0, 1], [upright, turned]), ([1, 0], [turned, upright])] {
        let material = format!(
            r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"texCoord":{}}},"metallicFactor":0}},
            "emissiveFactor":[1,1,1],"emissiveTexture":{{"index":0,"texCoord":{}}}}}"#,
            sets[0], sets[1]
        );
        let scene = Square::of(&material, &more).built();
        for (i, (x, y)) in [(-0.5, 0.5), (0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)].into_iter().enumerate() {
            let surface = seen(&scene, x, y);
            let found = [scene.material(&surface).classic(&surface).kd, scene.emission(&surface, Vec3::Z)];
            for (found, wanted) in found.into_iter().zip([light(base[i]), light(glow[i])]) {
                let off = (found - wanted).map(f32::abs).max_channel();
                assert!(off < 1e-3, "sets {sets:?} at {x}, {y}: {found:?}, not {wanted:?}");
            }
        }
    }
}

#[test]
fn normals_of_a_skin_that_is_scaled_unevenly_are_those_of_the_ellipsoid() {
    let directions: Vec<DVec3> = (0..30)
        .map(|i| {
            let (up, (sin, cos)) = (1.0 - (f64::from(i) + 0.5) / 15.0, sin_cos_f64(2.4 * f64::from(i)));
            let r = (1.0 - up * up).sqrt();
            DVec3::new(r * cos, up, r * sin)
        })
        .collect();
    let numbers: Vec<f32> = directions.iter().flat_map(|d| d.as_vec3().to_array()).collect();
    let turn = DQuat::from_euler(bilux_math::glam::EulerRot::XYZ, 0.5, -0.8, 0.3);
    for scale in [DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 2.0, 0.5), DVec3::new(-1.0, -2.0, -0.5)] {
        let mut parts = Parts::default();
        parts.floats("VEC3", 3, &numbers);
        parts.floats("VEC3", 3, &numbers);
        parts.add("VEC4", 5121, 30, &[0; 120]);
        parts.floats("VEC4", 4, &[1., 0., 0., 0.].repeat(30));
        let text = parts.document(&format!(
            r#""scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0,"skin":0}},{{"scale":{:?},"rotation":{:?}}}],
            "skins":[{{"joints":[1]}}],"meshes":[{{"primitives":[{{"attributes":
            {{"POSITION":0,"NORMAL":1,"JOINTS_0":2,"WEIGHTS_0":3}}}}]}}]"#,
            scale.to_array(),
            turn.to_array()
        ));
        let mesh = read(&text).objects[0].mesh.clone();
        for (i, d) in directions.iter().enumerate() {
            // The gradient of x²/a² + y²/b² + z²/c² on the ellipsoid.
            let wanted = (turn * (*d / scale)).normalize();
            let found = mesh.normals[i].as_dvec3().normalize();
            assert!((found - wanted).length() < 1e-4, "{scale}: {found}, not {wanted}");
            assert!((mesh.positions[i].as_dvec3() - turn * (*d * scale)).length() < 1e-5);
        }
    }
}

/// A texel with four channels as a data URI of a PNG.
fn texel([r, g, b, a]: [u8; 4]) -> String {
    let light = |byte: u8| srgb_decode(f32::from(byte) / 255.0);
    let alpha = f32::from(a) / 255.0;
    let mut picture = Picture::from_rgb(1, 1, vec![Rgb::new(light(r), light(g), light(b)) * alpha]).unwrap();
    picture.push_channel("A", vec![alpha]).unwrap();
    let bytes = write_bytes("png", &picture, &WriteOptions::default()).unwrap();
    format!("data:image/png,{}", bytes.iter().map(|b| format!("%{b:02x}")).collect::<String>())
}

/// The specification assigns each number to a channel of a texture.
#[test]
fn numbers_are_in_the_channels_that_the_specification_says() {
    const RED: f32 = 51.0 / 255.0;
    const GREEN: f32 = 102.0 / 255.0;
    const BLUE: f32 = 153.0 / 255.0;
    const ALPHA: f32 = 204.0 / 255.0;
    let metal = r#""pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}}"#;
    let glass = r#""pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"#;
    let cases = [
        ("base_metalness", metal.to_owned(), BLUE),
        ("specular_roughness", metal.to_owned(), GREEN),
        (
            "opacity",
            r#""alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#.to_owned(),
            ALPHA,
        ),
        (
            "specular_weight",
            format!(r#"{glass}"KHR_materials_specular":{{"specularTexture":{{"index":0}}}}}}"#),
            ALPHA,
        ),
        (
            "transmission_weight",
            format!(
                r#"{glass}"KHR_materials_transmission":{{"transmissionFactor":1,"transmissionTexture":{{"index":0}}}}}}"#
            ),
            RED,
        ),
        (
            "coat_weight",
            format!(
                r#"{glass}"KHR_materials_clearcoat":{{"clearcoatFactor":1,"clearcoatTexture":{{"index":0}}}}}}"#
            ),
            RED,
        ),
        (
            "coat_roughness",
            format!(
                r#"{glass}"KHR_materials_clearcoat":{{"clearcoatFactor":1,"clearcoatRoughnessFactor":1,"clearcoatRoughnessTexture":{{"index":0}}}}}}"#
            ),
            GREEN,
        ),
        (
            "fuzz_roughness",
            format!(
                r#"{glass}"KHR_materials_sheen":{{"sheenColorFactor":[1,1,1],"sheenRoughnessFactor":1,"sheenRoughnessTexture":{{"index":0}}}}}}"#
            ),
            ALPHA,
        ),
        (
            "thin_film_weight",
            format!(
                r#"{glass}"KHR_materials_iridescence":{{"iridescenceFactor":1,"iridescenceTexture":{{"index":0}}}}}}"#
            ),
            RED,
        ),
        (
            "thin_film_thickness",
            format!(
                r#"{glass}"KHR_materials_iridescence":{{"iridescenceFactor":1,"iridescenceThicknessMinimum":0,"iridescenceThicknessMaximum":1000,"iridescenceThicknessTexture":{{"index":0}}}}}}"#
            ),
            GREEN,
        ),
        (
            "diffuse_transmission_weight",
            format!(
                r#"{glass}"KHR_materials_diffuse_transmission":{{"diffuseTransmissionFactor":1,"diffuseTransmissionTexture":{{"index":0}}}}}}"#
            ),
            ALPHA,
        ),
    ];
    let more =
        format!(r#""textures":[{{"source":0}}],"images":[{{"uri":"{}"}}],"#, texel([51, 102, 153, 204]));
    for (key, material, wanted) in cases {
        let scene = read(&Square::of(&format!("{{{material}}}"), &more).text());
        let spec = &scene.materials[scene.objects[0].material];
        let found = match spec.parameters.find(key) {
            Some((Value::Texture(index), _)) => scene.textures[*index].number(Vec2::splat(0.5)),
            other => panic!("{key}: {other:?}"),
        };
        assert!((found - wanted).abs() < 0.01, "{key}: {found}, not {wanted}");
    }
}

#[test]
fn factors_count_beside_pictures_and_without() {
    let value = |material: &str, key: &str| {
        let more = one_picture(1, &[[255, 255, 255]], "");
        let scene = read(&Square::of(material, &more).text());
        let spec = &scene.materials[scene.objects[0].material];
        match spec.parameters.find(key).unwrap_or_else(|| panic!("{material}: no {key}")).0.clone() {
            Value::Number(x) => Rgb::grey(x as f32),
            Value::Texture(index) => scene.textures[index].at(Vec2::splat(0.5)),
            Value::List(c) => {
                let channel = |i: usize| if let Value::Number(x) = c[i] { x as f32 } else { f32::NAN };
                Rgb::new(channel(0), channel(1), channel(2))
            }
            other => panic!("{material}: {key} is {other:?}"),
        }
    };
    let strong = r#""emissiveFactor":[0.5,1,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":6}}"#;
    let cases = [
        (format!("{{{strong}}}"), "emission", Rgb::new(3.0, 6.0, 0.0)),
        (format!(r#"{{"emissiveTexture":{{"index":0}},{strong}}}"#), "emission", Rgb::new(3.0, 6.0, 0.0)),
        (r#"{"normalTexture":{"index":0,"scale":0.25}}"#.to_owned(), "normal_scale", Rgb::grey(0.25)),
        (
            r#"{"extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatNormalTexture":{"index":0,"scale":1.5}}}}"#
                .to_owned(),
            "coat_normal_scale",
            Rgb::grey(1.5),
        ),
        (
            r#"{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"baseColorTexture":{"index":0}}}"#.to_owned(),
            "base_color",
            Rgb::new(0.5, 0.25, 1.0),
        ),
        (
            r#"{"pbrMetallicRoughness":{"roughnessFactor":0.5,"metallicRoughnessTexture":{"index":0}}}"#.to_owned(),
            "specular_roughness",
            Rgb::grey(0.5),
        ),
        (
            r#"{"alphaMode":"MASK","alphaCutoff":0.75,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.7]}}"#.to_owned(),
            "opacity",
            Rgb::BLACK,
        ),
        (
            r#"{"alphaMode":"MASK","alphaCutoff":0.25,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.3],"baseColorTexture":{"index":0}}}"#
                .to_owned(),
            "opacity",
            Rgb::WHITE,
        ),
    ];
    for (material, key, wanted) in cases {
        let found = value(&material, key);
        assert!((found - wanted).map(f32::abs).max_channel() < 1e-3, "{material}: {key} is {found:?}");
    }
}

#[test]
fn rotated_pictures_are_placed_as_the_extension_says() {
    // Coordinates rotate counter-clockwise about the upper left corner, and so the image rotates clockwise.
    // [KHR_texture_transform]
    let texels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [188, 188, 188]];
    let more = one_picture(2, &texels, r#""magFilter":9728"#);
    let material = r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
        {"rotation":1.5707963267948966,"offset":[0,1]}}}}}"#;
    let scene = read(&Square::of(material, &more).text());
    let texture = &scene.textures[0];
    // A quarter turn and an offset of one downwards: (u, v) is looked up at (v, 1 - u).
    for (u, v, wanted) in [(0.25, 0.25, 2), (0.75, 0.25, 0), (0.25, 0.75, 3), (0.75, 0.75, 1)] {
        let found = texture.at(Vec2::new(u, 1.0 - v));
        let wanted = texels[wanted].map(|b: u8| srgb_decode(f32::from(b) / 255.0));
        assert_eq!(found.to_array(), wanted, "{u}, {v}");
    }
}

/// The angle of the longest axis of a highlight at normal incidence, from +x towards +y, in 0..π.
fn direction_of_highlight(scene: &Scene) -> f64 {
    let surface = seen(scene, 0.3, 0.2);
    let bsdf = scene.material(&surface).bsdf(&surface);
    let mut sum = [0.0; 2];
    for i in 0..180 {
        let angle = TAU * f64::from(i) / 180.0;
        let ((sin, cos), (aside, up)) = (sin_cos_f64(angle), sin_cos_f64(0.25));
        let wi = DVec3::new(aside * cos, aside * sin, up).as_vec3();
        let light = f64::from(bsdf.eval(Vec3::Z, wi, TransportMode::Radiance).g);
        let (sin, cos) = sin_cos_f64(2.0 * angle);
        sum = [sum[0] + cos * light, sum[1] + sin * light];
    }
    (0.5 * atan2_f64(sum[1], sum[0])).rem_euclid(PI)
}

#[test]
fn an_anisotropic_highlight_reaches_along_its_direction() {
    // Along the tangent, rotated towards the bitangent. [KHR_materials_anisotropy]
    for (hand, node, turned) in
        [(1.0f32, "", 1.0f64), (-1.0, "", -1.0), (1.0, MIRRORED, -1.0), (-1.0, MIRRORED, 1.0)]
    {
        for rotation in [0.0f64, 0.5] {
            let material = format!(
                r#"{{"pbrMetallicRoughness":{{"metallicFactor":1,"roughnessFactor":0.3}},"extensions":
                {{"KHR_materials_anisotropy":{{"anisotropyStrength":0.6,"anisotropyRotation":{rotation}}}}}}}"#
            );
            let scene = Square { hand, node, ..Square::of(&material, "") }.built();
            let (found, wanted) = (direction_of_highlight(&scene), (turned * rotation).rem_euclid(PI));
            let apart = (found - wanted).abs();
            assert!(apart.min(PI - apart) < 0.02, "w = {hand}{node}, {rotation}: {found}, not {wanted}");
        }
    }
}

#[test]
fn a_spots_cones_are_half_angles_about_the_nodes_minus_z() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A quarter turn about y: -z becomes -x.
    let text = parts.document(&format!(
        r#""scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0}},{{"translation":[1,2,3],"rotation":[0,{half},0,{half}],
        "extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","intensity":8,
        "spot":{{"innerConeAngle":0.3,"outerConeAngle":0.9}}}}]}}}}"#
    ));
    let scene = read(&text).build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap();
    let light = &scene.lights()[0].light;
    let middle = acos_f64(0.5 * (cos_f64(0.3) + cos_f64(0.9)));
    for (angle, wanted) in [(0.0, 1.0), (0.29, 1.0), (middle, 0.5), (0.91, 0.0)] {
        let (sin, cos) = sin_cos_f64(angle);
        let from = DVec3::new(1.0 - 2.0 * cos, 2.0 + 2.0 * sin, 3.0).as_vec3();
        // At a distance of two metres, a quarter of the intensity arrives.
        let found = light.sample_li(from, 0.0, Vec2::ZERO).map_or(0.0, |sample| sample.li.g);
        assert!((found - 2.0 * wanted).abs() < 1e-3, "{angle}: {found}");
    }
}

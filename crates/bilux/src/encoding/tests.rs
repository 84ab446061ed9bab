//! Encoded scenes come back, and nothing that comes in does harm.

use super::*;
use crate::Job;
use bilux_gallery::GENERATORS;
use bilux_math::glam::Vec4;
use bilux_math::hash::hash_words;
use bilux_math::{Motion, MotionKey, Quat, Rgb, Transform, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::texture::{Channel, Filter, Image, Texels, UvTransform, Wrap};
use bilux_scene::{
    Animation, Axis, Mesh, Object, Parameters, Span, StrokeWidths, Texture, UpHint, Value, Visibility,
    Warning,
};
use std::collections::HashMap;
use std::sync::Arc;

type Bytes = HashMap<ContentHash, Vec<u8>>;

fn bytes_of(encoded: &EncodedScene) -> Bytes {
    encoded.blobs.iter().map(|(hash, blob)| (*hash, blob.bytes())).collect()
}

fn decoded(document: &[u8], blobs: &Bytes) -> Result<SceneBuilder, EncodingError> {
    decode(document, &|hash| blobs.get(&hash).map(Vec::as_slice))
}

/// Encodes, decodes and encodes again.
fn there_and_back(scene: &SceneBuilder) -> SceneBuilder {
    let encoded = encode(scene).unwrap();
    let blobs = bytes_of(&encoded);
    let back = decoded(&encoded.document, &blobs).unwrap();
    let again = encode(&back).unwrap();
    assert!(again.document == encoded.document, "the documents differ");
    assert!(bytes_of(&again) == blobs, "the blobs differ");
    back
}

/// A texture of textures, with every option.
fn textures() -> Vec<Arc<Texture>> {
    let image = Arc::new(Image { width: 2, height: 2, texels: Texels::Bytes(vec![[200, 100, 50, 128]; 4]) });
    let plain = Arc::new(Texture {
        wrap: [Wrap::Mirror, Wrap::Clamp],
        filter: Filter::Nearest,
        transform: Some(UvTransform::new([0.1, 0.2], 0.3, [2.0, -1.5])),
        factor: Rgb::new(0.5, 0.6, 0.7),
        channel: Some(Channel::A),
        threshold: Some(0.25),
        second_uv: true,
        ..Texture::of("leaf.png", image.clone(), true)
    });
    let checks = Spec::new("", "checker").with("a", Value::Texture(0)).with("b", Rgb::grey(0.1));
    let checks = Arc::new(Texture::by_formula(checks, vec![plain.clone()], false).unwrap());
    let scaled = Spec::new("", "scale").with("a", Value::Texture(0)).with("b", 0.5f32);
    let scaled = Arc::new(Texture::by_formula(scaled, vec![checks.clone()], false).unwrap());
    vec![scaled, Arc::new(Texture::of("again", image, false)), checks, plain]
}

/// A small scene with something of everything.
fn rich() -> SceneBuilder {
    let mut scene = SceneBuilder { textures: textures(), ..SceneBuilder::default() };
    let at = Span { file: "made.toml".into(), line: 3, column: 7 };
    let paint = scene.add_material(Spec::new("paint", "diffuse").with("reflectance", Value::Texture(0)));
    let mut mixed =
        Spec::new("mixed", "mix").with("a", Value::Material(paint)).with("b", Value::Material(paint));
    mixed.span = at.clone();
    let mixed = scene.add_material(mixed);
    let mesh = Arc::new(Mesh {
        name: "sail".to_owned(),
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 4],
        uvs2: vec![Vec2::new(0.5, -0.0); 4],
        vertex_kd: vec![Rgb::grey(0.3); 4],
        vertex_ks: vec![Rgb::grey(0.4); 4],
        emission_by_kd: true,
        vertex_opacity: vec![0.25; 4],
        opacity_threshold: Some(0.5),
        point_widths: vec![0.125; 4],
        points: vec![2],
        lines: vec![[0, 1]],
        ..Mesh::quad(Vec3::ZERO, Vec3::X, Vec3::Y)
    });
    let key = |time_seconds, x: f32| MotionKey {
        time_seconds,
        translation: Vec3::X * x,
        rotation: Quat::from_xyzw(0.1, 0.2, 0.3, 0.4),
        scale: Vec3::new(1.0, 2.0, 0.5),
    };
    let place =
        Transform::rotate(Vec3::ONE, 0.4).unwrap().then(&Transform::translate(Vec3::Z * -1.0).unwrap());
    scene.objects.push(Object::new("a", mesh.clone(), paint).placed(place));
    let moving = Motion::from_keys(vec![key(0.0, 0.1), key(2.0, 1.7)]).unwrap();
    scene.objects.push(Object {
        instanced: true,
        category: "chair".to_owned(),
        visibility: Visibility::NoCamera,
        motion: moving.clone(),
        ..Object::new("b", mesh.clone(), mixed)
    });
    scene
        .objects
        .push(Object { motion: Motion::still(place).then(&moving), ..Object::new("c", mesh, mixed) });
    scene.lights.push(Spec::new("lamp", "point").with("position", Vec3::new(1.0, 2.0, 3.0)));
    let mut moves = Parameters::default();
    moves.set("position", Vec3::Z * 5.0);
    let camera = Spec::new("main", "perspective").with("position", Vec3::Z * 4.0);
    scene.cameras.push(CameraSpec { spec: camera, keyframes: vec![(1.5, moves)] });
    scene.environment_unspecified = true;
    scene.exposure_unspecified = true;
    scene.describes_all_light = true;
    scene.has_faint_emitters = true;
    scene.up = UpHint::Usually(Axis::NegZ);
    scene.unit = 0.01;
    scene.origin = bilux_math::DVec3::new(1e6, -2e6, 0.5);
    scene.stroke_widths = StrokeWidths { points: 0.1, lines: 0.05 };
    scene.settings.set_at("size", Value::from("12x8"), at.clone());
    let list = Value::List(vec![Value::Integer(1), Value::Number(-0.0), Value::Bool(true)]);
    scene.inventory.variants = vec!["winter".to_owned()];
    scene.inventory.skins = vec![String::new()];
    scene.inventory.animations = vec![Animation { name: "sway".to_owned(), seconds: 2.0, plays: true }];
    scene.warnings.push(Warning { message: "odd".to_owned(), at: at.clone() });
    scene.notes.push(Warning { message: format!("{list:?}"), at });
    scene.movement = Some(Arc::new(SceneBuilder { objects: scene.objects.clone(), ..scene.clone() }));
    scene.files.insert("made.toml".into());
    scene
}

#[test]
fn everything_comes_back() {
    let scene = rich();
    let back = there_and_back(&scene);
    let shown =
        |scene: &SceneBuilder| format!("{:?}", SceneBuilder { files: Default::default(), ..scene.clone() });
    assert_eq!(shown(&back), shown(&scene));
    assert!(Arc::ptr_eq(&back.objects[0].mesh, &back.objects[1].mesh), "meshes stay shared");
    assert!(Arc::ptr_eq(&back.textures[1].image, &back.textures[3].image), "images stay shared");
    for row in GENERATORS {
        there_and_back(&crate::generate(&Spec::new("", row.entry.name)).unwrap());
    }
}

#[test]
fn a_decoded_scene_renders_the_same_picture() {
    for scene in [rich(), crate::generate(&Spec::new("", "cornell")).unwrap()] {
        let mut settings = Parameters::default();
        settings.set("size", "12x8");
        settings.set("spp", Value::Integer(4));
        let film = |scene: &SceneBuilder| {
            let job = Job::new(scene, &settings).unwrap();
            (job.render(&crate::Quiet).unwrap().rendered.film, job.fingerprint().to_owned())
        };
        assert!(film(&scene) == film(&there_and_back(&scene)));
    }
}

#[test]
fn equal_scenes_have_equal_bytes_however_they_share() {
    let scene = rich();
    let mut apart = scene.clone();
    for object in &mut apart.objects {
        object.mesh = Arc::new((*object.mesh).clone());
    }
    for texture in &mut apart.textures {
        *texture = Arc::new((**texture).clone());
    }
    let (one, other) = (encode(&scene).unwrap(), encode(&apart).unwrap());
    assert!(one.document == other.document && one.blobs.keys().eq(other.blobs.keys()));
    assert_eq!(one.blobs.len(), 2, "one mesh and one image");
}

#[test]
fn the_bytes_are_the_same_on_every_machine() {
    let encoded = encode(&rich()).unwrap();
    let all = encoded.blobs.keys().fold(encoded.document, |all, hash| [all, hash.0.to_vec()].concat());
    // If this changes, so does the form: raise VERSION.
    assert_eq!(
        ContentHash::of(&all).to_string(),
        "d0800cd458edb118981e04d9e0e749646a58149bf638707f75c107efa59d62d9"
    );
}

#[test]
fn names_and_places_in_files_are_not_seen() {
    let scene = rich();
    let seen = |scene: &SceneBuilder| hash_what_is_seen(scene, &[], "");
    let mut renamed = scene.clone();
    renamed.objects[0].name = "another".to_owned();
    renamed.materials[0].name = "another".to_owned();
    renamed.materials[1].span = Span::default();
    Arc::make_mut(&mut renamed.textures[3]).name = "another".to_owned();
    assert_eq!(seen(&scene), seen(&renamed));
    renamed.materials[0].parameters.set("reflectance", 0.5f32);
    assert_ne!(seen(&scene), seen(&renamed));
}

#[test]
fn other_versions_and_missing_blobs_say_what_to_do() {
    let encoded = encode(&rich()).unwrap();
    let blobs = bytes_of(&encoded);
    let message = |document: &[u8], blobs: &Bytes| decoded(document, blobs).unwrap_err().to_string();
    let mut newer = encoded.document.clone();
    newer[MAGIC.len()] = 99;
    assert!(message(&newer, &blobs).contains("another version of Bilux (form 99"));
    assert!(message(&encoded.document, &Bytes::new()).contains("missing: send it too"));
    assert!(message(b"a scene", &blobs).contains("not an encoded scene"));
    let mut swapped = blobs.clone();
    swapped.values_mut().for_each(|blob| blob[20] ^= 1);
    assert!(message(&encoded.document, &swapped).contains("damaged"));
    let mut flipped = encoded.document.clone();
    flipped[200] ^= 1;
    assert!(message(&flipped, &blobs).contains("damaged"));
}

/// Decodes what only looks like a document: its hash would be right.
#[test]
fn damaged_documents_give_errors() {
    let encoded = encode(&rich()).unwrap();
    let blobs = bytes_of(&encoded);
    let content = &encoded.document[MAGIC.len() + 4..encoded.document.len() - HASH];
    let decoded =
        |content: &[u8]| decode_content(Decoder::new(content), &|hash| blobs.get(&hash).map(Vec::as_slice));
    assert!(decoded(content).is_ok());
    assert!((0..content.len()).all(|end| decoded(&content[..end]).is_err()));
    for round in 0..4000u64 {
        let mut flipped = content.to_vec();
        for flip in 0..=round % 3 {
            let random = hash_words([round, flip]) as usize;
            flipped[random % content.len()] ^= 1 << (random >> 32 & 7);
        }
        // A scene that can be encoded, or an error.
        if let Ok(scene) = decoded(&flipped) {
            let encoded = encode(&scene).unwrap();
            super::decode(&encoded.document, &|hash| blobs.get(&hash).map(Vec::as_slice)).unwrap();
        }
    }
}

#[test]
fn lists_within_lists_without_end_are_refused() {
    let mut deep = Value::Bool(true);
    for _ in 0..10_000 {
        deep = Value::List(vec![deep]);
    }
    let mut bytes = Encoder::default();
    let mut inner = &deep;
    while let Value::List(list) = inner {
        4u8.write(&mut bytes);
        1u64.write(&mut bytes);
        inner = &list[0];
    }
    let error = Value::read(&mut Decoder::new(&bytes.bytes)).unwrap_err();
    assert!(error.to_string().contains("lists within each other"), "{error}");
    // Taken apart by hand: dropping it whole would take as much stack.
    while let Value::List(mut list) = deep {
        deep = list.remove(0);
    }
}

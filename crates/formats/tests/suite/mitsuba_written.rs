//! Scenes of Mitsuba as they are written: what comes back.

use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::{Rgb, Transform, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::sync::Arc;

fn quad() -> Mesh {
    Mesh { name: "quad".into(), ..Mesh::quad(Vec3::new(0.1, 0.2, 0.3), Vec3::X * 1.5, Vec3::Y) }
}

/// Writes a scene and reads it again; also the file, and the warnings of the writer.
fn there(scene: &SceneBuilder) -> (SceneBuilder, String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xml");
    let said = write(&path, scene, &WriteOptions::default()).unwrap();
    let back = read(&path, &ReadOptions::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    (back, text, said.into_iter().map(|warning| warning.message).collect())
}

fn dressed(spec: Spec) -> SceneBuilder {
    let mut scene = SceneBuilder { describes_all_light: true, ..SceneBuilder::default() };
    let material = scene.add_material(spec);
    scene.objects.push(Object::new("a <b>", Arc::new(quad()), material));
    scene
}

/// A material after it was written and read.
fn back_of(spec: Spec) -> Spec {
    let (back, text, said) = there(&dressed(spec));
    assert!(said.is_empty(), "{said:?}\n{text}");
    back.materials[back.objects[0].material].clone()
}

#[test]
fn meshes_and_their_texture_coordinates_come_back_to_the_bit() {
    let scene = dressed(Spec::new("m", "diffuse"));
    let (back, text, _) = there(&scene);
    let (a, b) = (&scene.objects[0].mesh, &back.objects[0].mesh);
    assert_eq!((&a.positions, &a.normals, &a.triangles), (&b.positions, &b.normals, &b.triangles));
    let off = a.uvs.iter().zip(&b.uvs).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
    assert!(off < 1e-6 && text.contains("a &lt;b&gt;"), "{off} {text}");
}

#[test]
fn materials_come_back() {
    let shade = Value::triple([0.25, 0.5, 0.75]);
    let diffuse = back_of(Spec::new("m", "diffuse").with("reflectance", shade.clone()));
    assert_eq!((diffuse.kind.as_str(), diffuse.colour("reflectance").unwrap().g), ("diffuse", 0.5));
    let glass = Spec::new("m", "dielectric").with("eta", 1.4).with("absorption", shade.clone());
    let glass = back_of(glass);
    assert_eq!((glass.number("eta"), glass.colour("absorption").unwrap().b), (Some(1.4), 0.75));
    let rough = back_of(Spec::new("m", "dielectric").with("roughness", 0.5));
    assert!((rough.number("roughness").unwrap() - 0.5).abs() < 1e-6);
    for kind in ["conductor", "dielectric"] {
        let beckmann = back_of(Spec::new("m", kind).with("roughness", 0.5).with("distribution", "beckmann"));
        assert_eq!(beckmann.parameters.find("distribution").unwrap().0, &Value::from("beckmann"));
    }
    let gold = back_of(Spec::new("m", "conductor").with("metal", "gold").with("roughness", 0.4));
    assert_eq!(gold.parameters.find("distribution"), None);
    let [eta, _] = bilux_scene::materials::metal_indices("gold").unwrap();
    assert!((gold.colour("eta").unwrap() - eta).map(f32::abs).max_channel() < 1e-6);
    let pane = back_of(Spec::new("m", "dielectric").with("thin", true).with("opacity", 0.5));
    assert_eq!(pane.number("opacity"), Some(0.5));
    assert_eq!(pane.parameters.find("thin").unwrap().0, &Value::Bool(true));
    let fog = Spec::new("m", "interface").with("scattering", 2.0).with("scattering_anisotropy", 0.5);
    let fog = back_of(fog.with("absorption", 1.0));
    assert_eq!((fog.kind.as_str(), fog.number("scattering_anisotropy")), ("interface", Some(0.5)));
    assert!((fog.colour("scattering").unwrap().r - 2.0).abs() < 1e-6);
    // What has both sides needs to say so there.
    let (_, text, _) = there(&dressed(Spec::new("m", "principled")));
    assert!(text.contains("type=\"twosided\"") && text.contains("type=\"roughplastic\""), "{text}");
}

#[test]
fn lights_come_back_as_bright_as_they_were() {
    let mut scene = dressed(Spec::new("m", "diffuse"));
    let at = Vec3::new(1.0, 2.0, 3.0);
    scene.lights = vec![
        Spec::new("p", "point").with("position", at).with("intensity", Value::triple([8.0, 4.0, 2.0])),
        Spec::new("d", "directional").with("direction", Vec3::NEG_X).with("irradiance", 3.0),
        Spec::new("e", "environment").with("radiance", 0.5).with("scale", 2.0),
        Spec::new("b", "sphere").with("position", at).with("radius", 0.25).with("radiance", 4.0),
        Spec::new("r", "rect").with("position", at).with("radiance", 5.0).with("sides", "front"),
    ];
    let (back, text, said) = there(&scene);
    assert!(said.is_empty(), "{said:?}");
    let of = |kind: &str| back.lights.iter().find(|light| light.kind == kind).expect(kind);
    assert_eq!(of("point").colour("intensity").unwrap().to_array(), [8.0, 4.0, 2.0]);
    assert_eq!(of("directional").vector("direction"), Some(Vec3::NEG_X));
    assert_eq!(of("environment").colour("radiance"), Some(Rgb::WHITE));
    assert_eq!(
        (of("sphere").number("radius"), of("sphere").colour("radiance")),
        (Some(0.25), Some(Rgb::grey(4.0)))
    );
    // The panel lies in x and z, and its front is where x turns to z: down.
    assert!(text.contains("<matrix value=\"0.5 0 0 1 0 0 -1 2 0 0.5 0 3 0 0 0 1\"/>"), "{text}");
    let glows = |object: &&Object| back.materials[object.material].colour("emission") == Some(Rgb::grey(5.0));
    let panel = back.objects.iter().find(glows).unwrap();
    let bounds = panel.motion.at(0.0).bounds(&panel.mesh.bounds());
    assert_eq!((bounds.min, bounds.max), (Vec3::new(0.5, 2.0, 2.5), Vec3::new(1.5, 2.0, 3.5)));
}

/// Shapes of Mitsuba emit from their fronts.
#[test]
fn what_emits_on_both_sides_is_written_twice() {
    let (_, text, _) = there(&dressed(Spec::new("m", "diffuse").with("emission", 2.0)));
    assert_eq!(text.matches("<emitter type=\"area\">").count(), 2, "{text}");
    assert_eq!(text.matches("\"flip_normals\" value=\"true\"").count(), 1);
    let front = Spec::new("m", "diffuse").with("emission", 2.0).with("emission_sides", "front");
    assert_eq!(there(&dressed(front)).1.matches("<emitter type=\"area\">").count(), 1);
}

#[test]
fn shared_meshes_are_groups_and_cameras_keep_their_lens() {
    let mut scene = dressed(Spec::new("m", "diffuse"));
    let again = scene.objects[0].clone().placed(Transform::translate(Vec3::X * 2.0).unwrap());
    scene.objects.push(again);
    let spec = Spec::new("main", "perspective")
        .with("position", Vec3::new(1.0, 2.0, 3.0))
        .with("look_at", Vec3::new(1.0, 2.0, -1.0))
        .with("fov", 35.0)
        .with("principal_x", 0.4)
        .with("aperture", 0.02);
    scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    scene.settings.set("size", "300x200");
    scene.settings.set("max_depth", Value::Integer(7));
    let (back, text, said) = there(&scene);
    assert!(said.is_empty(), "{said:?}");
    assert_eq!(text.matches("type=\"ply\"").count(), 1);
    assert!(Arc::ptr_eq(&back.objects[0].mesh, &back.objects[1].mesh));
    let camera = &back.cameras[0].spec;
    for (key, wanted) in [("fov", 35.0), ("principal_x", 0.4), ("aperture", 0.02), ("focus", 4.0)] {
        let found = camera.number(key).unwrap();
        assert!((found / wanted - 1.0).abs() < 1e-5, "{key}: {found}");
    }
    assert_eq!(camera.vector("position"), Some(Vec3::new(1.0, 2.0, 3.0)));
    // Mitsuba counts the edges of a path.
    assert!(text.contains("<integer name=\"max_depth\" value=\"8\"/>"), "{text}");
    assert_eq!(back.settings.find("max_depth").unwrap().0, &Value::Integer(7));
}

/// Viewers light what has no light; Mitsuba does not.
#[test]
fn a_scene_without_light_is_named() {
    let dark = SceneBuilder { describes_all_light: false, ..dressed(Spec::new("m", "diffuse")) };
    assert_eq!(there(&dark).2, ["the scene has no light, and Mitsuba adds none: it is black there"]);
    let glowing = dressed(Spec::new("m", "diffuse").with("emission", 1.0));
    assert!(there(&SceneBuilder { describes_all_light: false, ..glowing }).2.is_empty());
}

//! pbrt files that Bilux writes: round trips.

use crate::read_text;
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{SceneBuilder, Spec, Value};
use std::path::Path;

/// Writes a scene and reads it back; returns the warnings and the scene.
fn there_and_back(scene: &SceneBuilder, folder: &Path) -> (Vec<String>, SceneBuilder) {
    let path = folder.join("a scene.pbrt");
    let reported = write(&path, scene, &WriteOptions::default()).unwrap();
    let back = read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    (reported.into_iter().map(|warning| warning.message).collect(), back)
}

fn scene(toml: &str) -> SceneBuilder {
    read_text("toml", toml).unwrap_or_else(|error| panic!("{error}"))
}

/// Writes a scene from TOML text and reads it back, with a plain material where none is named.
fn there(toml: &str) -> (Vec<String>, SceneBuilder) {
    let mut original = scene(toml);
    for spec in original.materials.iter_mut().filter(|spec| spec.kind == "phong") {
        *spec = Spec::new(&spec.name, "diffuse");
    }
    there_and_back(&original, tempfile::tempdir().unwrap().path())
}

/// The material of the only object.
fn material(toml: &str) -> (Vec<String>, Spec) {
    let text =
        format!("[[material]]\nname = \"m\"\n{toml}\n[[model]]\nshape = \"sphere\"\nmaterial = \"m\"\n");
    let (reported, back) = there(&text);
    (reported, back.materials[back.objects[0].material].clone())
}

fn value(spec: &Spec, key: &str) -> Value {
    spec.parameters.find(key).unwrap_or_else(|| panic!("{key}: {spec:?}")).0.clone()
}

#[track_caller]
fn assert_near(spec: &Spec, key: &str, wanted: &[f32]) {
    let found: Vec<f32> = match value(spec, key) {
        Value::Number(x) => vec![x as f32],
        Value::List(list) => {
            list.iter().map(|x| if let Value::Number(x) = x { *x as f32 } else { -1.0 }).collect()
        }
        other => panic!("{key}: {other:?}"),
    };
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-4 * (1.0 + b.abs());
    assert!(
        found.len() == wanted.len() && found.iter().zip(wanted).all(near),
        "{key}: {found:?}, not {wanted:?}"
    );
}

#[test]
fn cameras_come_back_as_they_stood() {
    for (size, mirrored) in [("640x480", false), ("300x500", false), ("400x400", true)] {
        let (reported, back) = there(&format!(
            "[render]\nsize = \"{size}\"\nspp = 8\nseed = 3\nmax_depth = 7\nfilter = \"tent\"\n[camera]\nposition = [1, 2, 6]\n\
             look_at = [0, 0.5, 0]\nfov = 33\naperture = 0.05\nmirrored = {mirrored}\n[[model]]\nshape = \"floor\"\n"
        ));
        assert!(reported.is_empty(), "{reported:?}");
        let spec = &back.cameras[0].spec;
        assert_near(spec, "fov", &[33.0]);
        assert_near(spec, "aperture", &[0.05]);
        assert_near(spec, "position", &[1.0, 2.0, 6.0]);
        assert_near(spec, "focus", &[Vec3::new(1.0, 1.5, 6.0).length()]);
        assert_eq!(spec.parameters.find("mirrored").is_some(), mirrored);
        for (key, wanted) in [("size", Value::from(size)), ("filter", "tent".into())] {
            assert_eq!(back.settings.find(key).unwrap().0, &wanted, "{key}");
        }
        for (key, wanted) in [("spp", 8), ("seed", 3), ("max_depth", 7)] {
            assert_eq!(back.settings.find(key).unwrap().0, &Value::Integer(wanted), "{key}");
        }
    }
    let (_, back) = there("[camera]\nkind = \"orthographic\"\nheight = 3\n[[model]]\nshape = \"floor\"\n");
    assert_eq!(back.cameras[0].spec.kind, "orthographic");
    assert_near(&back.cameras[0].spec, "height", &[3.0]);
}

#[test]
fn lights_come_back() {
    let (reported, back) = there(
        "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\nintensity = [4, 5, 6]\n\
         [[light]]\nkind = \"spot\"\nposition = [0, 4, 0]\nlook_at = [0, 0, 1]\nintensity = 9\nangle = 25\ninner_angle = 20\n\
         [[light]]\nkind = \"directional\"\ndirection = [0, -2, 0]\nirradiance = [1, 2, 3]\n\
         [[light]]\nkind = \"sphere\"\nposition = [3, 3, 3]\nradius = 0.25\nradiance = [7, 8, 9]\n\
         [[light]]\nkind = \"environment\"\nradiance = [0.1, 0.2, 0.3]\nscale = 2\n\
         [[light]]\nkind = \"rect\"\nposition = [0, 5, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 1]\nintensity = 6\nsides = \"front\"\n\
         [[light]]\nkind = \"ambient\"\n",
    );
    assert_eq!(reported, ["pbrt files cannot store lights of kind 'ambient': left out"]);
    let of =
        |kind: &str| back.lights.iter().find(|light| light.kind == kind).unwrap_or_else(|| panic!("{kind}"));
    assert_near(of("point"), "intensity", &[4.0, 5.0, 6.0]);
    assert_near(of("spot"), "angle", &[25.0]);
    assert_near(of("spot"), "inner_angle", &[20.0]);
    assert_near(of("directional"), "direction", &[0.0, -1.0, 0.0]);
    assert_near(of("directional"), "irradiance", &[1.0, 2.0, 3.0]);
    assert_near(of("sphere"), "radiance", &[7.0, 8.0, 9.0]);
    assert_near(of("sphere"), "radius", &[0.25]);
    assert_near(of("environment"), "radiance", &[0.2, 0.4, 0.6]);
    let panel = &back.objects[0];
    let spec = &back.materials[panel.material];
    assert_near(spec, "emission", &[3.0; 3]);
    assert_eq!(value(spec, "emission_sides"), "front".into());
    let [a, b, c] = panel.mesh.triangles[0].map(|i| panel.mesh.positions[i as usize]);
    assert!((b - a).cross(c - a).y < 0.0, "edge_u × edge_v points down");
}

#[test]
fn materials_come_back() {
    let quiet = |toml: &str| {
        let (reported, spec) = material(toml);
        assert!(reported.is_empty(), "{toml}: {reported:?}");
        spec
    };
    let spec = quiet("kind = \"diffuse\"\nreflectance = [0.1, 0.2, 0.3]");
    assert_eq!((&*spec.kind, &*spec.name), ("diffuse", "m"));
    assert_near(&spec, "reflectance", &[0.1, 0.2, 0.3]);
    let spec = quiet("kind = \"conductor\"\nmetal = \"gold\"\nroughness = 0.4\nanisotropy = 0.5");
    assert_near(&spec, "eta", &[0.061, 0.503, 1.463]);
    assert_near(&spec, "roughness", &[0.4]);
    assert_near(&spec, "anisotropy", &[0.5]);
    let spec = quiet("kind = \"conductor\"\neta = [1, 2, 3]\nk = [4, 5, 6]\nroughness = 0");
    assert_near(&spec, "k", &[4.0, 5.0, 6.0]);
    let spec = quiet("kind = \"dielectric\"\neta = 1.7\nabsorption = [1, 2, 3]\nroughness = 0.2");
    assert_eq!(&*spec.kind, "dielectric");
    assert_near(&spec, "eta", &[1.7]);
    assert_near(&spec, "absorption", &[1.0, 2.0, 3.0]);
    assert_near(&spec, "roughness", &[0.2]);
    let spec =
        quiet("kind = \"interface\"\nscattering = [1, 2, 3]\nscattering_anisotropy = 0.4\nabsorption = 0.5");
    assert_eq!(&*spec.kind, "interface");
    assert_near(&spec, "scattering", &[1.0, 2.0, 3.0]);
    assert_near(&spec, "scattering_anisotropy", &[0.4]);
    let spec = quiet(
        "kind = \"principled\"\nbase_color = [0.8, 0.4, 0.1]\nspecular_ior = 1.6\nspecular_roughness = 0.5",
    );
    assert_eq!(&*spec.kind, "principled");
    assert_near(&spec, "base_color", &[0.8, 0.4, 0.1]);
    assert_near(&spec, "specular_ior", &[1.6]);
    assert_near(&spec, "specular_roughness", &[0.5]);
    let spec =
        quiet("kind = \"principled\"\nbase_metalness = 0\ntransmission_weight = 1\nthin_walled = true");
    assert_eq!((&*spec.kind, value(&spec, "thin")), ("dielectric", true.into()));
    let spec = quiet("kind = \"diffuse\"\nreflectance = 0.5\nemission = [1, 2, 3]\nopacity = 0.5");
    assert_near(&spec, "emission", &[1.0, 2.0, 3.0]);
    assert_near(&spec, "opacity", &[0.5]);
    let spec = quiet("kind = \"dielectric\"\nglass = \"sf11\"");
    assert_near(&spec, "eta", &[1.7847]);
    assert_near(&spec, "dispersion", &[20.0 / 25.68]);
    let (reported, spec) = material("kind = \"dielectric\"\nglass = \"diamond\"");
    assert_near(&spec, "eta", &[2.4175]);
    assert_eq!(reported, ["pbrt files cannot store 'dispersion' of a dielectric material: left out"]);
    let (reported, _) = material("kind = \"diffuse\"\nroughness = 0.5");
    assert_eq!(reported, ["pbrt files cannot store 'roughness' of a diffuse material: left out"]);
    let (reported, spec) = material("kind = \"principled\"\nfuzz_weight = 1\ncoat_weight = 0.5");
    assert_eq!((reported.len(), &*spec.kind), (2, "principled"), "{reported:?}");
}

#[test]
fn mixtures_come_back() {
    let (reported, spec) = material("kind = \"principled\"\nbase_metalness = 0.25\ncoat_weight = 0");
    assert_eq!((&*spec.kind, reported.len()), ("mix", 1), "{reported:?}");
    assert_near(&spec, "amount", &[0.25]);
}

#[test]
fn textures_come_back_as_they_were() {
    use bilux_pictures::{Picture, write as write_picture};
    let folder = tempfile::tempdir().unwrap();
    let texels = (0..16).map(|i| Rgb::new(i as f32 / 15.0, 0.25, 1.0 - i as f32 / 15.0)).collect();
    let picture = Picture::from_rgb(4, 4, texels).unwrap();
    write_picture(folder.path().join("t.png"), &picture, &Default::default()).unwrap();
    let toml = "[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = { texture = \"t.png\" }\n\
        opacity = { texture = \"t.png\", channel = \"b\" }\n[[model]]\nshape = \"quad\"\nmaterial = \"m\"\n";
    std::fs::write(folder.path().join("s.toml"), toml).unwrap();
    let original = read(&folder.path().join("s.toml"), &ReadOptions::default()).unwrap();
    let (reported, back) = there_and_back(&original, folder.path());
    assert!(reported.is_empty(), "{reported:?}");
    let texture = |scene: &SceneBuilder, key: &str| {
        let spec = &scene.materials[scene.objects[0].material];
        match value(spec, key) {
            Value::Texture(index) => scene.textures[index].clone(),
            other => panic!("{other:?}"),
        }
    };
    for key in ["reflectance", "opacity"] {
        let (ours, theirs) = (texture(&original, key), texture(&back, key));
        for (u, v) in [(0.1, 0.1), (0.3, 0.8), (0.9, 0.4)] {
            let [a, b] = [&ours, &theirs].map(|texture| match key {
                "opacity" => Rgb::grey(texture.number(Vec2::new(u, v))),
                _ => texture.at(Vec2::new(u, v)),
            });
            assert!((a + b * -1.0).to_array().iter().all(|c| c.abs() < 0.005), "{key} {u} {v}: {a:?} {b:?}");
        }
    }
}

#[test]
fn the_environment_map_round_trips_with_its_orientation() {
    let (_, back) = there(
        "[[light]]\nkind = \"environment\"\nzenith = [0, 0, 4]\nhorizon = [2, 0, 0]\nground = [0, 1, 0]\n[[model]]\nshape = \"floor\"",
    );
    let Value::Texture(index) = value(&back.lights[0], "radiance") else { panic!() };
    let sky = &back.textures[index];
    let at = |row: f32| sky.at(Vec2::new(0.3, row));
    assert!((at(0.99).b - 4.0).abs() < 0.1, "{:?}", at(0.99));
    assert!((at(0.5).r - 2.0).abs() < 0.1, "{:?}", at(0.5));
    assert!((at(0.01).g - 1.0).abs() < 0.1, "{:?}", at(0.01));
}

#[test]
fn repeated_meshes_become_one_object() {
    let (reported, back) = there(
        "[[model]]\nshape = \"sphere\"\nname = \"a\"\n[[model]]\nshape = \"box\"\ntranslate = [3, 0, 0]\nscale = [1, 2, 1]\n",
    );
    assert!(reported.is_empty() && back.objects.len() == 2, "{reported:?}");
    let mut scene = scene("[[model]]\nshape = \"sphere\"\n");
    for i in 1..5 {
        let place = bilux_math::DMat4::from_translation(bilux_math::DVec3::new(f64::from(i), 0.0, 0.0));
        let copy = scene.objects[0].clone();
        scene.objects.push(copy.placed(bilux_math::Transform::from_matrix(place).unwrap()));
    }
    let folder = tempfile::tempdir().unwrap();
    let (_, back) = there_and_back(&scene, folder.path());
    assert_eq!(back.objects.len(), 5);
    let first = &back.objects[0].mesh;
    assert!(back.objects.iter().all(|object| std::sync::Arc::ptr_eq(&object.mesh, first)));
    assert!((back.bounds(0.0).max.x - scene.bounds(0.0).max.x).abs() < 1e-5);
    let files = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 2, "the scene and one mesh");
}

/// A camera whose `frame` is wider than the picture shows all of it: tan(fov / 2) times frame over aspect.
#[test]
fn a_frame_wider_than_the_picture_stays_whole() {
    for (size, shorter) in [("64x64", 1.5), ("128x64", 1.0), ("32x64", 1.5)] {
        let scene = scene(&format!(
            "[render]\nsize = \"{size}\"\n[camera]\nkind = \"perspective\"\nfov = 40\nframe = 1.5\n\
             [[model]]\nshape = \"quad\"\n"
        ));
        // Of the shorter side, as pbrt has it; the vertical one, as Mitsuba does.
        let aspect =
            size.split_once('x').map(|(w, h)| w.parse::<f32>().unwrap() / h.parse::<f32>().unwrap()).unwrap();
        let tan = bilux_math::transcendental::tan(20f32.to_radians());
        let degrees = |tan: f32| 2.0 * bilux_math::transcendental::atan(tan).to_degrees();
        let wanted = [degrees(tan * shorter), degrees(tan * (1.5 / aspect).max(1.0))];
        let folder = tempfile::tempdir().unwrap();
        for (name, wanted) in ["x.pbrt", "x.xml"].into_iter().zip(wanted) {
            let path = folder.path().join(name);
            write(&path, &scene, &WriteOptions::default()).unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            let (_, rest) = text
                .split_once(if name == "x.pbrt" { "\"float fov\" [ " } else { "name=\"fov\" value=\"" })
                .unwrap();
            let end = rest.find([' ', '"']).unwrap();
            let found: f32 = rest[..end].parse().unwrap();
            assert!((found - wanted).abs() < 1e-3, "{size} {name}: {found}, not {wanted}");
        }
    }
}

/// A warning says what pbrt cannot hold of a picture that shines; there is none for a picture that lies as pbrt puts it.
#[test]
fn pictures_that_shine_say_what_is_lost_of_their_place() {
    use bilux_scene::Texture;
    use bilux_scene::texture::{UvTransform, Wrap};
    let placed = UvTransform::from_array([2.0, 0.0, 0.0, 3.0, 0.25, 0.5]);
    for (transform, second_uv, wrap, is_lost) in [
        (None, false, [Wrap::Repeat; 2], false),
        (Some(placed), false, [Wrap::Repeat; 2], true),
        (None, true, [Wrap::Repeat; 2], true),
        (None, false, [Wrap::Clamp, Wrap::Repeat], true),
    ] {
        let mut original = scene(
            "[[material]]\nname = \"lamp\"\nkind = \"diffuse\"\n[[model]]\nshape = \"quad\"\n\
                                  material = \"lamp\"\n",
        );
        let picture = Texture { transform, second_uv, wrap, ..Texture::missing("lamp.png") };
        original.textures.push(picture.into());
        let lamp = original.objects[0].material;
        original.materials[lamp].parameters.set("emission", Value::Texture(original.textures.len() - 1));
        let (said, _) = there_and_back(&original, tempfile::tempdir().unwrap().path());
        assert_eq!(said.iter().any(|one| one.contains("how this one is placed")), is_lost, "{said:?}");
    }
}

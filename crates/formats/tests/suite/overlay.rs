//! Native scenes that overlay files of other formats: what they change, and what they leave unchanged.

use bilux_formats::{FormatError, ReadOptions, read};
use bilux_scene::SceneBuilder;
use std::fs;

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n\
    o wheel left\nusemtl Rubber.001\nf 1 2 3\no wheel right\nusemtl Rubber.002\nf 1 2 4\no body\nusemtl Paint\nf 1 3 4\n";
const MTL: &str =
    "newmtl Rubber.001\nKd 0.1 0.1 0.1\nnewmtl Rubber.002\nKd 0.2 0.2 0.2\nnewmtl Paint\nKd 1 0 0\n";
const OURS: &str = "[[material]]\nname = \"gold\"\nkind = \"conductor\"\nmetal = \"gold\"\n\
    [[material]]\nname = \"white\"\nkind = \"diffuse\"\n";

/// A scene that overlays a car of three objects.
fn over_a_car(toml: &str) -> Result<SceneBuilder, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("car.obj", OBJ), ("a.mtl", MTL), ("scene.toml", toml)] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    read(&folder.path().join("scene.toml"), &ReadOptions::default())
}

/// The material of each object, by name.
fn made_of(replacements: &str) -> Result<Vec<(String, String)>, FormatError> {
    let scene = over_a_car(&format!("include = [\"car.obj\"]\n{OURS}{replacements}"))?;
    let pairs = scene.objects.iter().map(|o| (o.name.clone(), scene.materials[o.material].name.clone()));
    Ok(pairs.collect())
}

fn materials(replacements: &str) -> Vec<String> {
    made_of(replacements).unwrap_or_else(|error| panic!("{error}")).into_iter().map(|(_, m)| m).collect()
}

#[test]
fn materials_are_replaced_by_name_by_pattern_and_by_object() {
    assert_eq!(materials(""), ["Rubber.001", "Rubber.002", "Paint"]);
    let by_name = "[[replace]]\nmaterial = \"Paint\"\nwith = \"gold\"\n";
    assert_eq!(materials(by_name), ["Rubber.001", "Rubber.002", "gold"]);
    let by_pattern = "[[replace]]\nmaterial = \"Rubber*\"\nwith = \"gold\"\n";
    assert_eq!(materials(by_pattern), ["gold", "gold", "Paint"]);
    let by_object = "[[replace]]\nobject = \"*right\"\nwith = \"gold\"\n";
    assert_eq!(materials(by_object), ["Rubber.001", "gold", "Paint"]);
    let both = "[[replace]]\nobject = \"wheel*\"\nmaterial = \"*1\"\nwith = \"gold\"\n";
    assert_eq!(materials(both), ["gold", "Rubber.002", "Paint"]);
    let several = "[[replace]]\nmaterial = \"*\"\nwith = \"white\"\n[[replace]]\nmaterial = \"Paint\"\nwith = \"gold\"\n";
    assert_eq!(
        materials(several),
        ["white", "white", "gold"],
        "the last one counts, by the names in the file"
    );
}

#[test]
fn a_pattern_means_the_materials_of_models_and_not_ones_own() {
    let floor = "[[model]]\nshape = \"quad\"\nname = \"floor\"\nmaterial = \"white\"\n";
    let all = format!("{floor}[[replace]]\nmaterial = \"*\"\nwith = \"gold\"\n");
    assert_eq!(materials(&all), ["gold", "gold", "gold", "white"]);
    let by_name = format!("{floor}[[replace]]\nmaterial = \"white\"\nwith = \"gold\"\n");
    assert_eq!(materials(&by_name)[3], "gold");
    let by_object = format!("{floor}[[replace]]\nobject = \"f*\"\nwith = \"gold\"\n");
    assert_eq!(materials(&by_object)[3], "gold");
    let own = format!("{floor}[[replace]]\nmaterial = \"whi*\"\nwith = \"gold\"\n");
    assert!(made_of(&own).unwrap_err().to_string().contains("there is no material 'whi*'"));
}

#[test]
fn a_replacement_without_a_match_suggests_the_nearest_name() {
    let refusal = |text: &str| made_of(text).expect_err("this should be refused").to_string();
    let cases = [
        (
            "[[replace]]\nmaterial = \"Pant\"\nwith = \"gold\"",
            "scene.toml:10:12: there is no material 'Pant';",
        ),
        ("[[replace]]\nmaterial = \"Pant\"\nwith = \"gold\"", "did you mean 'Paint'?"),
        ("[[replace]]\nobject = \"wheels left\"\nwith = \"gold\"", "did you mean 'wheel left'?"),
        ("[[replace]]\nmaterial = \"Glass*\"\nwith = \"gold\"", "known: Paint, Rubber.001, Rubber.002"),
        ("[[replace]]\nmaterial = \"Paint\"\nwith = \"gld\"", "did you mean 'gold'?"),
        ("[[replace]]\nmaterial = \"Paint\"\n", "with (the replacement material)"),
        ("[[replace]]\nwith = \"gold\"\n", "material, or object"),
        ("[[replace]]\nmaterials = \"Paint\"\nwith = \"gold\"", "did you mean 'material'?"),
        (
            "[[replace]]\nmaterial = \"Paint\"\nobject = \"wheel*\"\nwith = \"gold\"",
            "this name and this material",
        ),
    ];
    for (text, part) in cases {
        let message = refusal(text);
        assert!(message.contains(part), "{text}: {message}");
    }
}

#[test]
fn the_overlay_comes_first_and_takes_precedence() {
    let glb = "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0,1]}],\
        \"extensionsUsed\":[\"KHR_lights_punctual\"],\
        \"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"name\":\"theirs\"}]}},\
        \"nodes\":[{\"camera\":0},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\
        \"cameras\":[{\"name\":\"theirs\",\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":1}}]}";
    let folder = tempfile::tempdir().unwrap();
    let toml = "include = [\"a.gltf\"]\n[camera]\nname = \"ours\"\n[[light]]\nname = \"ours\"\nkind = \"point\"\n\
        [[model]]\nshape = \"floor\"\n";
    fs::write(folder.path().join("a.gltf"), glb).unwrap();
    fs::write(folder.path().join("scene.toml"), toml).unwrap();
    let scene = read(&folder.path().join("scene.toml"), &ReadOptions::default()).unwrap();
    let cameras: Vec<&str> = scene.cameras.iter().map(|camera| camera.spec.name.as_str()).collect();
    let lights: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!((cameras, lights, scene.objects.len()), (vec!["ours", "theirs"], vec!["ours", "theirs"], 1));
}

#[test]
fn a_change_gives_parameters_new_values_and_keeps_the_others() {
    let floor = "[[material]]\nname = \"oak\"\nkind = \"diffuse\"\nreflectance = 0.5\nroughness = 0.25\n\
        [[light]]\nname = \"lamp\"\nkind = \"point\"\n[camera]\nfov = 50\n";
    let changed = |changes: &str| over_a_car(&format!("include = [\"car.obj\"]\n{floor}{changes}"));
    let scene = changed(
        "[[change]]\nmaterial = \"oak\"\nreflectance = [0.1, 0.2, 0.3]\n[[change]]\nlight = 0\nintensity = 7\n\
         [[change]]\ncamera = 0\nfov = 20\n[[change]]\nmaterial = \"Paint\"\nkd = 0.75\n",
    )
    .unwrap();
    let material = |name: &str| scene.materials.iter().find(|spec| spec.name == name).unwrap();
    assert_eq!(
        (material("oak").number("roughness"), material("Paint").number("kd")),
        (Some(0.25), Some(0.75))
    );
    assert_eq!(material("oak").colour("reflectance").unwrap().to_array(), [0.1, 0.2, 0.3]);
    assert_eq!(scene.lights[0].number("intensity"), Some(7.0));
    assert_eq!(scene.cameras[0].spec.number("fov"), Some(20.0));
    for (wrong, part) in [
        ("[[change]]\nmaterial = \"oka\"\nreflectance = 1\n", "did you mean 'oak'"),
        ("[[change]]\nlight = 3\nintensity = 1\n", "there is no light 3"),
        ("[[change]]\nmaterial = \"oak\"\nreflektance = 1\n", "'reflectance'"),
        ("[[change]]\nreflectance = 1\n", "one of material, light or camera"),
        ("[[change]]\nmaterial = 0\nlight = 0\n", "one of material, light or camera"),
        ("[[change]]\nmaterial = -1\nreflectance = 1\n", "a number from 0"),
        ("[[change]]\nmaterial = \"oak\"\nreflectance = 2\n", "from 0 to 1"),
    ] {
        let error = changed(wrong).expect_err(wrong).to_string();
        assert!(error.contains(part) && error.contains("scene.toml:"), "{error}");
    }
}

#[test]
fn a_scene_with_a_base_is_that_scene() {
    let base = |toml: &str| over_a_car(&format!("base = \"car.obj\"\n{toml}"));
    let scene = base("[render]\nspp = 3\n[[change]]\nmaterial = \"Paint\"\nkd = 0.5\n").unwrap();
    assert_eq!((scene.objects.len(), scene.materials.len()), (3, 3));
    assert_eq!(scene.up, bilux_scene::UpHint::Usually(bilux_scene::Axis::Y), "as in an .obj");
    assert_eq!(scene.settings.find("spp").unwrap().0, &bilux_scene::Value::Integer(3));
    assert!(scene.environment_unspecified == base("").unwrap().environment_unspecified);
    for (wrong, part) in [
        ("base = \"scene.toml\"\n", "based on itself"),
        ("base = \"none.obj\"\n", "none.obj"),
        ("base = \"a.mtl\"\n", "a.mtl"),
        ("base = \"car.obj\"\n[[light]]\nkind = \"point\"\n", "no key 'light' of a scene with a base"),
        ("base = \"car.obj\"\ninclude = [\"other.toml\"]\n", "other.toml"),
        ("base = 3\n", "text in quotes"),
    ] {
        let error = over_a_car(wrong).expect_err(wrong).to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn an_overlay_that_is_written_is_read_again() {
    use bilux_scene::{Change, Parameters, Part, Span, Value, Which};
    let change = |which: Which, key: &str, value: Value| {
        let (part, key, at) = (Part::Material, key.to_owned(), Span::default());
        Change { part, which, key, value, at }
    };
    let name = |name: &str| Which::Name(name.to_owned());
    let mut settings = Parameters::default();
    settings.set("tonemap", "a \"curve\"");
    let changes = [
        change(name("Paint"), "kd", Value::triple([0.1, 0.25, 1.0])),
        change(name("Paint"), "exponent", Value::Integer(9)),
        change(Which::Number(0), "kd", Value::Number(0.2)),
    ];
    let text = bilux_formats::overlay("car.obj", &settings, &changes);
    let scene = over_a_car(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(scene.settings.find("tonemap").unwrap().0, &Value::from("a \"curve\""));
    assert_eq!(scene.materials[0].number("kd"), Some(0.2));
    let paint = scene.materials.iter().find(|spec| spec.name == "Paint").unwrap();
    assert_eq!(paint.colour("kd").unwrap().to_array(), [0.1, 0.25, 1.0]);
    assert_eq!(text.matches("[[change]]").count(), 2, "{text}");
}

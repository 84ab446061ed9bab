//! Scattering inside of glTF's materials, by two drafts of an extension, and media that glTF and OBJ cannot hold.

use crate::gltf_conventions::{Square, one_picture, read};
use bilux_formats::{ReadOptions, WriteOptions, write};
use bilux_math::Rgb;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::sync::Arc;

fn material(extensions: &str) -> Spec {
    let scene = read(&Square::of(&format!(r#"{{"extensions":{{{extensions}}}}}"#), "").text());
    scene.materials[scene.objects[0].material].clone()
}

fn number(spec: &Spec, key: &str) -> f64 {
    match spec.parameters.find(key) {
        Some((Value::Number(x), _)) => *x,
        other => panic!("{key}: {other:?}"),
    }
}

fn assert_colour(spec: &Spec, key: &str, wanted: [f32; 3]) {
    let found = spec.colour(key).unwrap_or_else(|| panic!("no {key}"));
    for c in 0..3 {
        assert!((found[c] - wanted[c]).abs() < 1e-5, "{key}: {found:?}, not {wanted:?}");
    }
}

/// The numbers are those of the drafts' own examples; albedos by their formula, which leaves the boundary out.
#[test]
fn volumes_scatter_as_the_drafts_say() {
    let volume = r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.9,0.9,0.9],"attenuationDistance":0.01},
        "KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1},"#;
    for key in ["multiscatterColor", "multiscatterColorFactor"] {
        let scatter = format!(
            r#""KHR_materials_volume_scatter":{{"{key}":[0.572,0.227,0.075],"scatterAnisotropy":0.3}}"#
        );
        let spec = material(&format!("{volume}{scatter}"));
        assert_colour(&spec, "transmission_scatter", [0.099_232_9, 0.069_414_6, 0.032_328_7]);
        assert_colour(&spec, "transmission_color", [0.9; 3]);
        let near = |key, wanted: f64| assert!((number(&spec, key) - wanted).abs() < 1e-6, "{key}");
        near("transmission_depth", 0.01);
        near("transmission_scatter_anisotropy", 0.3);
        near("diffuse_transmission_weight", 1.0);
        assert!(spec.parameters.find("visible_sides").is_none());
    }
    let spec = material(
        r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.95,0.85,0.75],"attenuationDistance":0.01},
        "KHR_materials_transmission":{"transmissionFactor":1},
        "KHR_materials_scatter":{"scatterStrengthFactor":0.5,"multiscatterColorFactor":[0.8,0.6,0.5],"scatterAnisotropy":0.2}"#,
    );
    assert_colour(&spec, "transmission_scatter", [0.044_982_5, 0.129_387, 0.212_516_5]);
}

/// Of a texture of the colour the mean counts inside; a thin wall has the texture.
#[test]
fn textures_of_the_colour_count() {
    let textured = |scatter: &str| {
        let colour = r#""multiscatterColorFactor":[1,0.5,1],"multiscatterColorTexture":{"index":0}"#;
        let material = format!(r#"{{"extensions":{{{scatter}{colour}}}}}}}"#);
        let more = one_picture(2, &[[255, 0, 0], [0, 255, 0], [255, 255, 0], [0, 0, 0]], "");
        read(&Square::of(&material, &more).text())
    };
    let volume = r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.9,0.9,0.9],"attenuationDistance":0.01},
        "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume_scatter":{"#;
    let scene = textured(volume);
    // The formula of the draft at .5, .25 and 0, by hand.
    let spec = &scene.materials[scene.objects[0].material];
    assert_colour(spec, "transmission_scatter", [0.096_058_1, 0.073_059_7, 0.0]);
    let said = crate::warnings(&scene);
    assert!(said.contains("of a texture of its colour, the mean counts"), "{said}");
    assert!(!said.contains("no property") && !said.contains("nothing in the file uses"), "{said}");
    let scene = textured(
        r#""KHR_materials_transmission":{"transmissionFactor":0.8},"KHR_materials_scatter":{"scatterStrengthFactor":0.5,"#,
    );
    let spec = &scene.materials[scene.objects[0].material];
    let Some((Value::Texture(index), _)) = spec.parameters.find("subsurface_color") else {
        panic!("{spec:?}")
    };
    assert!((scene.textures[*index].texel(1, 0).g - 0.5).abs() < 1e-6);
}

/// A thin wall scatters a part of what it transmits to both sides.
#[test]
fn thin_walls_scatter_a_part() {
    let spec = material(
        r#""KHR_materials_transmission":{"transmissionFactor":0.8},
        "KHR_materials_scatter":{"scatterStrengthFactor":0.5,"multiscatterColorFactor":[0.8,0.9,0.7],"scatterAnisotropy":0.3}"#,
    );
    let near = |key, wanted: f64| assert!((number(&spec, key) - wanted).abs() < 1e-6, "{key}");
    near("transmission_weight", 0.4);
    near("subsurface_weight", 0.4 / 0.6);
    near("subsurface_scatter_anisotropy", 0.3);
    assert_colour(&spec, "subsurface_color", [0.8, 0.9, 0.7]);
    assert!(matches!(spec.parameters.find("thin_walled"), Some((Value::Bool(true), _))));
}

/// Without a strength, as by default, nothing scatters; nor does it without a volume.
#[test]
fn no_strength_is_no_scattering() {
    let clear = material(
        r#""KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_scatter":{"multiscatterColorFactor":[1,1,1]}"#,
    );
    let alone = material(r#""KHR_materials_volume_scatter":{"multiscatterColor":[1,1,1]}"#);
    for spec in [clear, alone] {
        for key in ["subsurface_weight", "transmission_scatter"] {
            assert!(spec.parameters.find(key).is_none(), "{key}");
        }
    }
}

/// Fog would be an opaque box: files that cannot hold it have none, and say so.
#[test]
fn fog_is_left_out_where_it_has_no_place() {
    let mut scene = SceneBuilder::default();
    let mesh = Mesh {
        positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Into::into).to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let mesh = Arc::new(mesh);
    for (name, spec) in [
        ("fog", Spec::new("", "interface").with("scattering", 1.0f32)),
        ("wall", Spec::new("", "diffuse").with("reflectance", Rgb::grey(0.5))),
    ] {
        let material = scene.add_material(spec);
        scene.objects.push(Object::new(name, mesh.clone(), material));
    }
    let folder = tempfile::tempdir().unwrap();
    for (extension, objects) in [("gltf", 1), ("obj", 1), ("stl", 1), ("pbrt", 2), ("toml", 2)] {
        let path = folder.path().join(format!("m.{extension}"));
        let warnings = write(&path, &scene, &WriteOptions::default()).unwrap();
        let said = warnings.iter().filter(|warning| warning.message.contains("'fog' is left out")).count();
        assert_eq!(said, 2 - objects, "{extension}: {warnings:?}");
        let back = bilux_formats::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(back.objects.len(), objects, "{extension}");
    }
}

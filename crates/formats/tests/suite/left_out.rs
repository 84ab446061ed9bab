//! Nothing is lost silently: everything about a material or a light that a written file does not show gives a
//! warning.

use bilux_formats::{WriteOptions, write};
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Transform, Vec3};
use bilux_scene::media::Grid;
use bilux_scene::{LIGHTS, MATERIALS, Mesh, Object, SceneBuilder, Spec, Texture, Value};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Layers that must be present for their parameters to have an effect.
const BEFORE: [(&str, &[(&str, f64)]); 4] = [
    ("conductor", &[("anisotropy", 0.5)]),
    ("dielectric", &[("roughness", 0.4), ("anisotropy", 0.5)]),
    (
        "principled",
        &[
            ("base_metalness", 0.5),
            ("transmission_weight", 0.5),
            ("transmission_color", 0.5),
            ("transmission_depth", 2.0),
            ("transmission_dispersion_scale", 0.5),
            ("coat_weight", 0.75),
            ("fuzz_weight", 0.5),
            ("thin_film_weight", 0.5),
            ("specular_roughness_anisotropy", 0.5),
        ],
    ),
    ("phong", &[("kt", 0.375)]),
];

/// A parameter that another one needs to have an effect, with a value for it.
fn beside(key: &str) -> Option<(&'static str, Value)> {
    Some(match key {
        "normal_scale" => ("normal", Value::Texture(0)),
        "coat_normal_scale" => ("coat_normal", Value::Texture(0)),
        "emission_scale" => ("emission", Value::Texture(0)),
        "emission_sides" => ("emission", Value::Number(2.0)),
        "rotation" => ("radiance", Value::Texture(0)),
        "density" => ("scattering", Value::Number(2.0)),
        "edge" => ("reflectance", Value::Number(0.5)),
        "scattering_anisotropy" => ("scattering", Value::Number(2.0)),
        "k" => ("eta", Value::Number(2.0)),
        "eta" => ("k", Value::Number(2.0)),
        "diffuse_transmission_color" => ("diffuse_transmission_weight", Value::Number(0.5)),
        _ => return None,
    })
}

/// Parameters that apply only to the paper's own rendering modes, or that another parameter makes irrelevant.
fn is_irrelevant(key: &str) -> bool {
    ["ka", "gloss", "translucency", "classic"].contains(&key)
}

/// Values other than the default: a constant and, where allowed, a texture.
fn others(parameter: &Parameter) -> Vec<Value> {
    let within = |min: f64, max: f64| {
        let default: f64 = parameter.default.split(' ').next().unwrap().parse().unwrap();
        Value::Number(if default + 0.25 <= max { default + 0.25 } else { default - 0.25 }.max(min))
    };
    let shade = Value::from(Rgb::new(0.25, 0.5, 0.75));
    match parameter.kind {
        ParameterKind::Bool => vec![Value::Bool(parameter.default != "true")],
        ParameterKind::Integer { min, .. } => vec![Value::Integer(min + 1)],
        ParameterKind::Number { min, max } => vec![within(min, max)],
        ParameterKind::NumberTexture { min, max } => vec![within(min, max), Value::Texture(0)],
        ParameterKind::Colour { .. } => vec![shade],
        ParameterKind::ColourTexture { .. } => vec![shade, Value::Texture(0)],
        ParameterKind::Choice(words) => {
            words.iter().filter(|word| **word != parameter.default).map(|word| Value::from(*word)).collect()
        }
        ParameterKind::Texture => vec![Value::Texture(0)],
        ParameterKind::Grid => {
            let grid = Grid::dense("smoke", [2, 1, 1], &Transform::IDENTITY, &[0.0, 1.0]).unwrap();
            vec![Value::from(Arc::new(grid))]
        }
        ParameterKind::Vector => vec![Value::from(Vec3::new(3.0, 2.0, 1.0))],
        _ => Vec::new(),
    }
}

/// Adds a spec to a scene; returns the material of its triangle.
type AddSpec = fn(&mut SceneBuilder, Spec) -> usize;

/// All files of a scene with one triangle and this spec, by name, and the warnings.
fn written(spec: Spec, add: AddSpec, format: &str) -> (BTreeMap<String, Vec<u8>>, Vec<String>) {
    let mut scene = SceneBuilder::default();
    let texels = (1..5).map(|i| Rgb::new(0.2, 0.25, 0.2) * i as f32).collect();
    scene.textures.push(Arc::new(Texture::new("t", 2, 2, texels, true)));
    let material = add(&mut scene, spec);
    let mesh = Mesh {
        positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Into::into).to_vec(),
        uvs: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Into::into).to_vec(),
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    scene.objects.push(Object::new("m", Arc::new(mesh), material));
    let folder = tempfile::tempdir().unwrap();
    let reported =
        write(&folder.path().join(format!("m.{format}")), &scene, &WriteOptions::default()).unwrap();
    let read = |path: &Path| std::fs::read(path).unwrap();
    let files = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap());
    let files = files.map(|entry| (entry.file_name().to_string_lossy().into_owned(), read(&entry.path())));
    (files.collect(), reported.into_iter().map(|warning| warning.message).collect())
}

/// The parameters of a spec that a format drops without a warning.
fn lost(entry: &Entry, add: AddSpec, format: &str) -> Vec<String> {
    let before = BEFORE.iter().find(|(kind, _)| *kind == entry.name).map_or(&[][..], |(_, keys)| keys);
    let base = before
        .iter()
        .fold(Spec::new("m", entry.name), |spec, (key, value)| spec.with(key, Value::Number(*value)));
    let said = entry.parameters.iter().filter(|parameter| !is_irrelevant(parameter.name));
    let said = said.flat_map(|parameter| others(parameter).into_iter().map(move |value| (parameter, value)));
    let lost = said.filter(|(parameter, value)| {
        let has = |key: &str| entry.parameters.iter().any(|parameter| parameter.name == key);
        let beside = beside(parameter.name).filter(|(key, _)| has(key));
        let base = beside.into_iter().fold(base.clone(), |spec, (key, value)| spec.with(key, value));
        let (plain, reported_of_plain) = written(base.clone(), add, format);
        let (changed, reported) = written(base.with(parameter.name, value.clone()), add, format);
        // If the parameter or its whole layer is left out in any case, no further warning is needed.
        let layer = |message: &String| {
            let of = message.split('\'').nth(1).unwrap_or_default();
            let stem = of.strip_suffix("weight").or(of.strip_suffix("scale"));
            let is_fog = entry.name == "interface" && message.contains("fog and smoke");
            // Gloss has other names where materials are converted.
            let is_gloss =
                of.starts_with("specular_") && ["ks", "exponent", "roughness"].contains(&parameter.name);
            is_fog
                || is_gloss
                || [parameter.name, entry.name].contains(&of)
                || stem.is_some_and(|stem| !stem.is_empty() && parameter.name.starts_with(stem))
        };
        plain == changed && reported == reported_of_plain && !reported.iter().any(layer)
    });
    lost.map(|(parameter, value)| format!("{} = {value:?}", parameter.name)).collect()
}

fn assert_warned<'e>(rows: impl Iterator<Item = &'e Entry> + Clone, add: AddSpec, formats: &[&str]) {
    for format in formats {
        let lost = rows.clone().map(|entry| (entry.name, lost(entry, add, format)));
        let lost: Vec<_> = lost.filter(|(_, keys)| !keys.is_empty()).collect();
        assert!(lost.is_empty(), "in {format}: {lost:?}");
    }
}

#[test]
fn unsupported_material_parameters_give_warnings() {
    let rows = MATERIALS.iter().map(|row| &row.entry).filter(|entry| entry.name != "mix");
    assert_warned(rows, SceneBuilder::add_material, &["toml", "glb", "pbrt", "obj", "usda", "xml", "3mf"]);
}

#[test]
fn unsupported_light_parameters_give_warnings() {
    let add: AddSpec = |scene, light| {
        scene.lights.push(light);
        scene.add_material(Spec::new("m", "diffuse"))
    };
    assert_warned(LIGHTS.iter().map(|row| &row.entry), add, &["toml", "glb", "pbrt", "usda", "xml"]);
}

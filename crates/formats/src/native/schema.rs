//! A JSON schema of scene files, for editors, generated from the tables that the reader uses.

use super::displaced::DISPLACEMENT;
use super::pictures::PICTURE;
use super::place::KEYFRAME_KEYS;
use super::shapes::SHAPES;
use super::specs::CHANNELS;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::change::Part;
use bilux_scene::generators::GENERATORS;
use bilux_scene::media::DENSITIES;
use bilux_scene::{CAMERAS, LIGHTS, MATERIALS, TEXTURES, Visibility};
use serde_json::{Map, Value, json};

/// The JSON schema (draft 2020-12) of native scene files. `settings` are the keys of `[render]`.
pub fn toml_schema(settings: &[Parameter]) -> Value {
    let rows = |entries: Vec<&Entry>, extra: &[(&str, Value)], kind_default: Option<&str>| {
        one_of(entries, "kind", extra, kind_default)
    };
    let name = ("name", described("string", "its name"));
    let materials = rows(MATERIALS.iter().map(|r| &r.entry).collect(), std::slice::from_ref(&name), None);
    let lights = rows(LIGHTS.iter().map(|r| &r.entry).collect(), std::slice::from_ref(&name), None);
    let cameras: Vec<&Entry> = CAMERAS.iter().map(|r| &r.entry).collect();
    let keyframes = ("keyframes", camera_keyframes(&cameras));
    let camera = rows(cameras, &[name, keyframes], Some("perspective"));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Bilux scene",
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "include": {
                "description": "scene files of any format, relative to this one, to include",
                "type": "array",
                "items": { "type": "string" },
            },
            "base": described("string", "the scene file, relative to this one, that [render] and [[change]] change"),
            "render": {
                "description": "the render settings",
                "type": "object",
                "additionalProperties": settings.is_empty(),
                "properties": properties(settings),
            },
            "camera": { "oneOf": [camera.clone(), list(camera)] },
            "light": list(lights),
            "material": list(materials),
            "model": list(model()),
            "replace": list(replacement()),
            "change": list(changed()),
        },
        "$defs": {
            "formula": rows(TEXTURES.iter().map(|r| &r.entry).collect(), &[], None),
            "displacement": displacement(),
            "density": rows(DENSITIES.iter().map(|r| &r.entry).collect(), &[("place", place_of_voxels())], None),
        },
    })
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn described(kind: &str, description: &str) -> Value {
    json!({ "type": kind, "description": description })
}

/// A table that matches one of the rows, distinguished by a key.
fn one_of(rows: Vec<&Entry>, key: &str, extra: &[(&str, Value)], default: Option<&str>) -> Value {
    let table = |entry: &Entry| {
        let mut all = properties(entry.parameters);
        all.extend(extra.iter().map(|(key, value)| ((*key).to_owned(), value.clone())));
        all.insert(key.to_owned(), json!({ "const": entry.name }));
        let needed = entry.parameters.iter().filter(|p| p.default.is_empty()).map(|p| p.name);
        let kind = (default != Some(entry.name)).then_some(key);
        json!({
            "description": entry.summary,
            "type": "object",
            "additionalProperties": false,
            "properties": all,
            "required": needed.chain(kind).collect::<Vec<_>>(),
        })
    };
    json!({ "oneOf": rows.into_iter().map(table).collect::<Vec<_>>() })
}

fn properties(parameters: &[Parameter]) -> Map<String, Value> {
    parameters.iter().map(|p| (p.name.to_owned(), property(p))).collect()
}

fn property(parameter: &Parameter) -> Value {
    let mut schema = values(parameter.kind);
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", in {}", parameter.unit) };
    schema["description"] = format!("{}{unit}", parameter.summary).into();
    if let Some(default) = default_value(parameter) {
        schema["default"] = default;
    }
    schema
}

fn values(kind: ParameterKind) -> Value {
    let colour = |min: f64, max: f64| {
        let channel = json!({ "type": "number", "minimum": min, "maximum": max });
        let mut all =
            vec![json!({ "type": "array", "items": channel, "minItems": 3, "maxItems": 3 }), channel];
        // No light is limited to 1.
        if max > 1.0 {
            all.push(described("string", "a quantity of light, such as 800 lm 2700 K"));
        }
        all
    };
    match kind {
        ParameterKind::Bool => json!({ "type": "boolean" }),
        ParameterKind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        ParameterKind::Number { min, max } => json!({ "type": "number", "minimum": min, "maximum": max }),
        ParameterKind::Colour { min, max } => json!({ "oneOf": colour(min, max) }),
        ParameterKind::ColourTexture { min, max } => {
            let textures = [texture(&[]), formula()];
            json!({ "oneOf": colour(min, max).into_iter().chain(textures).collect::<Vec<_>>() })
        }
        ParameterKind::NumberTexture { min, max } => {
            let number = json!({ "type": "number", "minimum": min, "maximum": max });
            let channel = json!({ "enum": CHANNELS, "description": "the channel that is read" });
            json!({ "oneOf": [number, texture(&[("channel", channel)]), formula()] })
        }
        ParameterKind::Texture => json!({ "oneOf": [texture(&[]), formula()] }),
        ParameterKind::Grid => grid(),
        ParameterKind::Distribution => described("string", "a file of a lamp, relative to this file"),
        ParameterKind::Stops { min, max } => {
            let stop = json!([{ "type": "number" }, { "oneOf": colour(min, max) }]);
            let stop = json!({ "type": "array", "prefixItems": stop, "minItems": 2, "maxItems": 2 });
            json!({ "type": "array", "items": stop, "minItems": 1 })
        }
        ParameterKind::Vector => vector(),
        ParameterKind::Choice(words) => json!({ "enum": words }),
        ParameterKind::Text | ParameterKind::Material => json!({ "type": "string" }),
    }
}

/// A procedural texture, which may contain others.
fn formula() -> Value {
    json!({ "$ref": "#/$defs/formula" })
}

/// An image in place of a value.
fn texture(extra: &[(&str, Value)]) -> Value {
    let mut all: Map<String, Value> =
        extra.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    all.extend(properties(PICTURE.parameters));
    all.insert("texture".to_owned(), described("string", "a picture, relative to this file"));
    all.insert("layer".to_owned(), described("string", "a layer of an EXR, in place of its main picture"));
    json!({ "type": "object", "additionalProperties": false, "properties": all, "required": ["texture"] })
}

/// Numbers in space, from a file or by a formula.
fn grid() -> Value {
    let properties = json!({
        "grid": described("string", "a file of grids, relative to this file"),
        "name": described("string", "the grid of that file"),
        "place": place_of_voxels(),
    });
    let file = json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": ["grid"] });
    json!({ "oneOf": [file, { "$ref": "#/$defs/density" }] })
}

fn place_of_voxels() -> Value {
    json!({
        "type": "array", "items": { "type": "number" }, "minItems": 12, "maxItems": 12,
        "description": "where it is in the object: the steps of a voxel along x, y and z, and the corner of the first one",
    })
}

fn vector() -> Value {
    let numbers = json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 });
    json!({ "oneOf": [numbers, { "type": "number" }] })
}

/// A default value as JSON; the tables state it as text.
fn default_value(parameter: &Parameter) -> Option<Value> {
    let text = parameter.default;
    let numbers: Vec<Value> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    Some(match parameter.kind {
        _ if text.is_empty() => return None,
        ParameterKind::Texture | ParameterKind::Grid | ParameterKind::Distribution => return None,
        ParameterKind::Bool => json!(text == "true"),
        ParameterKind::Choice(_) | ParameterKind::Text | ParameterKind::Material => json!(text),
        _ => match <[Value; 1]>::try_from(numbers) {
            Ok([one]) => one,
            Err(several) => json!(several),
        },
    })
}

fn camera_keyframes(cameras: &[&Entry]) -> Value {
    let mut all: Map<String, Value> = cameras.iter().flat_map(|entry| properties(entry.parameters)).collect();
    all.insert("time".to_owned(), described("number", "the time in seconds"));
    let mut schema = list(
        json!({ "type": "object", "additionalProperties": false, "properties": all, "required": ["time"] }),
    );
    schema["description"] = "keyframes in order of time, each with the parameters that change".into();
    schema
}

/// `[[model]]`: a file, a shape or a generator.
fn model() -> Value {
    let place = place();
    let common = common_of_models();
    let with_common = |entries: Vec<&Entry>, key: &str| {
        let extra: Vec<(&str, Value)> =
            common.iter().chain(&place).map(|(key, value)| (*key, value.clone())).collect();
        one_of(entries, key, &extra, None)["oneOf"].clone()
    };
    let file = Entry { name: "", summary: "meshes from a file", source: "", parameters: &[] };
    let mut tables = with_common(vec![&file], "file");
    tables[0]["properties"]["file"] = described("string", "a scene file, relative to this one");
    let shapes = with_common(SHAPES.iter().map(|row| &row.entry).collect(), "shape");
    let generators = with_common(GENERATORS.iter().map(|row| &row.entry).collect(), "generate");
    let all = [tables, shapes, generators].into_iter().filter_map(|rows| rows.as_array().cloned()).flatten();
    json!({ "oneOf": all.collect::<Vec<_>>() })
}

fn common_of_models() -> Vec<(&'static str, Value)> {
    let words = json!({ "type": "array", "items": { "enum": ["lights", "cameras"] } });
    let renamed = json!({ "type": "object", "additionalProperties": { "type": "string" } });
    vec![
        ("name", described("string", "its name")),
        ("material", described("string", "the name of the material for the whole model")),
        ("materials", renamed),
        ("instance", described("boolean", "keep one copy of each mesh, however many instances there are")),
        ("category", described("string", "what kind of thing it is, for labels, such as chair")),
        (
            "visibility",
            json!({
                "enum": Visibility::ALL.map(Visibility::name),
                "description": "which rays see it: all, all but those of the camera, or none",
            }),
        ),
        ("displacement", json!({ "$ref": "#/$defs/displacement" })),
        ("with", words),
    ]
}

fn displacement() -> Value {
    json!({
        "type": "object",
        "description": DISPLACEMENT.summary,
        "additionalProperties": false,
        "properties": properties(DISPLACEMENT.parameters),
        "required": ["map"],
    })
}

/// `[[replace]]`: replaces materials of models.
fn replacement() -> Value {
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "material": described("string", "the name of the material that is replaced; * is any text, ? any character"),
            "object": described("string", "the name of the objects whose material is replaced; * is any text, ? any character"),
            "with": described("string", "the name of the replacement material"),
        },
        "required": ["with"],
        "anyOf": [{ "required": ["material"] }, { "required": ["object"] }],
    })
}

/// `[[change]]`: changes parameters of a material, a light or a camera.
fn changed() -> Value {
    let parts = Part::ALL.map(Part::name);
    let which = |part: &str| {
        let description = format!("the name of the {part} that is changed, or its number from 0");
        (part.to_owned(), json!({ "type": ["string", "integer"], "minimum": 0, "description": description }))
    };
    json!({
        "description": "parameters of a material, a light or a camera to change",
        "type": "object",
        "properties": parts.map(which).into_iter().collect::<Map<_, _>>(),
        "oneOf": parts.map(|part| json!({ "required": [part] })),
    })
}

fn place() -> Vec<(&'static str, Value)> {
    let axis = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "axis": vector(),
            "degrees": { "type": "number" },
            "quaternion": { "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 },
        },
    });
    let rotate = json!({ "oneOf": [vector(), axis], "description": "degrees about x, then y, then z; or about an axis" });
    let pose = [
        ("time", described("number", "the time in seconds")),
        ("translate", vector()),
        ("rotate", rotate),
        ("scale", vector()),
    ];
    debug_assert!(pose.iter().map(|(key, _)| *key).eq(KEYFRAME_KEYS));
    let frame: Map<String, Value> =
        pose.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    let frames = list(json!({
        "type": "object", "additionalProperties": false, "properties": frame, "required": ["time"],
    }));
    let matrix = described("array", "four rows of four numbers, the last of them [0, 0, 0, 1]");
    pose.into_iter().skip(1).chain([("matrix", matrix), ("keyframes", frames)]).collect()
}

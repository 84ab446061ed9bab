//! A JSON schema of scene files, for editors, generated from the tables that the reader uses.

use super::definitions::{Definitions, reference};
use super::displaced::DISPLACEMENT;
use super::pictures::PICTURE;
use super::place::KEYFRAME_KEYS;
use super::shapes::SHAPES;
use super::specs::CHANNELS;
use bilux_gallery::GENERATORS;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::change::Part;
use bilux_scene::media::DENSITIES;
use bilux_scene::{CAMERAS, LIGHTS, MATERIALS, TEXTURES, Visibility};
use serde_json::{Map, Value, json};

/// The JSON schema (draft 2020-12) of native scene files. `settings` are the keys of `[render]`.
pub fn toml_schema(settings: &[Parameter]) -> Value {
    let mut parts = Definitions::default();
    let tables = tables_of_files(settings, &mut parts);
    let formulas = TEXTURES.iter().map(|r| &r.entry).collect();
    let formulas = variants("formula", formulas, &[], &mut parts);
    parts.part("formula", formulas);
    let displacement = displacement(&mut parts);
    parts.part("displacement", displacement);
    let voxels = [("place", place_of_voxels(&mut parts))];
    let densities = variants("density", DENSITIES.iter().map(|r| &r.entry).collect(), &voxels, &mut parts);
    parts.part("density", densities);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Bilux scene",
        "type": "object",
        "additionalProperties": false,
        "properties": tables,
        "$defs": parts.finish(),
    })
}

fn tables_of_files(settings: &[Parameter], parts: &mut Definitions) -> Value {
    let name = [("name", described("string", "its name"))];
    let camera = camera(&name, parts);
    let camera = parts.part("camera", camera);
    json!({
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
            "properties": properties(settings, parts),
        },
        "camera": { "oneOf": [camera, list(camera.clone())] },
        "light": list(variants("light", LIGHTS.iter().map(|r| &r.entry).collect(), &name, parts)),
        "material": list(variants("material", MATERIALS.iter().map(|r| &r.entry).collect(), &name, parts)),
        "model": list(model(parts)),
        "replace": list(replacement()),
        "change": list(changed()),
    })
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn described(kind: &str, description: &str) -> Value {
    json!({ "type": kind, "description": description })
}

/// A table that matches one of the rows, distinguished by `kind`. `of` names what the rows share.
fn variants(of: &str, rows: Vec<&Entry>, extra: &[(&str, Value)], parts: &mut Definitions) -> Value {
    let mut all = tables(rows, "kind", extra, None, parts);
    parts.share(of, &mut all);
    json!({ "oneOf": all })
}

/// A table for each of the rows, distinguished by a key.
fn tables(
    rows: Vec<&Entry>,
    key: &str,
    extra: &[(&str, Value)],
    default: Option<&str>,
    parts: &mut Definitions,
) -> Vec<Value> {
    let table = |entry: &Entry| {
        let mut all = properties(entry.parameters, parts);
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
    rows.into_iter().map(table).collect()
}

fn properties(parameters: &[Parameter], parts: &mut Definitions) -> Map<String, Value> {
    parameters.iter().map(|p| (p.name.to_owned(), property(p, parts))).collect()
}

fn property(parameter: &Parameter, parts: &mut Definitions) -> Value {
    let mut schema = values(parameter.kind, parts);
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", in {}", parameter.unit) };
    schema["description"] = format!("{}{unit}", parameter.summary).into();
    if let Some(default) = default_value(parameter) {
        schema["default"] = default;
    }
    schema
}

/// The values of a kind, never as a lone reference: their description is beside them.
fn values(kind: ParameterKind, parts: &mut Definitions) -> Value {
    match kind {
        ParameterKind::Bool => json!({ "type": "boolean" }),
        ParameterKind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        ParameterKind::Number { min, max } => json!({ "type": "number", "minimum": min, "maximum": max }),
        ParameterKind::Colour { min, max } => json!({ "oneOf": colour(min, max, parts) }),
        ParameterKind::ColourTexture { min, max } => {
            let textures = [texture(parts), reference("formula")];
            json!({ "oneOf": colour(min, max, parts).into_iter().chain(textures).collect::<Vec<_>>() })
        }
        ParameterKind::NumberTexture { min, max } => {
            json!({ "oneOf": [parts.number(min, max), channel_texture(parts), reference("formula")] })
        }
        ParameterKind::Texture => json!({ "oneOf": [texture(parts), reference("formula")] }),
        ParameterKind::Grid => grid(parts),
        ParameterKind::Distribution => described("string", "a file of a lamp, relative to this file"),
        ParameterKind::Stops { min, max } => {
            let stop = json!([{ "type": "number" }, { "oneOf": colour(min, max, parts) }]);
            let stop = json!({ "type": "array", "prefixItems": stop, "minItems": 2, "maxItems": 2 });
            json!({ "type": "array", "items": stop, "minItems": 1 })
        }
        ParameterKind::Vector => three_or_one(parts),
        ParameterKind::Choice(words) => json!({ "enum": words }),
        ParameterKind::Text | ParameterKind::Material => json!({ "type": "string" }),
    }
}

/// The ways to write a colour without a texture.
fn colour(min: f64, max: f64, parts: &mut Definitions) -> Vec<Value> {
    let mut all = vec![parts.colour(min, max), parts.number(min, max)];
    // No light is limited to 1.
    all.push(if max > 1.0 {
        let quantity = described("string", "a quantity of light, such as 800 lm 2700 K");
        parts.part("light-quantity", quantity)
    } else {
        let mut shown = described("string", "a colour as a screen shows it, #rrggbb");
        shown["pattern"] = "^#[0-9a-fA-F]{6}$".into();
        parts.part("screen-colour", shown)
    });
    all
}

/// An image in place of a colour.
fn texture(parts: &mut Definitions) -> Value {
    let picture = picture(&[], parts);
    parts.part("texture", picture)
}

/// An image in place of a number, of which one channel is read.
fn channel_texture(parts: &mut Definitions) -> Value {
    let channel = json!({ "enum": CHANNELS, "description": "the channel that is read" });
    let picture = picture(&[("channel", channel)], parts);
    parts.part("channel-texture", picture)
}

fn picture(extra: &[(&str, Value)], parts: &mut Definitions) -> Value {
    let mut all: Map<String, Value> =
        extra.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    all.extend(properties(PICTURE.parameters, parts));
    all.insert("texture".to_owned(), described("string", "a picture, relative to this file"));
    all.insert("layer".to_owned(), described("string", "a layer of an EXR, in place of its main picture"));
    json!({ "type": "object", "additionalProperties": false, "properties": all, "required": ["texture"] })
}

/// Numbers in space, from a file or by a formula.
fn grid(parts: &mut Definitions) -> Value {
    let properties = json!({
        "grid": described("string", "a file of grids, relative to this file"),
        "name": described("string", "the grid of that file"),
        "place": place_of_voxels(parts),
    });
    let file = json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": ["grid"] });
    json!({ "oneOf": [parts.part("grid-file", file), reference("density")] })
}

fn place_of_voxels(parts: &mut Definitions) -> Value {
    let place = json!({
        "type": "array", "items": { "type": "number" }, "minItems": 12, "maxItems": 12,
        "description": "where it is in the object: the steps of a voxel along x, y and z, and the corner of the first one",
    });
    parts.part("place-of-voxels", place)
}

/// A vector without a description of its own.
fn vector(parts: &mut Definitions) -> Value {
    let vector = three_or_one(parts);
    parts.part("vector", vector)
}

fn three_or_one(parts: &mut Definitions) -> Value {
    let three = json!({ "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 });
    json!({ "oneOf": [parts.part("three-numbers", three), { "type": "number" }] })
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

/// `[camera]`: one of the cameras, whose keyframes have the parameters of all of them.
fn camera(name: &[(&str, Value); 1], parts: &mut Definitions) -> Value {
    let cameras: Vec<&Entry> = CAMERAS.iter().map(|r| &r.entry).collect();
    let mut frame: Map<String, Value> =
        cameras.iter().flat_map(|entry| properties(entry.parameters, parts)).collect();
    frame.insert("time".to_owned(), described("number", "the time in seconds"));
    let extra = [name[0].clone(), ("keyframes", reference("camera-keyframes"))];
    let mut all = tables(cameras, "kind", &extra, Some("perspective"), parts);
    all.push(
        json!({ "type": "object", "additionalProperties": false, "properties": frame, "required": ["time"] }),
    );
    parts.share("camera", &mut all);
    let mut keyframes = list(all.pop().unwrap_or_default());
    keyframes["description"] = "keyframes in order of time, each with the parameters that change".into();
    parts.part("camera-keyframes", keyframes);
    json!({ "oneOf": all })
}

/// `[[model]]`: a file, a shape or a generator.
fn model(parts: &mut Definitions) -> Value {
    let mut common = common_of_models();
    common.extend(place(parts));
    let file = Entry { name: "", summary: "meshes from a file", source: "", parameters: &[] };
    let mut all = tables(vec![&file], "file", &common, None, parts);
    all[0]["properties"]["file"] = described("string", "a scene file, relative to this one");
    let shapes = SHAPES.iter().map(|row| &row.entry).collect();
    all.extend(tables(shapes, "shape", &common, None, parts));
    let generators = GENERATORS.iter().map(|row| &row.entry).collect();
    all.extend(tables(generators, "generate", &common, None, parts));
    parts.share("model", &mut all);
    json!({ "oneOf": all })
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
        ("displacement", reference("displacement")),
        ("with", words),
    ]
}

fn displacement(parts: &mut Definitions) -> Value {
    json!({
        "type": "object",
        "description": DISPLACEMENT.summary,
        "additionalProperties": false,
        "properties": properties(DISPLACEMENT.parameters, parts),
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

fn place(parts: &mut Definitions) -> Vec<(&'static str, Value)> {
    let axis = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "axis": vector(parts),
            "degrees": { "type": "number" },
            "quaternion": { "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 },
        },
    });
    let rotate = json!({ "oneOf": [vector(parts), axis], "description": "degrees about x, then y, then z; or about an axis" });
    let pose = [
        ("time", described("number", "the time in seconds")),
        ("translate", vector(parts)),
        ("rotate", parts.part("rotation", rotate)),
        ("scale", vector(parts)),
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

//! The JSON schema of scene files: its parts, and what it accepts and refuses.

use crate::read_text;
use bilux_formats::{WriteOptions, toml_schema, write};
use bilux_gallery::{GENERATORS, generate};
use bilux_scene::Spec;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// True if a value satisfies a schema, by the keywords that ours has.
fn accepts(root: &Value, schema: &Value, value: &Value) -> bool {
    match schema {
        Value::Bool(all) => *all,
        _ => {
            let rules = schema.as_object().unwrap();
            rules.iter().all(|(rule, wanted)| holds(root, rules, rule, wanted, value))
        }
    }
}

fn holds(root: &Value, rules: &Map<String, Value>, rule: &str, wanted: &Value, value: &Value) -> bool {
    let satisfies = |schema: &Value| accepts(root, schema, value);
    let number = |is_right: fn(f64, f64) -> bool| {
        value.as_f64().is_none_or(|number| is_right(number, wanted.as_f64().unwrap()))
    };
    let length = value.as_array().map_or(0, Vec::len) as u64;
    let items = value.as_array().into_iter().flatten();
    match rule {
        "$schema" | "$defs" | "title" | "description" | "default" => true,
        "$ref" => satisfies(part(root, wanted.as_str().unwrap())),
        "oneOf" => wanted.as_array().unwrap().iter().filter(|schema| satisfies(schema)).count() == 1,
        "anyOf" => wanted.as_array().unwrap().iter().any(satisfies),
        "const" => value == wanted,
        "enum" => wanted.as_array().unwrap().contains(value),
        "type" if wanted.is_string() => is_of_type(wanted, value),
        "type" => wanted.as_array().unwrap().iter().any(|name| is_of_type(name, value)),
        "pattern" => {
            assert_eq!(wanted, "^#[0-9a-fA-F]{6}$");
            let is_colour = |text: &str| {
                text.strip_prefix('#').is_some_and(|digits| {
                    digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
                })
            };
            value.as_str().is_none_or(is_colour)
        }
        "minimum" => number(|number, least| number >= least),
        "maximum" => number(|number, most| number <= most),
        "minItems" => !value.is_array() || length >= wanted.as_u64().unwrap(),
        "maxItems" => !value.is_array() || length <= wanted.as_u64().unwrap(),
        "items" => items.into_iter().all(|item| accepts(root, wanted, item)),
        "prefixItems" => {
            items.zip(wanted.as_array().unwrap()).all(|(item, schema)| accepts(root, schema, item))
        }
        "required" => wanted
            .as_array()
            .unwrap()
            .iter()
            .all(|key| value.as_object().is_none_or(|table| table.contains_key(key.as_str().unwrap()))),
        "properties" => {
            entries(value).all(|(key, v)| wanted.get(key).is_none_or(|schema| accepts(root, schema, v)))
        }
        "additionalProperties" => {
            let known = rules.get("properties").and_then(Value::as_object);
            entries(value)
                .filter(|(key, _)| known.is_none_or(|known| !known.contains_key(*key)))
                .all(|(_, v)| accepts(root, wanted, v))
        }
        _ => panic!("what does {rule} mean?"),
    }
}

fn entries(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

fn is_of_type(name: &Value, value: &Value) -> bool {
    match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        other => panic!("what is the type {other}?"),
    }
}

/// The part of a schema to which a `$ref` refers.
fn part<'a>(root: &'a Value, reference: &str) -> &'a Value {
    let found = reference.strip_prefix('#').and_then(|path| root.pointer(path));
    found.unwrap_or_else(|| panic!("there is no {reference}"))
}

/// All `$ref` inside of a schema; each must stand alone, as editors ignore what is beside it.
fn references<'a>(schema: &'a Value, found: &mut BTreeSet<&'a str>) {
    match schema {
        Value::Object(map) => {
            if let Some(reference) = map.get("$ref") {
                assert_eq!(map.len(), 1, "{schema}");
                found.insert(reference.as_str().unwrap());
            }
            map.values().for_each(|value| references(value, found));
        }
        Value::Array(all) => all.iter().for_each(|value| references(value, found)),
        _ => {}
    }
}

fn is_accepted(schema: &Value, text: &str) -> bool {
    accepts(schema, schema, &toml::from_str(text).unwrap())
}

#[test]
fn each_reference_of_the_schema_has_its_part_and_each_part_is_used() {
    let schema = toml_schema(&[]);
    let mut used = BTreeSet::new();
    references(&schema, &mut used);
    assert!(used.iter().all(|reference| part(&schema, reference).is_object()));
    let parts: Vec<String> =
        schema["$defs"].as_object().unwrap().keys().map(|name| format!("#/$defs/{name}")).collect();
    assert!(parts.iter().map(String::as_str).eq(used), "{parts:?}");
}

#[test]
fn scenes_of_the_repository_and_generated_ones_satisfy_the_schema() {
    let schema = toml_schema(&[]);
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let mut files: Vec<_> = std::fs::read_dir(scenes).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    assert!(files.len() >= 9);
    let folder = tempfile::tempdir().unwrap();
    // Clouds and flames take seconds to make.
    for row in GENERATORS.iter().filter(|row| !["campfire", "cloud"].contains(&row.entry.name)) {
        let path = folder.path().join(format!("{}.toml", row.entry.name));
        write(&path, &generate(&Spec::new("", row.entry.name)).unwrap(), &WriteOptions::default()).unwrap();
        files.push(path);
    }
    for path in files {
        assert!(is_accepted(&schema, &std::fs::read_to_string(&path).unwrap()), "{}", path.display());
    }
}

/// A right scene, a part of it, and what makes it wrong in place of that part.
const BROKEN: &[(&str, &str, &str)] = &[
    ("[[model]]\nshape = 'box'", "model", "modle"),
    ("[[model]]\nshape = 'box'", "box", "bocks"),
    ("[[model]]\nshape = 'box'\nname = 'a'", "name", "nmae"),
    ("[[model]]\nshape = 'sphere'\nradius = 1", "1", "-1"),
    ("[[model]]\nshape = 'box'\ninstance = true", "true", "1"),
    ("[[model]]\nshape = 'box'\nvisibility = 'hidden'", "hidden", "some"),
    ("[[model]]\nshape = 'box'\nscale = [1, 2, 3]", ", 3", ""),
    ("[[model]]\nshape = 'box'\nrotate = { axis = [0, 1, 0], degrees = 9 }", "degrees", "turns"),
    ("[[model]]\nshape = 'box'\nkeyframes = [{ time = 0 }, { time = 1, scale = 2 }]", "time = 1, ", ""),
    ("[[model]]\nshape = 'box'\ndisplacement = { map = { kind = 'noise' } }", "map", "mop"),
    ("[[model]]\ngenerate = 'teapots'\ncount = 4\nwith = ['lights']", "4", "4.5"),
    ("[[model]]\ngenerate = 'teapots'\ncount = 4\nwith = ['lights']", "lights", "sounds"),
    ("[[camera]]\nfov = 40", "40", "400"),
    ("[camera]\nfov = 40", "40", "'wide'"),
    ("[camera]\nkind = 'orthographic'\nheight = 3", "height", "fov"),
    ("[camera]\nposition = [0, 1, 2]", ", 2", ", 2, 3"),
    ("[camera]\nkeyframes = [{ time = 1, fov = 30 }]", "fov", "fow"),
    ("[camera]\nkeyframes = [{ time = 1, fov = 30 }]", "time = 1, ", ""),
    ("[[light]]\nkind = 'point'\nintensity = '800 lm'", "'800 lm'", "-1"),
    ("[[light]]\nkind = 'point'\nposition = [0, 1, 2]", "kind = 'point'", ""),
    ("[[light]]\nkind = 'environment'\nradiance = { kind = 'checker', a = [1, 2, 3] }", "checker", "chess"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nreflectance = [0, 0.5, 1]", "1]", "2]"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nreflectance = 0.5", "0.5", "[0.5, 0.5]"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nreflectance = 0.5", "0.5", "'800 lm'"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nreflectance = '#ff8000'", "#ff8000", "#ff80"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nopacity = 0.5", "0.5", "[1, 1, 1]"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nopacity = 0.5", "0.5", "1.5"),
    ("[[material]]\nname = 'm'\nkind = 'diffuse'\nemission_scale = 2", "emission_scale", "emision_scale"),
    (
        "[[material]]\nname = 'm'\nkind = 'diffuse'\nopacity = { texture = 'a.png', channel = 'g' }",
        "'g'",
        "'q'",
    ),
    (
        "[[material]]\nname = 'm'\nkind = 'diffuse'\nnormal = { texture = 'a.png', wrap_u = 'clamp' }",
        "wrap_u",
        "wrap_w",
    ),
    (
        "[[material]]\nname = 'm'\nkind = 'diffuse'\nreflectance = { kind = 'ramp', stops = [[0, 0], [1, [1, 1, 1]]] }",
        "[0, 0]",
        "[0]",
    ),
    (
        "[[material]]\nname = 'm'\nkind = 'interface'\ndensity = { grid = 'a.vdb', name = 'smoke' }",
        "name = 's",
        "nmae = 's",
    ),
    (
        "[[material]]\nname = 'm'\nkind = 'interface'\ndensity = { kind = 'cloud', frequency = 2 }",
        "cloud",
        "clowd",
    ),
    ("[[replace]]\nmaterial = 'a'\nwith = 'b'", "with = 'b'", ""),
    ("[[replace]]\nmaterial = 'a'\nwith = 'b'", "material = 'a'", ""),
    ("base = 'a.toml'\n[[change]]\nlight = 0\nintensity = 2", "light = 0", ""),
    ("base = 'a.toml'\n[[change]]\nlight = 0\nintensity = 2", "light = 0", "light = 0\nmaterial = 'm'"),
];

#[test]
fn broken_scenes_do_not_satisfy_the_schema() {
    let schema = toml_schema(&[]);
    for (right, part, wrong) in BROKEN {
        assert!(is_accepted(&schema, right), "{right}");
        let text = right.replacen(part, wrong, 1);
        assert!(!is_accepted(&schema, &text), "{text}");
        assert!(read_text("toml", &text).is_err(), "the reader accepts {text}");
    }
}

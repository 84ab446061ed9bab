//! Writes MTL so that [`super::mtl`] reads the same material back.

use super::surface::NUMBERS;
use bilux_import::FormatError;
use bilux_import::bytes::float::{push_f32, push_f32s};
use bilux_import::input::reading::default_material;
use bilux_import::output::values::{MaterialSupport, as_principled, colour, number, texture};
use bilux_import::output::writing::{UnusedNames, Writing};
use bilux_math::Rgb;
use bilux_scene::materials::{self, with_indices};
use bilux_scene::{SceneBuilder, Spec, Value};

/// Writes all materials except the plain one to a library file; returns the name of each material.
pub(super) fn write_library(
    scene: &SceneBuilder,
    writing: &mut Writing,
) -> Result<Vec<Option<String>>, FormatError> {
    let plain = default_material();
    let mut unused = UnusedNames::default();
    let mut out = Vec::new();
    let mut names = Vec::new();
    for spec in &scene.materials {
        if (&spec.kind, &spec.parameters) == (&plain.kind, &plain.parameters) && spec.name == plain.name {
            names.push(None);
            continue;
        }
        let name = Some(one_line(&spec.name)).filter(|n| !n.is_empty());
        let name = unused.unused(name.as_deref().unwrap_or("material"));
        out.extend_from_slice(format!("newmtl {name}\n").as_bytes());
        names.push(Some(name));
        write_material(spec, scene, writing, &mut out)?;
        out.push(b'\n');
    }
    if !out.is_empty() {
        let library = writing.add("mtl", out);
        writing.main.extend_from_slice(format!("mtllib {library}\n").as_bytes());
    }
    Ok(names)
}

/// The parameters that MTL can store.
const HOLDS: MaterialSupport = MaterialSupport {
    format: "OBJ",
    of_kinds: &[
        (
            "principled",
            &[
                "base_color",
                "base_metalness",
                "specular_roughness",
                "specular_ior",
                "specular_roughness_anisotropy",
                "anisotropy_rotation",
                "fuzz_weight",
                "coat_weight",
                "coat_roughness",
                "transmission_weight",
                "transmission_color",
                "emission",
                "emission_scale",
            ],
        ),
        (
            "phong",
            &["kd", "ks", "kt", "exponent", "reflectivity", "eta", "emission", "emission_scale", "thin"],
        ),
        ("diffuse", &["reflectance", "emission", "emission_scale"]),
        ("mirror", &["reflectance", "emission", "emission_scale"]),
        ("conductor", &["metal", "eta", "k", "reflectance", "roughness"]),
        ("dielectric", &["eta", "tint"]),
    ],
    of_any: &["opacity", "normal", "normal_scale"],
    textured: Some(&[
        "roughness",
        "kd",
        "reflectance",
        "base_color",
        "ks",
        "emission",
        "opacity",
        "normal",
        "base_metalness",
        "specular_roughness",
        "fuzz_weight",
        "coat_weight",
        "coat_roughness",
    ]),
};

fn write_material(
    spec: &Spec,
    scene: &SceneBuilder,
    writing: &mut Writing,
    out: &mut Vec<u8>,
) -> Result<(), FormatError> {
    let spec = &*with_indices(spec);
    let is_known = HOLDS.of_kinds.iter().any(|(kind, _)| *kind == spec.kind);
    let principled = if is_known { None } else { as_principled(spec, "OBJ", writing) };
    let spec = principled.as_ref().unwrap_or(spec);
    if !is_known && principled.is_none() {
        writing.warn(format!(
            "OBJ files cannot store the material '{}': a diffuse one is written instead",
            spec.kind
        ));
    }
    HOLDS.warn_unsupported(spec, writing);
    let grey = |key: &str, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
    match spec.kind.as_str() {
        "phong" => write_phong(spec, out),
        "principled" => write_principled(spec, scene, writing, out)?,
        "conductor" => {
            let metal = materials::as_principled(spec);
            write_principled(metal.as_ref().unwrap_or(spec), scene, writing, out)?
        }
        "mirror" => {
            push_colour(out, "Kd", Rgb::BLACK);
            push_colour(out, "Ks", grey("reflectance", 0.95));
            out.extend_from_slice(b"illum 3\n");
        }
        "dielectric" => {
            push_number(out, "Ni", number(spec, "eta").unwrap_or(1.5));
            push_colour(out, "Tf", grey("tint", 1.0));
            out.extend_from_slice(b"illum 7\n");
        }
        _ => {
            push_colour(out, "Kd", grey("reflectance", 0.7));
            push_colour(out, "Ks", Rgb::BLACK);
            out.extend_from_slice(b"illum 1\n");
        }
    }
    // The colour is white where a texture is given.
    let scale = colour(spec, "emission_scale").unwrap_or(Rgb::WHITE);
    if let Some(emission) = colour(spec, "emission").map(|c| c * scale).filter(|c| !c.is_black()) {
        push_colour(out, "Ke", emission);
    }
    for (map, keys) in
        [("map_Kd", ["kd", "reflectance", "base_color"]), ("map_Ks", ["ks"; 3]), ("map_Ke", ["emission"; 3])]
    {
        let index = keys.into_iter().find_map(|key| texture(spec, key));
        push_map(out, map, index, scene, writing)?;
    }
    if let Some(opacity) = number(spec, "opacity").filter(|opacity| *opacity < 1.0) {
        push_number(out, "d", opacity);
    }
    push_map(out, "map_d", texture(spec, "opacity"), scene, writing)?;
    let lean = number(spec, "normal_scale").unwrap_or(1.0);
    push_map(out, &format!("norm -bm {lean}"), texture(spec, "normal"), scene, writing)
}

/// Writes a line with a texture, if there is one.
fn push_map(
    out: &mut Vec<u8>,
    word: &str,
    index: Option<usize>,
    scene: &SceneBuilder,
    writing: &mut Writing,
) -> Result<(), FormatError> {
    let Some(index) = index else { return Ok(()) };
    let Some(file) = writing.texture(scene, index)? else { return Ok(()) };
    let parts = scene.textures.get(index).and_then(|texture| texture.transform).map(|lies| lies.parts());
    let mut options = String::new();
    if let Some(([u, v], turn, [x, y])) = parts {
        if turn != 0.0 {
            writing.warn("OBJ files cannot store rotated textures: they are written without rotation");
        }
        options = format!("-o {u} {} -s {x} {y} ", 1.0 - y - v);
    }
    out.extend_from_slice(format!("{word} {options}{file}\n").as_bytes());
    Ok(())
}

/// Writes `principled` with the keywords of the PBR extension.
fn write_principled(
    spec: &Spec,
    scene: &SceneBuilder,
    writing: &mut Writing,
    out: &mut Vec<u8>,
) -> Result<(), FormatError> {
    push_colour(out, "Kd", colour(spec, "base_color").unwrap_or(Rgb::grey(0.8)));
    push_number(out, "Pr", number(spec, "specular_roughness").unwrap_or(0.3));
    for (word, map, key) in NUMBERS {
        if let Some(number) = number(spec, key).filter(|_| word != "Pr") {
            push_number(out, word, number);
        }
        push_map(out, map, texture(spec, key), scene, writing)?;
    }
    push_number(out, "Ni", number(spec, "specular_ior").unwrap_or(1.5));
    if let Some(aniso) = number(spec, "specular_roughness_anisotropy") {
        push_number(out, "aniso", aniso);
        push_number(out, "anisor", number(spec, "anisotropy_rotation").unwrap_or(0.0));
    }
    match number(spec, "transmission_weight").filter(|weight| *weight > 0.0) {
        Some(weight) => {
            if weight < 1.0 {
                writing
                    .warn("OBJ files cannot store fractions of 'transmission_weight': partly transmissive materials \
                           are written as fully transmissive");
            }
            push_colour(out, "Tf", colour(spec, "transmission_color").unwrap_or(Rgb::WHITE));
            out.extend_from_slice(b"illum 7\n");
        }
        None => out.extend_from_slice(b"illum 2\n"),
    }
    Ok(())
}

fn write_phong(spec: &Spec, out: &mut Vec<u8>) {
    let grey = |key: &str, default: f32| colour(spec, key).unwrap_or(Rgb::grey(default));
    let kt = grey("kt", 0.0);
    let is_thin = spec.parameters.find("thin").is_some_and(|(v, _)| *v == Value::Bool(true));
    push_colour(out, "Kd", grey("kd", 0.7));
    if !kt.is_black() {
        push_colour(out, "Kt", kt);
    }
    push_colour(out, "Ks", grey("ks", 0.3));
    if let Some(exponent) = number(spec, "exponent") {
        push_number(out, "Ns", exponent);
    }
    if let Some(eta) = number(spec, "eta") {
        push_number(out, "Ni", eta);
    }
    let reflectivity = number(spec, "reflectivity").unwrap_or(1.0);
    // An exponent of 0 alone would mean no highlight.
    if reflectivity > 0.0 || number(spec, "exponent") == Some(0.0) {
        // Not in the format, but other programs write it too, and the rest ignore it.
        push_number(out, "Kr", reflectivity);
    }
    out.extend_from_slice(match (!kt.is_black() && is_thin, reflectivity > 0.0) {
        (true, _) => b"illum 4\n",
        (false, true) => b"illum 3\n",
        (false, false) => b"illum 2\n",
    });
}

fn push_colour(out: &mut Vec<u8>, key: &str, colour: Rgb) {
    out.extend_from_slice(key.as_bytes());
    out.push(b' ');
    push_f32s(out, &colour.to_array());
    out.push(b'\n');
}

fn push_number(out: &mut Vec<u8>, key: &str, number: f32) {
    out.extend_from_slice(key.as_bytes());
    out.push(b' ');
    push_f32(out, number);
    out.push(b'\n');
}

/// A name on a single line, since names end at the end of the line.
pub(super) fn one_line(name: &str) -> String {
    name.replace(['\n', '\r', '\0'], " ").trim().to_owned()
}

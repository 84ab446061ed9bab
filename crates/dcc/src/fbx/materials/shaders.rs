//! The shaders of programs: Maya's Stingray and Arnold's standard surface, 3ds Max's physical, PBR, glTF and OpenPBR materials.
//!
//! All of them are principled, and name the same things alike: `Maya|base_color`, `3dsMax|Parameters|base_color`,
//! `3dsMax|main|baseColor`. The last part of the name decides, without capitals and underscores.

use super::draft::Draft;
use crate::fbx::document::{Index, Properties};
use bilux_import::FormatError;
use bilux_math::{DVec3, Rgb};
use bilux_scene::texture::Channel;

/// Sources of a parameter of ours: the names of its value, of a factor on it, and of its texture.
struct Row {
    key: &'static str,
    values: &'static [&'static str],
    factors: &'static [&'static str],
    maps: &'static [&'static str],
    is_colour: bool,
}

const fn colour(key: &'static str, values: &'static [&'static str], maps: &'static [&'static str]) -> Row {
    Row { key, values, factors: &[], maps, is_colour: true }
}

const fn number(key: &'static str, values: &'static [&'static str], maps: &'static [&'static str]) -> Row {
    Row { key, values, factors: &[], maps, is_colour: false }
}

const ROWS: &[Row] = &[
    Row {
        factors: &["baseweight", "base"],
        ..colour("base_color", &["basecolor"], &["basecolormap", "texcolormap", "basecolor"])
    },
    number(
        "base_metalness",
        &["metalness", "metallic", "basemetalness"],
        &["metalnessmap", "texmetallicmap", "metalness", "basemetalnessmap"],
    ),
    number(
        "specular_roughness",
        &["specularroughness", "roughness"],
        &["roughnessmap", "texroughnessmap", "specularroughnessmap", "specularroughness"],
    ),
    number("base_diffuse_roughness", &["diffroughness", "diffuseroughness", "basediffuseroughness"], &[]),
    number("specular_weight", &["reflectivity", "specularweight"], &[]),
    number("specular_ior", &["transior", "specularior", "indexofrefraction"], &[]),
    number(
        "transmission_weight",
        &["transparency", "transmission", "transmissionweight"],
        &["transparencymap", "transmissionmap"],
    ),
    colour("transmission_color", &["transcolor", "transmissioncolor"], &[]),
    number("coat_weight", &["coating", "coat", "coatweight", "clearcoat"], &["coatmap", "clearcoatmap"]),
    colour("coat_color", &["coatcolor"], &[]),
    number("coat_roughness", &["coatroughness", "clearcoatroughness"], &["coatroughmap"]),
    number("coat_ior", &["coatior"], &[]),
    number("fuzz_weight", &["sheen", "fuzzweight"], &[]),
    colour("fuzz_color", &["sheencolor", "fuzzcolor"], &[]),
    number("fuzz_roughness", &["sheenroughness", "fuzzroughness"], &[]),
    Row {
        factors: &["emission", "emissionweight", "emissiveintensity"],
        ..colour(
            "emission",
            &["emitcolor", "emissioncolor", "emissive"],
            &["emitcolormap", "emissioncolormap", "texemissivemap", "emissioncolor"],
        )
    },
];

/// The names of a texture of normals, and of one of opacities.
const NORMALS: [&str; 5] = ["normmap", "bumpmap", "texnormalmap", "normalmap", "normalcamera"];
const OPACITIES: [&str; 4] = ["cutoutmap", "opacitymap", "opacity", "geometryopacitymap"];

/// Sets what the shader of a program says; false if the material has none.
pub(super) fn fill(properties: &Properties, draft: &mut Draft) -> Result<bool, FormatError> {
    let known: Vec<(String, &str)> =
        properties.own_names().filter_map(|name| Some((short(name)?, name))).collect();
    let find = |names: &[&str]| {
        names.iter().find_map(|wanted| known.iter().find(|(short, _)| short == wanted)).map(|(_, name)| *name)
    };
    if find(&["basecolor"]).is_none() {
        return Ok(false);
    }
    let is_inverted =
        |names: &[&str]| find(names).and_then(|name| properties.integer(name)).is_some_and(|on| on == 1);
    for row in ROWS {
        let map = connected(row.maps, draft);
        let factor = find(row.factors).and_then(|name| properties.number(name)).unwrap_or(1.0);
        if row.is_colour {
            let stated = find(row.values).and_then(|name| properties.vector(name));
            let Some(value) = stated.or(map.map(|_| DVec3::ONE)) else { continue };
            let value = if map.is_some() { DVec3::ONE } else { value.max(DVec3::ZERO) } * factor.max(0.0);
            let [r, g, b] = value.to_array().map(|c| c as f32);
            if row.key != "emission" || value != DVec3::ZERO {
                draft.colour(row.key, Rgb::new(r, g, b), map)?;
            }
        } else {
            let stated = find(row.values).and_then(|name| properties.number(name));
            let Some(value) = stated.or(map.map(|_| 1.0)) else { continue };
            let value = match row.key {
                "specular_roughness" if is_inverted(&["roughnessinv"]) => 1.0 - value,
                "coat_roughness" if is_inverted(&["coatroughnessinv"]) => 1.0 - value,
                _ => value,
            };
            draft.number(row.key, if map.is_some() { 1.0 } else { value }, map, Channel::G)?;
        }
    }
    if let Some(gloss) = find(&["glossiness"]).and_then(|name| properties.number(name)) {
        draft.set("specular_roughness", (1.0 - gloss).clamp(0.0, 1.0) as f32);
    }
    if find(&["thinwalled", "geometrythinwalled"]).and_then(|name| properties.integer(name)) == Some(1) {
        draft.set("thin_walled", true);
    }
    let map = connected(&OPACITIES, draft);
    if map.is_some() {
        draft.number("opacity", 1.0, map, Channel::G)?;
    }
    let map = connected(&NORMALS, draft);
    draft.normals(map, 1.0)?;
    Ok(true)
}

/// The last part of a program's name of a property, without capitals and underscores.
fn short(name: &str) -> Option<String> {
    let is_of_program = ["Maya|", "3dsMax|"].iter().any(|program| name.starts_with(program));
    let last = name.rsplit('|').next().filter(|_| is_of_program)?;
    Some(last.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect())
}

/// The texture that is connected under one of these names.
fn connected(names: &[&str], draft: &Draft) -> Option<Index> {
    let document = draft.posed.document;
    let links = document.sources(draft.worn.material?);
    names.iter().find_map(|wanted| {
        let is_it = |name: &[u8]| {
            short(std::str::from_utf8(name).unwrap_or_default()).is_some_and(|short| short == *wanted)
        };
        let link = links.iter().find(|link| link.property.is_some_and(is_it))?;
        matches!(document.class(link.source), b"Texture" | b"LayeredTexture").then_some(link.source)
    })
}

//! Catalogue of what the page offers, from the same tables as the command line: names, help, units, ranges.

use bilux::accel::ACCELERATORS;
use bilux::math::registry::{Entry, Parameter, ParameterKind};
use bilux::pictures::TONEMAPS;
use bilux::scene::{CAMERAS, LIGHTS, MATERIALS};
use bilux::settings::RENDER;
use bilux::transport::aovs::{AOVS, Aov};
use bilux::transport::integrators::INTEGRATORS;
use serde_json::{Value, json};

/// The name of the heat map of the accelerator.
pub(crate) const VISITS: &str = "visits";

/// The layers that can be shown in the place of the picture.
pub(crate) const LAYERS: [Aov; 4] = [Aov::Albedo, Aov::Normal, Aov::Depth, Aov::Ids];

/// The settings that the page offers, in groups.
const GROUPS: &[(&str, &[&str])] = &[
    ("Camera and studio", &["camera", "ground", "background"]),
    ("Time", &["time", "shutter", "readout"]),
    ("Display", &["exposure", "auto_exposure", "tonemap", "denoise"]),
    ("Light", &["integrator", "max_depth", "spp", "seed"]),
    ("Speed", &["accel"]),
];

/// True if those who watch may change this setting: one that the page offers, or a parameter of an integrator.
pub(crate) fn is_offered(key: &str) -> bool {
    let is_own = |entry: &Entry| entry.parameters.iter().any(|p| p.name == key);
    GROUPS.iter().any(|(_, keys)| keys.contains(&key)) || INTEGRATORS.iter().any(|row| is_own(&row.entry))
}

/// Everything that the page offers.
pub(crate) fn catalogue() -> Value {
    let parameter = |key: &&str| RENDER.parameters.iter().find(|p| p.name == *key).map(parameter);
    let group = |(name, keys): &(&str, &[&str])| json!({ "name": name, "settings": keys.iter().filter_map(parameter).collect::<Vec<_>>() });
    json!({
        "say": "catalogue",
        "groups": GROUPS.iter().map(group).collect::<Vec<_>>(),
        "integrators": INTEGRATORS.iter().map(|row| entry(&row.entry)).collect::<Vec<_>>(),
        "parts": {
            "material": MATERIALS.iter().map(|row| entry(&row.entry)).collect::<Vec<_>>(),
            "light": LIGHTS.iter().map(|row| entry(&row.entry)).collect::<Vec<_>>(),
            "camera": CAMERAS.iter().map(|row| entry(&row.entry)).collect::<Vec<_>>(),
        },
        "layers": layers(),
    })
}

/// Layers and maps that can be shown in the place of the picture.
fn layers() -> Vec<Value> {
    let features =
        AOVS.iter().filter(|row| LAYERS.contains(&row.aov)).map(|row| (row.entry.name, row.entry.summary));
    let visits = "what the accelerator does for the ray of each pixel: nodes that it visits and triangles that it tests, \
                  from none (black) to 65,536 (pale yellow), on a logarithmic scale";
    let all = features.chain([(VISITS, visits)]);
    all.map(|(name, summary)| json!({ "name": name, "summary": summary })).collect()
}

fn entry(entry: &Entry) -> Value {
    let parameters: Vec<Value> = entry.parameters.iter().map(parameter).collect();
    json!({ "name": entry.name, "summary": entry.summary, "parameters": parameters })
}

/// A parameter; `kind` says how the page lets it be changed.
fn parameter(p: &Parameter) -> Value {
    let mut shown = json!({ "name": p.name, "summary": p.summary, "unit": p.unit, "default": p.default });
    let kind = match p.kind {
        ParameterKind::Bool => json!({ "kind": "switch" }),
        ParameterKind::Integer { min, max } => json!({ "kind": "integer", "min": min, "max": max }),
        ParameterKind::Number { min, max } | ParameterKind::NumberTexture { min, max } => {
            json!({ "kind": "number", "min": min, "max": max })
        }
        ParameterKind::Colour { min, max } | ParameterKind::ColourTexture { min, max } => {
            json!({ "kind": "colour", "min": min, "max": max })
        }
        ParameterKind::Vector => json!({ "kind": "vector" }),
        ParameterKind::Choice(words) => json!({ "kind": "choice", "choices": named(words) }),
        ParameterKind::Text => match choices(p.name) {
            Some(choices) => json!({ "kind": "choice", "choices": choices }),
            None => json!({ "kind": "text" }),
        },
        _ => json!({ "kind": "none" }),
    };
    if let (Value::Object(shown), Value::Object(kind)) = (&mut shown, kind) {
        shown.extend(kind);
    }
    shown
}

/// The choices of a setting that names a row of a table.
fn choices(name: &str) -> Option<Value> {
    let rows = |rows: &mut dyn Iterator<Item = Entry>| {
        let row = |row: Entry| json!({ "name": row.name, "summary": row.summary });
        rows.map(row).collect::<Vec<_>>()
    };
    let auto = || vec![json!({ "name": "auto", "summary": "what suits the scene" })];
    let all = match name {
        "integrator" => rows(&mut INTEGRATORS.iter().map(|row| row.entry)),
        "accel" => [auto(), rows(&mut ACCELERATORS.iter().map(|row| row.entry))].concat(),
        "tonemap" => [auto(), rows(&mut TONEMAPS.iter().map(|row| row.entry))].concat(),
        _ => return None,
    };
    Some(all.into())
}

fn named(words: &[&str]) -> Value {
    words.iter().map(|word| json!({ "name": word, "summary": "" })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_is_offered_is_in_the_tables() {
        let catalogue = catalogue();
        let groups = catalogue["groups"].as_array().unwrap();
        let offered: usize = groups.iter().map(|group| group["settings"].as_array().unwrap().len()).sum();
        assert_eq!(offered, GROUPS.iter().map(|(_, keys)| keys.len()).sum::<usize>());
        assert!(is_offered("exposure") && is_offered("roulette_depth"));
        assert!(!is_offered("threads") && !is_offered("size") && !is_offered("nonsense"));
        let light = groups.iter().find(|group| group["name"] == "Light").unwrap();
        let integrator = &light["settings"][0];
        assert_eq!(integrator["kind"], "choice");
        assert_eq!(integrator["choices"].as_array().unwrap().len(), INTEGRATORS.len());
    }
}

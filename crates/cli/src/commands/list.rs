//! `bilux list`: every table, as text or as JSON.

use super::DONE;
use crate::arguments::List;
use crate::{output, usage};
use anyhow::anyhow;
use bilux::math::registry::{Entry, Parameter, ParameterKind};
use serde_json::json;

/// A table: its name, a summary of what it holds, and its rows.
struct Table {
    name: &'static str,
    summary: &'static str,
    rows: fn() -> Vec<Entry>,
}

macro_rules! rows {
    ($table:expr) => {
        || $table.iter().map(|row| row.entry).collect()
    };
}

/// Every table.
const TABLES: &[Table] = &[
    Table {
        name: "integrators",
        summary: "light-transport algorithms",
        rows: rows!(bilux::transport::integrators::INTEGRATORS),
    },
    Table {
        name: "accels",
        summary: "acceleration structures for ray queries",
        rows: rows!(bilux::accel::ACCELERATORS),
    },
    Table {
        name: "visibility",
        summary: "hidden-surface removal",
        rows: rows!(bilux::accel::visibility::VISIBILITY),
    },
    Table {
        name: "materials",
        summary: "what surfaces are made of",
        rows: rows!(bilux::scene::materials::MATERIALS),
    },
    Table { name: "textures", summary: "procedural textures", rows: rows!(bilux::scene::texture::TEXTURES) },
    Table {
        name: "bsdfs",
        summary: "lobes that materials are built from",
        rows: rows!(bilux::scene::bsdf::BSDFS),
    },
    Table { name: "lights", summary: "light sources", rows: rows!(bilux::scene::lights::LIGHTS) },
    Table { name: "cameras", summary: "kinds of camera", rows: rows!(bilux::scene::cameras::CAMERAS) },
    Table {
        name: "generators",
        summary: "built-in scenes",
        rows: rows!(bilux::scene::generators::GENERATORS),
    },
    Table {
        name: "presets",
        summary: "cameras and surroundings for files without a camera or lights",
        rows: rows!(bilux::presets::PRESETS),
    },
    Table { name: "formats", summary: "formats of scene files", rows: rows!(bilux::formats::SCENE_FORMATS) },
    Table {
        name: "picture-formats",
        summary: "formats of picture files",
        rows: rows!(bilux::pictures::formats::PICTURE_FORMATS),
    },
    Table {
        name: "tonemaps",
        summary: "tone-mapping curves",
        rows: rows!(bilux::pictures::tonemap::TONEMAPS),
    },
    Table {
        name: "denoisers",
        summary: "denoising methods, the best first",
        rows: rows!(bilux::pictures::DENOISERS),
    },
    Table {
        name: "filters",
        summary: "pixel reconstruction filters",
        rows: rows!(bilux::transport::filters::FILTERS),
    },
    Table {
        name: "aovs",
        summary: "arbitrary output variables: what a render can write as well as the picture",
        rows: rows!(bilux::transport::aovs::AOVS),
    },
    Table {
        name: "metrics",
        summary: "measures of how much a picture differs from a reference",
        rows: rows!(bilux::pictures::metrics::METRICS),
    },
    Table {
        name: "settings",
        summary: "the keys of [render] in scene files and of --set",
        rows: || vec![bilux::settings::RENDER],
    },
];

pub fn run(arguments: &List) -> anyhow::Result<u8> {
    let Some(table) = TABLES.iter().find(|table| table.name == arguments.what) else {
        let names: Vec<String> = TABLES.iter().map(|table| table.name.to_owned()).collect();
        let hint = match bilux::scene::error::nearest_name(&arguments.what, &names) {
            Some(name) => format!("did you mean '{name}'?"),
            None => format!("there are: {}", names.join(", ")),
        };
        return Err(usage::wrong(anyhow!("there is no list '{}'; {hint}", arguments.what)));
    };
    let rows = (table.rows)();
    if arguments.json {
        let rows: Vec<_> = rows.iter().map(row_json).collect();
        output::print(serde_json::to_string_pretty(&json!({ table.name: rows }))?)?;
    } else {
        output::print(format_args!("{}: {}\n", table.name, table.summary))?;
        let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
        rows.iter().try_for_each(|row| output::print(row_text(row, width)))?;
    }
    Ok(DONE)
}

/// Prints the JSON Schema of scene files.
pub fn schema() -> anyhow::Result<u8> {
    let rows = bilux::transport::integrators::INTEGRATORS.iter().map(|row| row.entry);
    let mut settings: Vec<Parameter> = bilux::settings::RENDER.parameters.to_vec();
    for parameter in rows.flat_map(|entry| entry.parameters) {
        if !settings.iter().any(|known| known.name == parameter.name) {
            settings.push(*parameter);
        }
    }
    output::print(serde_json::to_string_pretty(&bilux::formats::toml_schema(&settings))?)?;
    Ok(DONE)
}

/// A row and its parameters, one a line; the names in a column of this width.
fn row_text(row: &Entry, width: usize) -> String {
    let source = if row.source.is_empty() { String::new() } else { format!(" [{}]", row.source) };
    let mut text = format!("  {:<width$}  {}{source}", row.name, row.summary);
    let width = row.parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for p in row.parameters {
        let unit = if p.unit.is_empty() { String::new() } else { format!(", in {}", p.unit) };
        let default =
            if p.default.is_empty() { "required".to_owned() } else { format!("[default: {}]", p.default) };
        text += &format!("\n      {:<width$}  {} ({}{unit}) {default}", p.name, p.summary, kind_text(p.kind));
    }
    text
}

fn kind_text(kind: ParameterKind) -> String {
    match kind {
        ParameterKind::Bool => "true or false".to_owned(),
        ParameterKind::Integer { min, max } => format!("{min} to {max}"),
        ParameterKind::Number { min, max } => format!("{min} to {max}"),
        ParameterKind::Colour { min, max } => format!("colour {min} to {max}"),
        ParameterKind::ColourTexture { min, max } => format!("colour {min} to {max}, or a texture"),
        ParameterKind::NumberTexture { min, max } => format!("{min} to {max}, or a texture"),
        ParameterKind::Texture => "texture".to_owned(),
        ParameterKind::Stops { min, max } => format!("[position, colour {min} to {max}], several"),
        ParameterKind::Vector => "x, y, z".to_owned(),
        ParameterKind::Choice(words) => words.join("|"),
        ParameterKind::Text => "text".to_owned(),
        ParameterKind::Material => "a material's name".to_owned(),
    }
}

fn row_json(row: &Entry) -> serde_json::Value {
    let parameters: Vec<_> = row.parameters.iter().map(parameter_json).collect();
    json!({ "name": row.name, "summary": row.summary, "source": row.source, "parameters": parameters })
}

fn parameter_json(p: &Parameter) -> serde_json::Value {
    json!({
        "name": p.name, "summary": p.summary, "unit": p.unit,
        "values": kind_text(p.kind), "default": p.default,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_help_names_every_table() {
        let mut command = crate::arguments::Arguments::command();
        let help = command.find_subcommand_mut("list").unwrap().render_long_help().to_string();
        for table in TABLES {
            assert!(help.contains(table.name), "{}", table.name);
        }
    }
}

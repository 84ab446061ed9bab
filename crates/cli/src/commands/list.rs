//! `bilux list`: every table, as text or as JSON.

use crate::arguments::List;
use crate::commands::DONE;
use crate::process::{output, usage};
use anyhow::anyhow;
use bilux::math::registry::{Entry, Parameter, ParameterKind};
use bilux::tables::{Detail, TABLES, values};
use serde_json::json;

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
        let rows: Vec<_> = rows.iter().map(|row| row_json(row, &(table.details)(row.name))).collect();
        output::print(serde_json::to_string_pretty(&json!({ table.name: rows }))?)?;
    } else {
        output::print(format_args!("{}: {}\n", table.name, table.summary))?;
        let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
        rows.iter().try_for_each(|row| output::print(row_text(row, &(table.details)(row.name), width)))?;
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
fn row_text(row: &Entry, details: &[Detail], width: usize) -> String {
    let source = if row.source.is_empty() { String::new() } else { format!(" [{}]", row.source) };
    let mut text = format!("  {:<width$}  {}{source}", row.name, row.summary);
    for (heading, words) in details.iter().filter(|(_, words)| !words.is_empty()) {
        text += &format!("\n  {:<width$}    {heading} {}", "", words.join(", "));
    }
    let width = row.parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
    for p in row.parameters {
        let unit = if p.unit.is_empty() { String::new() } else { format!(", in {}", p.unit) };
        let unit = match units_of(p) {
            units if units.is_empty() => unit,
            units => format!("{unit}, or as text in {}", units.join(", ")),
        };
        let default =
            if p.default.is_empty() { "required".to_owned() } else { format!("[default: {}]", p.default) };
        text += &format!("\n      {:<width$}  {} ({}{unit}) {default}", p.name, p.summary, values(p.kind));
    }
    text
}

/// The units in which its value can be a text.
fn units_of(p: &Parameter) -> Vec<&'static str> {
    match p.kind {
        ParameterKind::Colour { .. } | ParameterKind::ColourTexture { .. } => {
            let units = bilux::scene::parameters::units_of(p.unit);
            if units.is_empty() { units } else { units.into_iter().chain(["K"]).collect() }
        }
        _ => Vec::new(),
    }
}

fn row_json(row: &Entry, details: &[Detail]) -> serde_json::Value {
    let parameters: Vec<_> = row.parameters.iter().map(parameter_json).collect();
    let mut json = json!({
        "name": row.name, "summary": row.summary, "source": row.source, "parameters": parameters,
    });
    for (heading, words) in details {
        json[*heading] = json!(words);
    }
    json
}

fn parameter_json(p: &Parameter) -> serde_json::Value {
    json!({
        "name": p.name, "summary": p.summary, "unit": p.unit, "units": units_of(p),
        "values": values(p.kind), "default": p.default,
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

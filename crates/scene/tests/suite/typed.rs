//! The types of `bilux_scene::typed` match the tables, parameter by parameter.

use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::{LIGHTS, MATERIALS};
use std::fmt::Write;

/// Set by `cargo xtask docs`: files are written instead of compared.
const WRITE: &str = "BILUX_WRITE_TYPES";

fn source(what: &str, rows: impl Iterator<Item = Entry>) -> String {
    let mut text = format!(
        "//! {what} as Rust types. Generated from their table by `cargo xtask docs`; do not edit by hand.\n\ntyped! {{\n"
    );
    for row in rows {
        let _ = writeln!(text, "    /// {}.", documented(row.summary));
        let _ = writeln!(text, "    {} = \"{}\" {{", camel_case(row.name), row.name);
        for parameter in row.parameters {
            let _ = writeln!(text, "        /// {}.", about(parameter));
            let _ = writeln!(text, "        {}: {},", parameter.name, rust_type(parameter.kind));
        }
        text += "    }\n";
    }
    text + "}\n"
}

fn about(parameter: &Parameter) -> String {
    let mut about = documented(parameter.summary);
    if !parameter.unit.is_empty() {
        let _ = write!(about, " ({})", parameter.unit);
    }
    if let ParameterKind::Choice(words) = parameter.kind {
        let _ = write!(about, ": `{}`", words.join("`, `"));
    }
    match parameter.default {
        "" => about + "; it has to be given",
        default => about + &format!("; default `{default}`"),
    }
}

/// Formats a line of documentation: it starts with a capital letter, and no bracket makes a link.
fn documented(summary: &str) -> String {
    let escaped = summary.replace('[', "\\[").replace('<', "\\<");
    let mut letters = escaped.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn camel_case(name: &str) -> String {
    let word = |word: &str| word[..1].to_uppercase() + &word[1..];
    name.split('-').map(word).collect()
}

fn rust_type(kind: ParameterKind) -> &'static str {
    match kind {
        ParameterKind::Bool => "bool",
        ParameterKind::Integer { .. } => "i32",
        ParameterKind::Number { .. } => "f32",
        ParameterKind::Colour { .. } => "bilux_math::Rgb",
        ParameterKind::Vector => "bilux_math::Vec3",
        ParameterKind::Choice(_) | ParameterKind::Text => "&str",
        // A colour or a number, or a texture in its place; for the others, the value that file readers make.
        _ => "impl Into<crate::Value>",
    }
}

fn compare(file: &str, is: &str, wanted: &str) {
    if is == wanted {
        // Writing the same once more would make cargo build all crates anew.
        return;
    }
    if std::env::var_os(WRITE).is_some() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/typed").join(file);
        std::fs::write(path, wanted).unwrap();
    } else {
        panic!("src/typed/{file} is not what the table says: run `cargo xtask docs`");
    }
}

#[test]
fn every_material_and_light_has_its_type() {
    let materials = source("Materials", MATERIALS.iter().map(|row| row.entry));
    compare("materials.rs", include_str!("../../src/typed/materials.rs"), &materials);
    let lights = source("Lights", LIGHTS.iter().map(|row| row.entry));
    compare("lights.rs", include_str!("../../src/typed/lights.rs"), &lights);
}

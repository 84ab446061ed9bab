//! The methods of `bilux::JobRequest` match the table of settings, one by one.

use bilux::math::registry::{Parameter, ParameterKind};
use bilux::settings::RENDER;
use std::fmt::Write;

/// Set by `cargo xtask docs`: the file is written instead of compared.
const WRITE: &str = "BILUX_WRITE_TYPES";

fn source() -> String {
    let mut text = "//! The settings of a request. Generated from their table by `cargo xtask docs`; do not edit by hand.\n\n\
                    settings! {\n"
        .to_owned();
    // A size is two numbers, and has a method of its own.
    for parameter in RENDER.parameters.iter().filter(|parameter| parameter.name != "size") {
        let _ = writeln!(text, "    /// {}.", about(parameter));
        let _ = writeln!(text, "    {}: {},", parameter.name, rust_type(parameter));
    }
    text + "}\n"
}

fn about(parameter: &Parameter) -> String {
    let (first, rest) = parameter.summary.split_at(1);
    let mut about = first.to_uppercase() + &rest.replace('[', "\\[").replace('<', "\\<");
    if !parameter.unit.is_empty() {
        let _ = write!(about, " ({})", parameter.unit);
    }
    if let ParameterKind::Choice(words) = parameter.kind {
        let _ = write!(about, ": `{}`", words.join("`, `"));
    }
    about + &format!("; default `{}`", parameter.default)
}

fn rust_type(parameter: &Parameter) -> &'static str {
    match (parameter.name, parameter.kind) {
        ("eye" | "look_at", _) => "bilux_math::Vec3",
        ("orbit", _) => "[f32; 2]",
        (_, ParameterKind::Bool) => "bool",
        (_, ParameterKind::Integer { max, .. }) if max > u32::MAX.into() => "u64",
        (_, ParameterKind::Integer { .. }) => "u32",
        (_, ParameterKind::Number { .. }) => "f32",
        _ => "&str",
    }
}

#[test]
fn every_setting_has_its_method() {
    let wanted = source();
    if include_str!("../../src/request/settings.rs") == wanted {
        // Writing the same once more would make cargo build all crates anew.
        return;
    }
    if std::env::var_os(WRITE).is_some() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/request/settings.rs");
        std::fs::write(path, wanted).unwrap();
    } else {
        panic!("src/request/settings.rs is not what the table says: run `cargo xtask docs`");
    }
}

//! Advice in the parser's messages, which say what is missing but not what to write.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::path::Path;

/// A message of the parser, with advice on the mistakes of first-time users.
pub fn added(mut error: clap::Error) -> clap::Error {
    let tip =
        match (error.kind(), error.get(ContextKind::InvalidArg), error.get(ContextKind::InvalidSubcommand)) {
            (ErrorKind::MissingRequiredArgument, Some(ContextValue::Strings(missing)), _) => {
                of_missing(&missing.join(" "))
            }
            (ErrorKind::InvalidSubcommand, _, Some(ContextValue::String(name))) => of_command(name),
            _ => None,
        };
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedSubcommand);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

fn of_missing(missing: &str) -> Option<String> {
    let command = std::env::args().nth(1).unwrap_or_default();
    if missing.contains("<SCENE>") && command == "render" {
        return Some(
            "name the scene and the picture, such as `bilux render model.glb -o picture.png`".to_owned(),
        );
    }
    let example = match &*command {
        "generate" => "scene.toml",
        "convert" => "model.glb",
        _ => "picture.png",
    };
    missing.contains("--output").then(|| format!("name the file to write, such as `-o {example}`"))
}

/// What to write instead of a file in the place of a command.
fn of_command(name: &str) -> Option<String> {
    let path = Path::new(name);
    let extension = path.extension()?.to_str()?;
    let is_scene = bilux::formats::format_named(extension).is_some() || path.is_file();
    is_scene.then(|| format!("to render a scene, write `bilux render {name} -o picture.png`"))
}

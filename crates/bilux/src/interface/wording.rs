//! Messages in the words of Python. The library calls options as the command line does; here they are keywords.

use crate::preparation::presets::SURROUNDINGS;
use crate::settings::RENDER;
use bilux_math::registry::ParameterKind;
use bilux_pictures::TONEMAPS;
use bilux_transport::aovs::AOVS;

/// Options that have other names in Python.
const RENAMED: [(&str, &str); 2] = [("at", "time"), ("env", "scene.surround")];

/// A message for users of Python: options as keywords, settings by their names alone, and no advice that only the command
/// line can follow.
pub fn in_python(message: &str) -> String {
    let of_command_line =
        |clause: &&str| clause.contains("`bilux ") || clause.contains("on the command line");
    let clauses: Vec<&str> = message.split("; ").collect();
    let kept: Vec<&str> = clauses.iter().copied().filter(|clause| !of_command_line(clause)).collect();
    let text = if kept.is_empty() { message.to_owned() } else { kept.join("; ") };
    // A keyword is its own place: "spp: render.spp is -3".
    let own = text
        .split_once(": render.")
        .filter(|(key, rest)| rest.strip_prefix(key).is_some_and(|rest| rest.starts_with(' ')));
    let text = own.map_or(&*text, |(_, rest)| rest);
    let text = text
        .replace("no render setting '", "no setting '")
        .replace("{ texture = \"FILE\" }", "a bilux.Texture")
        .replace("name a scene file; ", "give a scene; ");
    with_keywords(&text)
}

/// The text with each option as a keyword.
fn with_keywords(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("--") {
        let (before, option) = (&rest[..at], &rest[at + 2..]);
        let length = option.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(option.len());
        let begins =
            before.chars().last().or(written.chars().last()).is_none_or(|c| !c.is_alphanumeric() && c != '-');
        written += before;
        if !begins || length == 0 {
            written += "--";
            rest = option;
            continue;
        }
        let (name, after) = option.split_at(length);
        let (keyword, taken) = keyword(name, after);
        written += &keyword;
        rest = &after[taken..];
    }
    written + rest
}

/// An option as a keyword, given what follows its name, and how much of that is its value.
fn keyword(name: &str, after: &str) -> (String, usize) {
    let plain = name.replace('-', "_");
    let name = RENAMED.iter().find(|(option, _)| *option == plain).map_or(&*plain, |(_, python)| python);
    let value = after.strip_prefix([' ', '=']).unwrap_or_default();
    let end = value.find(|c: char| c.is_whitespace() || ");:'\"".contains(c)).unwrap_or(value.len());
    let value = value[..end].trim_end_matches(['.', ',']);
    if !is_value(name, value) {
        let known = if name == "scene.surround" { "scene.surround(…)" } else { name };
        return (known.to_owned(), 0);
    }
    let text = match name {
        "set" => value.to_owned(),
        "scene.surround" if is_placeholder(value) => format!("scene.surround({value})"),
        "scene.surround" => format!("scene.surround({value:?})"),
        "aov" => format!("aov=[{value:?}]"),
        _ if value.contains(',') => format!("{name}=({})", value.replace(',', ", ")),
        _ if value.parse::<f64>().is_ok() || is_placeholder(value) => format!("{name}={value}"),
        _ => format!("{name}={value:?}"),
    };
    (text, 1 + value.len())
}

/// True if this word after an option is its value, rather than the sentence's next word.
fn is_value(name: &str, word: &str) -> bool {
    let is_number = word.strip_prefix('-').unwrap_or(word).starts_with(|c: char| c.is_ascii_digit());
    let choices = RENDER.parameters.iter().filter(|parameter| parameter.name == name);
    let is_choice = choices.clone().any(|parameter| match parameter.kind {
        ParameterKind::Choice(choices) => choices.contains(&word),
        _ => false,
    });
    let is_row = match name {
        "aov" => AOVS.iter().any(|row| row.entry.name == word),
        "tonemap" => TONEMAPS.iter().any(|row| row.entry.name == word),
        "set" => word.contains('='),
        "scene.surround" => SURROUNDINGS.iter().any(|row| row.name == word),
        _ => false,
    };
    is_number || is_choice || is_row || is_placeholder(word)
}

/// True for what stands for a value, such as FILE.
fn is_placeholder(word: &str) -> bool {
    word.len() > 1 && word.bytes().all(|letter| letter.is_ascii_uppercase())
}

#[cfg(test)]
mod tests {
    use super::in_python;

    #[test]
    fn options_become_keywords() {
        for (said, heard) in [
            ("--ground has no effect: look up", "ground has no effect: look up"),
            ("use --ground shadow to keep it", "use ground=\"shadow\" to keep it"),
            ("for example with --orbit 206.5,-17.8", "for example with orbit=(206.5, -17.8)"),
            ("picture: --orbit 26.5,17.8 uses it", "picture: orbit=(26.5, 17.8) uses it"),
            ("leave --ground out", "leave ground out"),
            ("leave out --fog or --background", "leave out fog or background"),
            ("as intervals (--aov interval), the other", "as intervals (aov=[\"interval\"]), the other"),
            ("depends on --accel", "depends on accel"),
            ("its surroundings (--env) or", "its surroundings (scene.surround(…)) or"),
            ("--env FILE lights it", "scene.surround(FILE) lights it"),
            ("(--env none leaves them out)", "(scene.surround(\"none\") leaves them out)"),
            ("choose one (--layer NAME, or", "choose one (layer=NAME, or"),
            ("--time-limit 5, or --noise 0.02.", "time_limit=5, or noise=0.02."),
            ("it is empty; `bilux info` shows more", "it is empty"),
            ("write white; for a picture, use --background FILE on the command line", "write white"),
            ("spp: render.spp is -3, but must be more", "spp is -3, but must be more"),
            ("or { texture = \"FILE\" }", "or a bilux.Texture"),
            ("a.toml:2:1: render.spp is -3", "a.toml:2:1: render.spp is -3"),
            ("my--file.obj:2:1: this -- that", "my--file.obj:2:1: this -- that"),
        ] {
            assert_eq!(in_python(said), heard);
        }
    }
}

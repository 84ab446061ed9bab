//! The command line that makes the picture that is shown.

use bilux::Session;
use bilux::scene::{Change, Parameters, Value, Which};

/// Settings that have an option of their own; all others are set by `--set`.
const OPTIONS: &[(&str, &str)] = &[
    ("integrator", "--integrator"),
    ("accel", "--accel"),
    ("build", "--build"),
    ("camera", "--camera"),
    ("eye", "--eye"),
    ("look_at", "--look-at"),
    ("zoom", "--zoom"),
    ("orbit", "--orbit"),
    ("up", "--up"),
    ("front", "--front"),
    ("focal", "--focal"),
    ("ground", "--ground"),
    ("background", "--background"),
    ("time", "--at"),
    ("exposure", "--exposure"),
    ("tonemap", "--tonemap"),
    ("max_depth", "--max-depth"),
    ("seed", "--seed"),
    ("threads", "--threads"),
];

/// Settings that are not the user's: they say how far the picture is.
const OF_THE_PICTURE: [&str; 5] = ["size", "spp", "noise", "time_limit", "denoise"];

/// The settings that make the picture of a session as far as it is.
pub(super) fn settings(session: &Session, user: &Parameters) -> Parameters {
    let own = session.job().settings();
    let mut all = user.clone();
    all.0.retain(|(key, ..)| !OF_THE_PICTURE.contains(&key.as_str()));
    all.set("size", format!("{}x{}", own.width, own.height));
    all.set("spp", Value::Integer(i64::from(session.samples().max(1))));
    all.set("denoise", own.denoise.as_str());
    all
}

/// The command line that renders the picture of a session as far as it is, from the words that open its scene, the user's
/// settings, and the changes of the scene.
pub(super) fn command(words: &[String], session: &Session, user: &Parameters, changes: &[Change]) -> String {
    let settings = session.job().settings();
    let mut line = words.to_vec();
    for Change { part, which, key, value, .. } in changes {
        let which = match which {
            Which::Number(number) => number.to_string(),
            Which::Name(name) => name.clone(),
        };
        line.extend(["--change".to_owned(), format!("{}:{which}:{key}={}", part.name(), text(value))]);
    }
    let mut say = |option: &str, value: String| line.extend([option.to_owned(), value]);
    say("-o", "picture.png".to_owned());
    say("--size", format!("{}x{}", settings.width, settings.height));
    say("--spp", session.samples().max(1).to_string());
    for (key, value, _) in &user.0 {
        if OF_THE_PICTURE.contains(&key.as_str()) {
            continue;
        }
        let value = text(value);
        match OPTIONS.iter().find(|(own, _)| own == key) {
            Some((_, option)) => say(option, value),
            None => say("--set", format!("{key}={value}")),
        }
    }
    if settings.denoise != "off" {
        line.push(format!("--denoise={}", settings.denoise));
    }
    let words: Vec<String> = line.iter().map(|word| quoted(word)).collect();
    words.join(" ")
}

fn text(value: &Value) -> String {
    match value {
        Value::Bool(yes) => yes.to_string(),
        Value::Integer(i) => i.to_string(),
        Value::Number(x) => (*x as f32).to_string(),
        Value::Text(text) => text.clone(),
        Value::List(list) => list.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Texture(index) | Value::Material(index) => index.to_string(),
    }
}

/// A word as shells read it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_are_quoted_for_shells() {
        for (word, shown) in [
            ("a-b_c.d/e,1", "a-b_c.d/e,1"),
            ("two words", "'two words'"),
            ("#fff", "'#fff'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(word), shown);
        }
    }
}

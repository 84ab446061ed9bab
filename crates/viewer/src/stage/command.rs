//! The command line that makes the picture that is shown.

use bilux::Session;
use bilux::scene::{Parameters, Value};

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

/// The command line that renders the picture of a session as far as it is, from the words that open its scene and the
/// user's settings.
pub(super) fn command(words: &[String], session: &Session, user: &Parameters) -> String {
    let settings = session.job().settings();
    let mut line = words.to_vec();
    let mut say = |option: &str, value: String| line.extend([option.to_owned(), value]);
    say("-o", "picture.png".to_owned());
    say("--size", format!("{}x{}", settings.width, settings.height));
    say("--spp", session.samples().max(1).to_string());
    for (key, value, _) in &user.0 {
        if ["size", "spp", "noise", "time_limit", "denoise"].contains(&key.as_str()) {
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

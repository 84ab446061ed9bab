//! The command line that makes the picture that is shown.

use bilux::scene::{Change, Parameters, Value, Which};
use bilux::settings::SettingRow;

/// Settings that are not the user's: they are those of the whole picture.
const OF_THE_PICTURE: [&str; 5] = ["size", "spp", "noise", "time_limit", "denoise"];

/// The picture that is being refined, as it will be in the end.
pub(super) struct Whole {
    pub(super) size: [u32; 2],
    /// Samples of each pixel.
    pub(super) samples: u32,
    /// The denoiser, or `off`.
    pub(super) denoise: String,
}

impl Whole {
    /// The settings that make it.
    pub(super) fn settings(&self, user: &Parameters) -> Parameters {
        let mut all = user.clone();
        all.0.retain(|(key, ..)| !OF_THE_PICTURE.contains(&key.as_str()));
        all.set("size", format!("{}x{}", self.size[0], self.size[1]));
        all.set("spp", Value::Integer(i64::from(self.samples)));
        all.set("denoise", self.denoise.as_str());
        all
    }

    /// The command line that renders it, from the words that open its scene, the user's settings, and the changes of the
    /// scene.
    pub(super) fn command(&self, words: &[String], user: &Parameters, changes: &[Change]) -> String {
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
        say("--size", format!("{}x{}", self.size[0], self.size[1]));
        say("--spp", self.samples.to_string());
        for (key, value, _) in &user.0 {
            if OF_THE_PICTURE.contains(&key.as_str()) {
                continue;
            }
            let value = text(value);
            match SettingRow::named(key).and_then(|row| row.option) {
                Some(option) => say(option, value),
                None => say("--set", format!("{key}={value}")),
            }
        }
        line.push(format!("--denoise={}", self.denoise));
        let words: Vec<String> = line.iter().map(|word| quoted(word)).collect();
        words.join(" ")
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::Bool(yes) => yes.to_string(),
        Value::Integer(i) => i.to_string(),
        Value::Number(x) => (*x as f32).to_string(),
        Value::Text(text) => text.clone(),
        Value::List(list) => list.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Texture(index) | Value::Material(index) => index.to_string(),
        Value::Grid(grid) => grid.name().to_owned(),
        Value::Distribution(distribution) => distribution.name().to_owned(),
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
    use super::*;

    /// Every option that is said is one of `bilux render`, and sets what it is said for.
    #[test]
    fn the_whole_picture_is_in_the_command_with_each_setting_by_its_own_option() {
        let whole = Whole { size: [64, 48], samples: 99, denoise: "auto".to_owned() };
        let mut user = Parameters::default();
        for (key, value) in [("size", "1x1"), ("denoise", "off"), ("eye", "1,2,3"), ("roulette_depth", "4")] {
            user.set(key, value);
        }
        let words = ["bilux", "render", "a.toml"].map(str::to_owned);
        let line = whole.command(&words, &user, &[]);
        assert_eq!(
            line,
            "bilux render a.toml -o picture.png --size 64x48 --spp 99 --eye 1,2,3 --set roulette_depth=4 \
             --denoise=auto"
        );
        let settings = whole.settings(&user);
        let said = |key: &str| settings.find(key).map(|(value, _)| value.clone());
        assert_eq!(said("size"), Some("64x48".into()));
        assert_eq!((said("spp"), said("denoise")), (Some(Value::Integer(99)), Some("auto".into())));
    }

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

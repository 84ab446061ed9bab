//! Spelling of keys, numbers and texts in TOML.

/// True if a key needs no quotes.
pub(super) fn is_bare(key: &str) -> bool {
    key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-') && !key.is_empty()
}

/// The shortest text of a number that parses back to the same value; as an f32 if it is one.
pub(super) fn number(x: f64) -> String {
    let narrow = x as f32;
    match x {
        x if x.is_nan() => "nan".to_owned(),
        x if f64::from(narrow) == x => format!("{narrow:?}"),
        x => format!("{x:?}"),
    }
}

/// Text in quotes, as TOML requires.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

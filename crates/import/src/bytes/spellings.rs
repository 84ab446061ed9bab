//! Names of files in URIs.

use std::borrow::Cow;

/// Names that the file of a URI may have on the disk. A query or a fragment usually is no part of the name, but may be: some
/// exporters write names as they are, without escapes, even if they contain `%`, `?` or `#`.
pub fn spellings(uri: &str) -> Vec<String> {
    let path = &uri[..uri.find(['?', '#']).unwrap_or(uri.len())];
    let mut names: Vec<String> = Vec::new();
    for text in [path, uri] {
        let decoded = String::from_utf8(percent_decoded(text).into_owned()).ok();
        for name in decoded.into_iter().chain([text.to_owned()]) {
            if !name.is_empty() && !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Decodes `%20` and the like; malformed escapes stay as they are. [Berners-Lee 2005, 2.1]
pub fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let digit = |byte: Option<&u8>| byte.and_then(|&b| char::from(b).to_digit(16));
    let (bytes, mut decoded) = (text.as_bytes(), Vec::with_capacity(text.len()));
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match (byte, digit(bytes.get(at + 1)), digit(bytes.get(at + 2))) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((high * 16 + low) as u8);
                at += 3;
            }
            _ => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    Cow::Owned(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_blanks_and_umlauts_are_decoded() {
        assert_eq!(&*percent_decoded("a%20b.bin"), b"a b.bin");
        assert_eq!(&*percent_decoded("f%C3%BCr%2.bin"), "für%2.bin".as_bytes());
    }

    #[test]
    fn files_are_looked_for_under_every_spelling_of_their_names() {
        assert_eq!(spellings("a%20b.png"), ["a b.png", "a%20b.png"]);
        assert_eq!(spellings("a b.png?v=3#x"), ["a b.png", "a b.png?v=3#x"]);
        assert_eq!(spellings("100%.png"), ["100%.png"]);
        assert_eq!(spellings("#1.png"), ["#1.png"]);
    }
}

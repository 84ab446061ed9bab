//! Resolves the URIs of buffers and images: embedded data or external files.

use crate::FormatError;
use crate::gltf::json::JsonNode;
use crate::reading::{Reading, Source};
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::{DecodeError, Engine};
use std::borrow::Cow;

/// What a URI refers to.
pub(super) enum Resource {
    /// The bytes embedded in a data URI.
    Data(Vec<u8>),
    /// The name of a file, relative to the scene.
    File(String),
}

/// Resolves a URI without opening anything.
///
/// # Errors
/// If it is malformed, or refers to a network.
pub(super) fn resolve(reading: &mut Reading, node: JsonNode) -> Result<Resource, FormatError> {
    let uri = node.as_text()?;
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((kind, payload)) = data.split_once(',') else {
            return Err(node.error("this data URI has no comma before its data"));
        };
        reading.budget.take_bytes(payload.len() as u64, &node.at().file)?;
        if kind.ends_with(";base64") {
            let decoded = BASE64.decode(payload);
            let start = uri.len() - payload.len();
            return decoded.map(Resource::Data).map_err(|error| {
                node.error(format!(
                    "the base64 of this data URI is malformed: {}",
                    fault(&error, payload, start)
                ))
            });
        }
        return Ok(Resource::Data(percent_decoded(payload).into_owned()));
    }
    if scheme(uri).is_some() || uri.starts_with("//") {
        return Err(node.error(format!(
            "'{uri}' is a web address, but nothing is loaded from the network: put the file next to the scene, and \
             write its name here"
        )));
    }
    let name = String::from_utf8(percent_decoded(uri).into_owned());
    name.map(Resource::File).map_err(|_| node.error("this name is not in UTF-8: rename the file"))
}

/// Describes an error in base64 data that begins at this character of a URI.
fn fault(error: &DecodeError, payload: &str, start: usize) -> String {
    match *error {
        DecodeError::InvalidByte(at, _) | DecodeError::InvalidLastSymbol(at, _) => {
            let letter = payload.get(at..).and_then(|rest| rest.chars().next()).unwrap_or(' ');
            let letter =
                if letter.is_control() { "a control character".to_owned() } else { format!("'{letter}'") };
            format!("its character {} is {letter}, which is not allowed there", start + at + 1)
        }
        DecodeError::InvalidLength(length) => {
            format!("{length} characters do not make a whole number of bytes")
        }
        DecodeError::InvalidPadding => "'=' is misplaced, or missing at the end".to_owned(),
    }
}

/// True if a data URI has a parameter without a name, which only faulty exporters write.
pub(super) fn is_odd(uri: &str) -> bool {
    let kind = uri.strip_prefix("data:").and_then(|data| data.split_once(','));
    kind.is_some_and(|(kind, _)| kind.contains(";;"))
}

/// Loads the bytes that a URI refers to.
pub(super) fn load(reading: &mut Reading, source: &Source, node: JsonNode) -> Result<Vec<u8>, FormatError> {
    match resolve(reading, node)? {
        Resource::Data(bytes) => Ok(bytes),
        Resource::File(name) => {
            let path = reading.locate(source.folder, &name, &node.at())?;
            reading.load(&path)
        }
    }
}

/// Accepts base64 with or without padding, as exporters differ.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The scheme of a URI. A single letter is a Windows drive, not a scheme. [Berners-Lee 2005, 3.1]
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let is_letter = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    (scheme.len() > 1 && scheme.chars().all(is_letter)).then_some(scheme)
}

/// Decodes `%20` and the like; malformed escapes stay as they are. [Berners-Lee 2005, 2.1]
fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
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
        assert_eq!(scheme("https://a"), Some("https"));
        assert_eq!((scheme("a/b:c"), scheme("C:/x"), scheme("plain.bin")), (None, None, None));
    }
}

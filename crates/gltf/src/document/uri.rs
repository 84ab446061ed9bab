//! Resolves the URIs of buffers and images: embedded data or external files.

use crate::document::json::JsonNode;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::{DecodeError, Engine};
use bilux_import::FormatError;
use bilux_import::bytes::spellings::{percent_decoded, spellings};
use bilux_import::input::reading::{Reading, Source};
use std::borrow::Cow;

/// Resource that a URI refers to.
pub(crate) enum Resource {
    /// The bytes embedded in a data URI.
    Data(Vec<u8>),
    /// A file relative to the scene: the spellings of its name, the likeliest first.
    File(Vec<String>),
}

/// Resolves a URI without opening anything.
///
/// # Errors
/// If it is malformed, or refers to a network.
pub(crate) fn resolve(reading: &mut Reading, node: JsonNode) -> Result<Resource, FormatError> {
    let uri = node.as_text()?;
    if let Some(data) = without_scheme(uri, "data:") {
        let Some((kind, payload)) = data.split_once(',') else {
            return Err(node.error("this data URI has no comma before its data"));
        };
        reading.budget.take_bytes(payload.len() as u64, &node.at().file)?;
        return data_of(kind, payload, uri.len() - payload.len())
            .map(Resource::Data)
            .map_err(|what| node.error(what));
    }
    let is_file = without_scheme(uri, "file:").is_some();
    if !is_file && (scheme(uri).is_some() || uri.starts_with("//")) {
        return Err(node.error(format!(
            "'{uri}' is a web address, but nothing is loaded from the network: put the file next to the scene, and \
             write its name here"
        )));
    }
    let names = spellings(uri);
    if names.is_empty() {
        return Err(node.error("this name is not in UTF-8: rename the file"));
    }
    Ok(Resource::File(names))
}

/// The type and the data of a data URI.
pub(crate) fn data(uri: &str) -> Option<(&str, &str)> {
    without_scheme(uri, "data:")?.split_once(',')
}

/// The rest of a URI after a scheme, in upper or lower case; `None` for other URIs. [Berners-Lee 2005, 3.1]
fn without_scheme<'u>(uri: &'u str, scheme: &str) -> Option<&'u str> {
    uri.get(..scheme.len()).filter(|start| start.eq_ignore_ascii_case(scheme)).map(|_| &uri[scheme.len()..])
}

/// The bytes of a data URI whose payload begins at this character, or what is wrong with it. Base64 can contain escapes
/// like all parts of a URI. [Masinter 1998]
fn data_of(kind: &str, payload: &str, start: usize) -> Result<Vec<u8>, String> {
    let is_base64 = kind.rsplit_once(';').is_some_and(|(_, last)| last.trim().eq_ignore_ascii_case("base64"));
    let bytes = percent_decoded(payload);
    if !is_base64 {
        return Ok(bytes.into_owned());
    }
    let is_blank = |byte: &u8| matches!(byte, b' ' | b'\t' | b'\r' | b'\n');
    let bytes = if bytes.iter().any(is_blank) {
        Cow::Owned(bytes.iter().copied().filter(|byte| !is_blank(byte)).collect())
    } else {
        bytes
    };
    BASE64.decode(&*bytes).map_err(|error| {
        let text = String::from_utf8_lossy(&bytes);
        format!("the base64 of this data URI is malformed: {}", fault(&error, &text, start))
    })
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
pub(crate) fn is_odd(uri: &str) -> bool {
    data(uri).is_some_and(|(kind, _)| kind.contains(";;"))
}

/// Loads the bytes that a URI refers to.
pub(crate) fn load(reading: &mut Reading, source: &Source, node: JsonNode) -> Result<Vec<u8>, FormatError> {
    match resolve(reading, node)? {
        Resource::Data(bytes) => Ok(bytes),
        Resource::File(names) => {
            let path = reading.locator.locate_any(source.folder, &names, &node.at())?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_before_a_colon_is_a_drive() {
        assert_eq!(scheme("https://a"), Some("https"));
        assert_eq!((scheme("a/b:c"), scheme("C:/x"), scheme("plain.bin")), (None, None, None));
    }

    /// RFC 2397: the media type is optional, and the data of a URI may be escaped.
    #[test]
    fn every_form_of_data_uri_is_decoded() {
        for uri in [
            "data:text/plain;base64,SGk/PQ==",
            "DATA:;BASE64,SGk/PQ==",
            "data:;base64,SGk%2FPQ%3D%3D",
            "data:application/octet-stream;charset=x;Base64,SGk/\nPQ",
            "data:,Hi%3F%3D",
            "data:,Hi?=",
        ] {
            let (kind, payload) = data(uri).unwrap();
            assert_eq!(data_of(kind, payload, 0).as_deref(), Ok(&b"Hi?="[..]), "{uri}");
        }
    }
}

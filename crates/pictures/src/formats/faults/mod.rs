//! Explains what is wrong with a file that a decoder rejects, in plain words and with the position. External decoders
//! report errors in terms of their own types; this module translates their reports, and scans the file again to find
//! the position.

pub(super) mod exr;
pub(super) mod jpeg;
#[cfg(feature = "ktx2")]
pub(super) mod ktx2;
pub(super) mod png;
pub(super) mod tiff;
pub(super) mod webp;

/// Part of a decoder's report, and its meaning.
type Phrase = (&'static str, &'static str);

/// The explanation of reports that no table contains.
const CONTRADICTION: &str = "its contents contradict each other";

/// The meaning of a report: that of the first phrase that it contains.
fn meaning(report: &str, phrases: &[Phrase]) -> &'static str {
    let report = report.to_lowercase();
    phrases.iter().find(|(part, _)| report.contains(part)).map_or(CONTRADICTION, |(_, meaning)| meaning)
}

/// A part's four-byte name, if it consists of letters.
fn letters(name: &[u8]) -> Option<&str> {
    std::str::from_utf8(name).ok().filter(|name| name.chars().all(|c| c.is_ascii_alphanumeric() || c == ' '))
}

fn u32_at(bytes: &[u8], at: usize, is_big_endian: bool) -> Option<u32> {
    let four = bytes.get(at..)?.first_chunk::<4>()?;
    Some(if is_big_endian { u32::from_be_bytes(*four) } else { u32::from_le_bytes(*four) })
}

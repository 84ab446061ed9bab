//! What is wrong with a file that a decoder refuses, in plain words and with its place. Decoders of others report in the
//! names of their own types; here their reports are looked up, and the file is gone through once more for where.

pub(super) mod exr;
pub(super) mod jpeg;
#[cfg(feature = "ktx2")]
pub(super) mod ktx2;
pub(super) mod png;
pub(super) mod tiff;
pub(super) mod webp;

/// Part of a decoder's report, and what it means.
type Phrase = (&'static str, &'static str);

/// What is said of reports that no table has.
const CONTRADICTION: &str = "its contents contradict each other";

/// The meaning of a report: that of the first phrase that is in it.
fn meaning(report: &str, phrases: &[Phrase]) -> &'static str {
    let report = report.to_lowercase();
    phrases.iter().find(|(part, _)| report.contains(part)).map_or(CONTRADICTION, |(_, meaning)| meaning)
}

/// Four bytes that name a part of a file, where they are letters.
fn letters(name: &[u8]) -> Option<&str> {
    std::str::from_utf8(name).ok().filter(|name| name.chars().all(|c| c.is_ascii_alphanumeric() || c == ' '))
}

fn u32_at(bytes: &[u8], at: usize, is_big_endian: bool) -> Option<u32> {
    let four = bytes.get(at..)?.first_chunk::<4>()?;
    Some(if is_big_endian { u32::from_be_bytes(*four) } else { u32::from_le_bytes(*four) })
}

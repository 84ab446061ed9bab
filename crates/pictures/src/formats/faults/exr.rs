//! OpenEXR: attributes, then blocks of pixels. [OpenEXR]

use super::{CONTRADICTION, u32_at};
use crate::PictureError;
use exr::error::Error;

const FORMAT: &str = "EXR";

const PHRASES: &[super::Phrase] = &[
    ("file identifier", "it does not begin as an EXR does"),
    ("feature flags", "its version number has flags that do not exist"),
    ("display window", "its display window is empty or too large"),
    ("data window", "its data window is empty or too large"),
    ("window", "one of its windows is empty or too large"),
    ("not sorted", "its channels are not in the order of their names"),
    ("not unique", "two of its channels have the same name"),
    ("at least one channel", "it has no channels"),
    ("at least one layer", "it has no picture"),
    ("offset table", "its table of blocks is wrong"),
    ("chunk count", "its table of blocks is wrong"),
    ("chunk", "the header of a block of pixels is wrong"),
    ("y coordinate", "the header of a block of pixels is wrong"),
    ("tile", "the header of a tile is wrong"),
    ("layer index", "a block of pixels belongs to no part"),
    ("level", "the header of a tile is wrong"),
    ("time code", "its time code is wrong"),
    ("text", "one of its text entries is wrong"),
    ("pixel type", "a channel has a number type that does not exist"),
    ("sampling", "a channel has an impossible subsampling"),
    ("attribute", "one of its attributes is wrong"),
    ("end of file expected", "there is more data after its pixels"),
    ("compress", "its compressed pixels cannot be decompressed"),
    ("dwa", "its compressed pixels cannot be decompressed"),
    ("zlib", "its compressed pixels cannot be decompressed"),
    ("table", "its compressed pixels cannot be decompressed"),
    ("code", "its compressed pixels cannot be decompressed"),
    ("data", "its compressed pixels cannot be decompressed"),
    ("bit count", "its compressed pixels cannot be decompressed"),
    ("size", "a size in its header is wrong"),
];

/// Why the decoder rejects these bytes; `rows` names the pixels that it was decoding, if any.
pub(in super::super) fn explain(error: Error, bytes: &[u8], rows: Option<&str>) -> PictureError {
    let part = rows.unwrap_or("the header or the pixels").to_owned();
    match error {
        Error::NotSupported(what) => PictureError::Unsupported {
            format: FORMAT,
            what: unsupported(&what).to_owned(),
            advice: "save it with ZIP or PIZ compression, as a flat picture",
        },
        Error::Invalid(what) if what.contains("missing bytes") || what.contains("not enough data") => {
            PictureError::truncated(FORMAT, part)
        }
        Error::Io(_) => PictureError::truncated(FORMAT, part),
        Error::Invalid(report) => {
            let place = attribute_in(&report, bytes);
            let what = match (&place, rows) {
                (Some(place), _) => format!("its attribute {place} is missing or wrong"),
                (None, Some(rows)) => format!("{rows}: {}", super::meaning(&report, PHRASES)),
                (None, None) => super::meaning(&report, PHRASES).to_owned(),
            };
            PictureError::invalid(FORMAT, what)
        }
        Error::Aborted => PictureError::invalid(FORMAT, CONTRADICTION),
    }
}

fn unsupported(report: &str) -> &'static str {
    let table: &[super::Phrase] = &[
        ("deep", "deep data"),
        ("subsampl", "subsampled colour"),
        ("version", "a version of EXR other than 2"),
        ("flags", "a version of EXR newer than this program"),
        ("compression", "its compression"),
    ];
    let found = super::meaning(report, table);
    if found == CONTRADICTION { "its compression" } else { found }
}

/// The attribute that a report names, with its position in the file if it is found there.
fn attribute_in(report: &str, bytes: &[u8]) -> Option<String> {
    let name = report.strip_prefix("missing or invalid ")?.strip_suffix(" attribute")?;
    let mut at = 8;
    loop {
        let (found, after) = text_at(bytes, at)?;
        if found.is_empty() {
            return Some(format!("'{name}'"));
        }
        if found == name {
            return Some(format!("'{name}' at byte {at}"));
        }
        let (_, after) = text_at(bytes, after)?;
        at = after.checked_add(4)?.checked_add(u32_at(bytes, after, false)? as usize)?;
    }
}

/// A zero-terminated text, and the offset of what follows it.
fn text_at(bytes: &[u8], at: usize) -> Option<(&str, usize)> {
    let rest = bytes.get(at..)?;
    let length = rest.iter().take(256).position(|byte| *byte == 0)?;
    Some((std::str::from_utf8(&rest[..length]).ok()?, at + length + 1))
}

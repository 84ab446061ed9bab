//! Text files: `Name: values { nodes }`, with comments after semicolons.

use super::node::Tree;
use super::records::{Builder, MAX_DEPTH};
use bilux_import::FormatError;
use bilux_import::bytes::text::Places;

/// Name of a node that every text has near its beginning.
const FIRST_NODE: &[u8] = b"FBXHeaderExtension";

/// True if the bytes look like a file in text.
pub(in crate::fbx) fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    start.starts_with(b"; FBX ") || start.windows(FIRST_NODE.len()).any(|word| word == FIRST_NODE)
}

/// The version that a text states. Without one it is 6.1, the last that did not need to.
pub(super) fn version(tree: &Tree) -> Result<u32, FormatError> {
    let stated = tree.root().child("FBXHeaderExtension").and_then(|header| header.child_value("FBXVersion"));
    let stated = stated.and_then(|value| value.integer());
    let heading = || {
        let line = tree.places.bytes().split(|byte| matches!(byte, b'\n' | b'\r')).next()?;
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line).strip_prefix(b"; FBX ")?;
        let digits = |text: &[u8]| std::str::from_utf8(text).ok()?.parse::<u16>().ok().map(i64::from);
        let mut parts = line.split(|byte| !byte.is_ascii_digit());
        Some(digits(parts.next()?)? * 1000 + digits(parts.next()?)? * 100)
    };
    Ok(stated.or_else(heading).and_then(|version| u32::try_from(version).ok()).unwrap_or(6100))
}

/// Bytes at which a list of values may end, or at which something begins that could hold such bytes.
const MARKS: [bool; 256] = {
    let mut marks = [false; 256];
    let mut i = 0;
    while i < 5 {
        marks[b"\";:{}"[i] as usize] = true;
        i += 1;
    }
    marks
};

/// Reads all nodes.
pub(super) fn parse<'a>(
    bytes: &'a [u8],
    places: &Places,
    builder: &mut Builder<'a, '_>,
) -> Result<(), FormatError> {
    let error = |at: usize, message: &str| Err(FormatError::malformed(message, places.at(at)));
    // The nodes whose braces are open.
    let mut open: Vec<u32> = Vec::new();
    // The node whose values are being read, and where they begin.
    let (mut current, mut start) = (None, 0);
    let mut at = 0;
    while let Some(length) = bytes[at..].iter().position(|&byte| MARKS[usize::from(byte)]) {
        let mark = at + length;
        at = mark + 1;
        match bytes[mark] {
            b'"' => match bytes[at..].iter().position(|&byte| byte == b'"') {
                Some(length) => at += length + 1,
                None => return error(mark, "the file ends within these quotes: it was cut off"),
            },
            b';' => at = bytes[at..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |n| at + n),
            b':' => {
                let name = name_before(&bytes[start..mark]);
                if name.is_empty() {
                    return error(mark, "the name of a node is missing before this colon");
                }
                let first = start + bytes[start..mark].trim_ascii_end().len() - name.len();
                end_values(current, &bytes[start..first], builder);
                current = Some(builder.push(name, b"", first)?);
                start = at;
            }
            b'{' => {
                let Some(node) = current.take() else {
                    return error(mark, "a node's name is missing before this brace");
                };
                end_values(Some(node), &bytes[start..mark], builder);
                if open.len() >= MAX_DEPTH {
                    return error(mark, &format!("nodes are nested more than {MAX_DEPTH} levels deep"));
                }
                open.push(node);
                start = at;
            }
            _ => {
                end_values(current.take(), &bytes[start..mark], builder);
                let Some(node) = open.pop() else { return error(mark, "this brace closes nothing") };
                builder.close(node);
                start = at;
            }
        }
    }
    end_values(current, &bytes[start..], builder);
    match open.is_empty() {
        true => Ok(()),
        false => error(bytes.len(), "the file ends before its last brace is closed: it was cut off"),
    }
}

fn end_values<'a>(node: Option<u32>, values: &'a [u8], builder: &mut Builder<'a, '_>) {
    if let Some(node) = node {
        builder.records[node as usize].values = values;
    }
}

/// The word at the end of some bytes.
fn name_before(bytes: &[u8]) -> &[u8] {
    let bytes = bytes.trim_ascii_end();
    let is_part =
        |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'|' | b'.') || *byte >= 128;
    let length = bytes.iter().rev().take_while(|byte| is_part(byte)).count();
    &bytes[bytes.len() - length..]
}
